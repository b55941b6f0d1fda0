#define _POSIX_C_SOURCE 200809L
#include "opencl/binary_store.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "opencl/binary_store_trim.h"

/* The head of a file.  Its key and its bytes follow. */
typedef struct entry_head {
    char magic[8];
    uint32_t version; /* of this layout; in the byte order of the machine, so that another order is another version */
    uint32_t key_size;
    uint64_t size;     /* of the bytes behind the key */
    uint64_t checksum; /* gscl_hash of the fields above, the key and the bytes */
} entry_head;

static const char magic[8] = "gsclbin";
#define VERSION 1

uint64_t gscl_hash(uint64_t hash, const void *bytes, size_t size) {
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ byte[i]) * UINT64_C(0x100000001B3);
    return hash;
}

static uint64_t entry_checksum(const entry_head *head, const void *key, const void *bytes) {
    const uint64_t hash = gscl_hash(GSCL_HASH_START, head, offsetof(entry_head, checksum));
    return gscl_hash(gscl_hash(hash, key, head->key_size), bytes, (size_t)head->size);
}

/* FOLDER/NAME, to be freed; NULL without memory. */
static char *path_join(const char *folder, const char *name) {
    const size_t size = strlen(folder) + strlen(name) + 2;
    char *path = malloc(size);
    if (path)
        snprintf(path, size, "%s/%s", folder, name);
    return path;
}

static char *entry_path(const char *folder, const char *key) {
    char name[16 + sizeof GSCL_BINARY_SUFFIX];
    snprintf(name, sizeof name, "%016" PRIx64 GSCL_BINARY_SUFFIX, gscl_hash(GSCL_HASH_START, key, strlen(key)));
    return path_join(folder, name);
}

/* ---- Reading ----------------------------------------------------------------------------------- */

/* Bytes of an ordinary file whose owner is trusted; 0 for any other. */
static uint64_t file_size(int file) {
    struct stat status;
    if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size < 0)
        return 0;
    return status.st_uid == geteuid() || status.st_uid == 0 ? (uint64_t)status.st_size : 0;
}

/* `size` is not 0. */
static bool read_all(int file, char *bytes, size_t size) {
    do {
        const ssize_t count = read(file, bytes, size);
        if (count == 0 || (count < 0 && errno != EINTR))
            return false;
        if (count > 0) {
            bytes += count;
            size -= (size_t)count;
        }
    } while (size > 0);
    return true;
}

/* Whether the file is whole and of this key. */
static bool entry_check(const char *entry, size_t size, const char *key) {
    entry_head head;
    const size_t key_size = strlen(key);
    if (size < sizeof head + key_size)
        return false;
    memcpy(&head, entry, sizeof head);
    return memcmp(head.magic, magic, sizeof magic) == 0 && head.version == VERSION && head.key_size == key_size &&
           head.size == size - sizeof head - key_size && memcmp(entry + sizeof head, key, key_size) == 0 &&
           head.checksum == entry_checksum(&head, key, entry + sizeof head + key_size);
}

/* The bytes of the key in an open file, to be freed, or NULL. */
static void *entry_read(int file, const char *key, uint64_t limit, size_t *size) {
    const uint64_t total = file_size(file);
    const size_t start = sizeof(entry_head) + strlen(key);
    char *entry = total > start && total <= limit && total < SIZE_MAX ? malloc((size_t)total) : NULL;
    if (entry && (!read_all(file, entry, (size_t)total) || !entry_check(entry, (size_t)total, key))) {
        free(entry);
        entry = NULL;
    }
    if (!entry)
        return NULL;
    *size = (size_t)total - start;
    return memmove(entry, entry + start, *size);
}

void *gscl_binary_load(const char *folder, const char *key, uint64_t limit, size_t *size) {
    char *path = entry_path(folder, key);
    const int file = path ? open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK) : -1;
    free(path);
    if (file < 0)
        return NULL;
    void *bytes = entry_read(file, key, limit, size);
    if (bytes)
        futimens(file, NULL); /* without permission the file only seems unused */
    close(file);
    return bytes;
}

/* ---- Writing ----------------------------------------------------------------------------------- */

static bool write_all(int file, const void *bytes, size_t size) {
    const char *next = bytes;
    while (size > 0) {
        const ssize_t count = write(file, next, size);
        if (count < 0 && errno != EINTR)
            return false;
        if (count > 0) {
            next += count;
            size -= (size_t)count;
        }
    }
    return true;
}

/* Makes a folder and those above it, for this user alone.  Returns 0 or an errno. */
static int make_folders(const char *folder) {
    struct stat status;
    char *path = path_join(folder, "");
    if (!path)
        return ENOMEM;
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        mkdir(path, 0700); /* what it cannot make shows in the end */
        *slash = '/';
    }
    const int error = stat(path, &status) == 0 ? 0 : errno;
    free(path);
    return error;
}

static int entry_write(int file, const char *key, const void *bytes, size_t size) {
    entry_head head = {.version = VERSION, .key_size = (uint32_t)strlen(key), .size = size};
    memcpy(head.magic, magic, sizeof magic);
    head.checksum = entry_checksum(&head, key, bytes);
    const bool written =
        write_all(file, &head, sizeof head) && write_all(file, key, head.key_size) && write_all(file, bytes, size);
    const int error = written ? 0 : errno;
    return close(file) != 0 && written ? errno : error;
}

/* Writes the entry to a file of its own and gives it the name `path`. */
static int entry_save(const char *folder, const char *path, const char *key, const void *bytes, size_t size) {
    char *temporary = path_join(folder, GSCL_BINARY_UNFINISHED "XXXXXX");
    const int file = temporary ? mkstemp(temporary) : -1;
    int error = file >= 0 ? entry_write(file, key, bytes, size) : temporary ? errno : ENOMEM;
    if (error == 0 && rename(temporary, path) != 0)
        error = errno;
    if (error != 0 && file >= 0)
        unlink(temporary);
    free(temporary);
    return error;
}

int gscl_binary_save(const char *folder, const char *key, const void *bytes, size_t size, uint64_t limit) {
    if (size > limit || limit - size < sizeof(entry_head) + strlen(key))
        return EFBIG;
    const int made = make_folders(folder);
    if (made != 0)
        return made;
    char *path = entry_path(folder, key);
    const int error = path ? entry_save(folder, path, key, bytes, size) : ENOMEM;
    free(path);
    gscl_binary_trim(folder, limit);
    return error;
}
