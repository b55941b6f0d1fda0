#define _DEFAULT_SOURCE /* realpath, readlink, PATH_MAX */
#include "host/system/output_target.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAX_LINKS 40 /* one after the other, as Linux follows them */

/* Folders whose entries are the descriptors of this process. */
static const char *const descriptor_folders[] = {"/dev/fd", "/proc/self/fd", "/proc/thread-self/fd"};

/* The name that a symbolic link holds, seen from where the link stands; NULL for what is not a link, and without memory. */
static char *follow_link(const char *name) {
    char content[PATH_MAX];
    const char *slash = strrchr(name, '/');
    const ssize_t length = readlink(name, content, sizeof content);
    if (length < 0 || length == (ssize_t)sizeof content)
        return NULL;
    const size_t folder = slash && content[0] != '/' ? (size_t)(slash + 1 - name) : 0;
    char *followed = malloc(folder + (size_t)length + 1);
    if (followed) {
        memcpy(followed, name, folder);
        memcpy(followed + folder, content, (size_t)length);
        followed[folder + (size_t)length] = '\0';
    }
    return followed;
}

/* The folder of a name, without symbolic links; NULL where there is none, and without memory. */
static char *folder_of(const char *name) {
    const char *slash = strrchr(name, '/');
    char *folder = slash ? strdup(name) : NULL, *resolved = NULL;
    if (folder) {
        folder[slash - name + 1] = '\0';
        resolved = realpath(folder, NULL);
        free(folder);
    }
    return slash ? resolved : realpath(".", NULL);
}

static bool is_descriptor_folder(const char *folder) {
    bool is_found = false;
    for (size_t i = 0; i < sizeof descriptor_folders / sizeof *descriptor_folders && !is_found; i++) {
        char *resolved = realpath(descriptor_folders[i], NULL);
        is_found = resolved && strcmp(resolved, folder) == 0;
        free(resolved);
    }
    return is_found;
}

/* The descriptor that a name stands for by its own, without following it; else -1. */
static int descriptor_named(const char *name) {
    const char *slash = strrchr(name, '/'), *base = slash ? slash + 1 : name;
    const size_t digits = strspn(base, "0123456789");
    if (digits == 0 || digits > 9 || base[digits] != '\0')
        return -1;
    char *folder = folder_of(name);
    const bool is_descriptor = folder && is_descriptor_folder(folder);
    free(folder);
    return is_descriptor ? (int)strtol(base, NULL, 10) : -1;
}

int output_descriptor(const char *name) {
    int descriptor = strcmp(name, "-") == 0 ? STDOUT_FILENO : descriptor_named(name);
    char *path = descriptor < 0 ? follow_link(name) : NULL;
    for (int links = 1; path && (descriptor = descriptor_named(path)) < 0 && links < MAX_LINKS; links++) {
        char *next = follow_link(path);
        free(path);
        path = next;
    }
    free(path);
    return descriptor;
}

bool output_is_in_place(const char *name) {
    struct stat status;
    return output_descriptor(name) >= 0 ||
           (stat(name, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode));
}

/* Whether the process was started with the descriptor, and may write to it.  Those that a library has opened for itself
 * are closed when another program starts. */
static bool may_write(int descriptor) {
    const int flags = fcntl(descriptor, F_GETFL);
    return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY && (fcntl(descriptor, F_GETFD) & FD_CLOEXEC) == 0;
}

int output_open_in_place(const char *name) {
    const int descriptor = output_descriptor(name);
    if (descriptor < 0)
        return open(name, O_WRONLY | O_NOCTTY | O_CLOEXEC);
    if (may_write(descriptor))
        return fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
    errno = EBADF;
    return -1;
}

char *output_resolve(const char *name) {
    char *target = realpath(name, NULL), *next;
    if (target || errno == ELOOP)
        return target;
    target = strdup(name); /* no such file, perhaps at the end of links */
    for (int links = 0; target && links < MAX_LINKS && (next = follow_link(target)); links++) {
        free(target);
        target = next;
    }
    return target;
}
