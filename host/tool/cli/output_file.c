#define _DEFAULT_SOURCE /* fchmod, flock, mkstemp */
#include "cli/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/name_hash.h"
#include "cli/output_target.h"

const char *name_suffix(const char *name) {
    const char *slash = strrchr(name, '/');
    const char *base = slash ? slash + 1 : name;
    const char *dot = strrchr(base, '.');
    return dot && dot != base ? dot : base + strlen(base);
}

int output_take_operand(const char *command, char *const *operands, int *count, const char **output) {
    const char *last = operands[*count - 1];
    if (access(last, F_OK) == 0)
        return report_usage(command, "%s exists; name it with -o to replace it", last);
    *output = last;
    --*count;
    return 0;
}

bool output_is_separate(const char *command, const char *input, const char *output) {
    struct stat in, out;
    if (strcmp(input, "-") == 0 || output_descriptor(output) >= 0 || stat(input, &in) || stat(output, &out))
        return true;
    if (in.st_dev != out.st_dev || in.st_ino != out.st_ino || !S_ISREG(out.st_mode))
        return true;
    report_usage(command, "output %s would overwrite the input; choose another name", output);
    return false;
}

#define TEMPORARY_PATTERN ".gscl-XXXXXX"
#define TEMPORARY_SIZE (sizeof ".gscl-" + 16) /* bytes, the NUL included; the pattern is shorter */

/* "DIR/.gscl-HASH" for DIR/NAME, with the hash of NAME; NULL when out of memory. */
static char *temporary_name(const char *target) {
    const char *slash = strrchr(target, '/');
    const size_t folder = slash ? (size_t)(slash + 1 - target) : 0;
    char *name = malloc(folder + TEMPORARY_SIZE);
    if (name) {
        memcpy(name, target, folder);
        snprintf(name + folder, TEMPORARY_SIZE, ".gscl-%016llx",
                 (unsigned long long)name_hash(target + folder, strlen(target + folder), 0));
    }
    return name;
}

/* Whether this process holds a temporary file alone: it is locked, still has its name, and is nobody else's. */
static bool lock_temporary(int file, const char *name) {
    struct stat opened, named;
    return flock(file, LOCK_EX | LOCK_NB) == 0 && fstat(file, &opened) == 0 && lstat(name, &named) == 0 &&
           opened.st_dev == named.st_dev && opened.st_ino == named.st_ino && S_ISREG(opened.st_mode) &&
           opened.st_nlink == 1 && opened.st_uid == geteuid();
}

/* Opens a temporary file, new or left by a killed process; where another process is writing it, or the file system has no
 * locks, one with a new name. */
static int make_temporary(char *name) {
    const int file = open(name, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (file >= 0 && lock_temporary(file, name) && ftruncate(file, 0) == 0)
        return file;
    if (file >= 0)
        close(file);
    char *slash = strrchr(name, '/');
    memcpy(slash ? slash + 1 : name, TEMPORARY_PATTERN, sizeof TEMPORARY_PATTERN);
    return mkstemp(name);
}

/* The permissions of the file that is replaced, or those that open() would give a new file. */
static mode_t target_mode(const struct stat *existing) {
    if (existing)
        return existing->st_mode & 0777;
    const mode_t mask = umask(0);
    umask(mask);
    return 0666 & ~mask;
}

static bool open_temporary(output_file *output, const struct stat *existing) {
    output->temporary = temporary_name(output->target);
    if (!output->temporary)
        return false;
    const int file = interrupt_make_guarded(output->temporary, make_temporary);
    if (file < 0) {
        free(output->temporary);
        output->temporary = NULL;
        return false;
    }
    const int lock = fcntl(file, F_DUPFD_CLOEXEC, 0);
    output->lock = lock > 0 ? lock : 0;
    fchmod(file, target_mode(existing));
    output->stream = fdopen(file, "wb");
    if (!output->stream)
        close(file);
    return output->stream != NULL;
}

/* Opens a file that is replaced, or made, as a whole. */
static bool open_file(output_file *output, const char *name) {
    struct stat status;
    output->target = output_resolve(name);
    if (!output->target)
        return false;
    const bool exists = stat(output->target, &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) {
        errno = EISDIR;
        return false;
    }
    if (exists && access(output->target, W_OK) != 0)
        return false;
    return open_temporary(output, exists ? &status : NULL);
}

/* Opens what is written in place.  A file behind a descriptor keeps what the shell and other programs have written to it. */
static bool open_in_place(output_file *output, const char *name) {
    const int file = output_open_in_place(name);
    if (file >= 0 && output_descriptor(name) == STDOUT_FILENO) {
        output->stream = stdout; /* in order with what else is printed */
        close(file);
        return true;
    }
    output->stream = file >= 0 ? fdopen(file, "wb") : NULL;
    if (file >= 0 && !output->stream)
        close(file);
    return output->stream != NULL;
}

bool output_open_text(output_file *output, const char *name) {
    const bool is_stdout = strcmp(name, "-") == 0;
    *output = (output_file){.label = is_stdout ? "standard output" : name};
    if (output_is_in_place(name) ? open_in_place(output, name) : open_file(output, name))
        return true;
    report_error(output->label, "cannot be written: %s", strerror(errno));
    output_discard(output);
    return false;
}

bool output_open(output_file *output, const char *name) {
    if (!output_open_text(output, name))
        return false;
    if (output->temporary || !isatty(fileno(output->stream)))
        return true;
    output_discard(output);
    return report_error(output->label, "is a terminal; redirect it to a file or a pipe, or name a file with -o");
}

bool output_write(output_file *output, const void *bytes, size_t size) {
    if (!output->error && size > 0 && fwrite(bytes, 1, size, output->stream) != size)
        output->error = errno ? errno : EIO;
    return !output->error;
}

bool output_store(output_file *output) {
    if (!output->error && (fflush(output->stream) != 0 || (output->temporary && fsync(fileno(output->stream)) != 0)))
        output->error = errno;
    return !output->error;
}

/* Flushes and closes, and keeps the first error: a full disk may be reported only here. */
static void close_stream(output_file *output) {
    if (!output->stream)
        return;
    if (fflush(output->stream) != 0 && !output->error)
        output->error = errno;
    if (output->stream != stdout && fclose(output->stream) != 0 && !output->error)
        output->error = errno;
    output->stream = NULL;
}

static void release_names(output_file *output) {
    if (output->temporary)
        interrupt_release_guarded(output->temporary);
    if (output->lock)
        close(output->lock);
    free(output->temporary);
    free(output->target);
    output->temporary = output->target = NULL;
    output->lock = 0;
}

bool output_commit(output_file *output) {
    close_stream(output);
    if (!output->error && output->temporary && rename(output->temporary, output->target) != 0)
        output->error = errno;
    if (output->error) {
        report_error(output->label, "cannot be written: %s", strerror(output->error));
        output_discard(output);
        return false;
    }
    release_names(output);
    return true;
}

void output_discard(output_file *output) {
    close_stream(output);
    if (output->temporary)
        unlink(output->temporary);
    release_names(output);
}

bool output_exists(const char *name, uint64_t *size) {
    struct stat status;
    const bool exists = stat(name, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0;
    *size = exists ? (uint64_t)status.st_size : 0;
    return exists;
}

void output_remove_leftover(const char *name) {
    char *target = output_resolve(name);
    char *temporary = target ? temporary_name(target) : NULL;
    const int file = temporary ? open(temporary, O_RDWR | O_NOFOLLOW | O_CLOEXEC) : -1;
    if (file >= 0) {
        if (lock_temporary(file, temporary))
            unlink(temporary);
        close(file);
    }
    free(temporary);
    free(target);
}

bool output_make_folders(const char *name) {
    char *path = strdup(name);
    struct stat status;
    bool ok = path || report_error(name, "%s", strerror(ENOMEM));
    for (char *slash = path && *path ? strchr(path + 1, '/') : NULL; ok && slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        ok = stat(path, &status) == 0 ? S_ISDIR(status.st_mode) || (errno = ENOTDIR, false)
                                      : mkdir(path, 0777) == 0 || errno == EEXIST;
        if (!ok)
            report_error(path, "cannot be made a folder: %s", strerror(errno));
        *slash = '/';
    }
    free(path);
    return ok;
}
