#define _GNU_SOURCE /* flock, pread, syncfs */
#include "host/system/files.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAX_PATH 1024 /* bytes, the NUL included */

static bool take_status(const struct stat *s, system_status *status) {
    *status = (system_status){.is_regular = S_ISREG(s->st_mode),
                              .is_folder = S_ISDIR(s->st_mode),
                              .size = s->st_size > 0 ? (uint64_t)s->st_size : 0,
                              .device = (uint64_t)s->st_dev,
                              .number = (uint64_t)s->st_ino};
    return true;
}

bool system_status_of(const char *name, system_status *status) {
    struct stat s;
    return stat(name, &s) == 0 && take_status(&s, status);
}

bool system_status_of_open(int file, system_status *status) {
    struct stat s;
    return fstat(file, &s) == 0 && take_status(&s, status);
}

bool system_is_same(const system_status *a, const system_status *b) {
    return a->device == b->device && a->number == b->number;
}

const char *system_error_text(int error) {
    return strerror(error);
}

bool system_exists(const char *name) {
    return access(name, F_OK) == 0;
}

bool system_may_write(const char *name) {
    return access(name, W_OK) == 0;
}

bool system_is_terminal(int file) {
    return isatty(file) != 0;
}

FILE *system_open_stream(const char *name) {
    return fopen(name, "rb");
}

int system_open_to_read(const char *name) {
    return open(name, O_RDONLY | O_CLOEXEC);
}

int system_open_to_append(const char *name) {
    return open(name, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
}

int system_duplicate(int file) {
    return fcntl(file, F_DUPFD_CLOEXEC, 0);
}

bool system_make_folder(const char *name) {
    return mkdir(name, 0777) == 0;
}

bool system_remove_folder(const char *name) {
    return rmdir(name) == 0;
}

bool system_remove_file(const char *name) {
    return unlink(name) == 0;
}

bool system_replace(const char *from, const char *to) {
    return rename(from, to) == 0;
}

bool system_store(int file) {
    return fsync(file) == 0;
}

void system_store_below(const char *folder) {
#ifdef __linux__
    const int file = folder ? open(folder, O_RDONLY | O_CLOEXEC) : -1;
    const bool is_stored = file >= 0 && syncfs(file) == 0;
    if (file >= 0)
        close(file);
    if (is_stored)
        return;
#else
    (void)folder;
#endif
    sync();
}

bool system_set_size(int file, uint64_t size) {
    return ftruncate(file, (off_t)size) == 0;
}

bool system_lock(int file) {
    return flock(file, LOCK_EX | LOCK_NB) == 0;
}

int system_make_scratch(void) {
    const char *folder = getenv("TMPDIR");
    char name[MAX_PATH];
    const int length = snprintf(name, sizeof name, "%s/gscl-XXXXXX", folder && *folder ? folder : "/tmp");
    errno = ENAMETOOLONG;
    const int file = length < MAX_PATH ? mkstemp(name) : -1;
    if (file >= 0)
        unlink(name);
    return file;
}

bool system_read_at(int file, void *bytes, size_t size, uint64_t offset) {
    const ssize_t done = pread(file, bytes, size, (off_t)offset);
    if (done >= 0 && (size_t)done != size)
        errno = EIO;
    return done == (ssize_t)size;
}

bool system_write_at(int file, const void *bytes, size_t size, uint64_t offset) {
    const ssize_t done = pwrite(file, bytes, size, (off_t)offset);
    if (done >= 0 && (size_t)done != size)
        errno = ENOSPC;
    return done == (ssize_t)size;
}

bool system_has_input(int file, int milliseconds) {
    struct pollfd source = {.fd = file, .events = POLLIN};
    return poll(&source, 1, milliseconds) != 0;
}
