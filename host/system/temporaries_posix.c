#define _DEFAULT_SOURCE /* fchmod, flock, mkstemp */
#include "host/system/temporaries.h"

#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* Whether this process holds a temporary file alone: it is locked, still has its name, and is nobody else's. */
static bool lock_temporary(int file, const char *name) {
    struct stat opened, named;
    return flock(file, LOCK_EX | LOCK_NB) == 0 && fstat(file, &opened) == 0 && lstat(name, &named) == 0 &&
           opened.st_dev == named.st_dev && opened.st_ino == named.st_ino && S_ISREG(opened.st_mode) &&
           opened.st_nlink == 1 && opened.st_uid == geteuid();
}

int system_make_temporary(char *name) {
    const int file = open(name, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (file >= 0 && lock_temporary(file, name) && ftruncate(file, 0) == 0)
        return file;
    if (file >= 0)
        close(file);
    char *slash = strrchr(name, '/');
    memcpy(slash ? slash + 1 : name, TEMPORARY_PATTERN, sizeof TEMPORARY_PATTERN);
    return mkstemp(name);
}

int system_keep_lock(int file) {
    const int lock = fcntl(file, F_DUPFD_CLOEXEC, 0);
    return lock > 0 ? lock : 0;
}

void system_take_permissions(int file, const char *target) {
    struct stat existing;
    if (stat(target, &existing) == 0) {
        fchmod(file, existing.st_mode & 0777);
        return;
    }
    const mode_t mask = umask(0);
    umask(mask);
    fchmod(file, 0666 & ~mask);
}

void system_remove_temporary(const char *name) {
    const int file = open(name, O_RDWR | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0)
        return;
    if (lock_temporary(file, name))
        unlink(name);
    close(file);
}
