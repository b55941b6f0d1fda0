#define _DEFAULT_SOURCE /* fdopen, strdup */
#include "cli/output_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/name_hash.h"
#include "host/system/files.h"
#include "host/system/output_target.h"
#include "host/system/temporaries.h"

const char *name_suffix(const char *name) {
    const char *slash = strrchr(name, '/');
    const char *base = slash ? slash + 1 : name;
    const char *dot = strrchr(base, '.');
    return dot && dot != base ? dot : base + strlen(base);
}

int output_take_operand(const char *command, char *const *operands, int *count, const char **output) {
    const char *last = operands[*count - 1];
    if (system_exists(last))
        return report_usage(command, "%s exists; name it with -o to replace it", last);
    *output = last;
    --*count;
    return 0;
}

bool output_is_separate(const char *command, const char *input, const char *output) {
    system_status in, out;
    if (strcmp(input, "-") == 0 || output_descriptor(output) >= 0 || !system_status_of(input, &in) ||
        !system_status_of(output, &out))
        return true;
    if (!system_is_same(&in, &out) || !out.is_regular)
        return true;
    report_usage(command, "output %s would overwrite the input; choose another name", output);
    return false;
}

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

static bool open_temporary(output_file *output) {
    output->temporary = temporary_name(output->target);
    if (!output->temporary)
        return false;
    const int file = interrupt_make_guarded(output->temporary, system_make_temporary);
    if (file < 0) {
        free(output->temporary);
        output->temporary = NULL;
        return false;
    }
    output->lock = system_keep_lock(file);
    system_take_permissions(file, output->target);
    output->stream = fdopen(file, "wb");
    if (!output->stream)
        close(file);
    return output->stream != NULL;
}

/* Opens a file that is replaced, or made, as a whole. */
static bool open_file(output_file *output, const char *name) {
    system_status status;
    output->target = output_resolve(name);
    if (!output->target)
        return false;
    const bool exists = system_status_of(output->target, &status);
    if (exists && status.is_folder) {
        errno = EISDIR;
        return false;
    }
    if (exists && !system_may_write(output->target))
        return false;
    return open_temporary(output);
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
    report_error(output->label, "cannot be written: %s", system_error_text(errno));
    output_discard(output);
    return false;
}

bool output_open(output_file *output, const char *name) {
    if (!output_open_text(output, name))
        return false;
    if (output->temporary || !system_is_terminal(fileno(output->stream)))
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
    if (!output->error && (fflush(output->stream) != 0 || (output->temporary && !system_store(fileno(output->stream)))))
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
    if (!output->error && output->temporary && !system_replace(output->temporary, output->target))
        output->error = errno;
    if (output->error) {
        report_error(output->label, "cannot be written: %s", system_error_text(output->error));
        output_discard(output);
        return false;
    }
    release_names(output);
    return true;
}

void output_discard(output_file *output) {
    close_stream(output);
    if (output->temporary)
        system_remove_file(output->temporary);
    release_names(output);
}

bool output_exists(const char *name, uint64_t *size) {
    system_status status;
    const bool exists = system_status_of(name, &status) && status.is_regular && status.size > 0;
    *size = exists ? status.size : 0;
    return exists;
}

void output_remove_leftover(const char *name) {
    char *target = output_resolve(name);
    char *temporary = target ? temporary_name(target) : NULL;
    if (temporary)
        system_remove_temporary(temporary);
    free(temporary);
    free(target);
}

bool output_make_folders(const char *name) {
    char *path = strdup(name);
    system_status status;
    bool ok = path || report_error(name, "%s", system_error_text(ENOMEM));
    for (char *slash = path && *path ? strchr(path + 1, '/') : NULL; ok && slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        ok = system_status_of(path, &status) ? status.is_folder || (errno = ENOTDIR, false)
                                             : system_make_folder(path) || errno == EEXIST;
        if (!ok)
            report_error(path, "cannot be made a folder: %s", system_error_text(errno));
        *slash = '/';
    }
    free(path);
    return ok;
}
