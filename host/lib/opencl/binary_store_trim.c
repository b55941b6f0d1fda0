#define _POSIX_C_SOURCE 200809L
#include "opencl/binary_store_trim.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define NAME_SIZE 32          /* bytes; longer names are not those of the store */
#define UNFINISHED_AGE 3600.0 /* seconds after which nobody writes an unfinished file any more */

typedef struct stored_file {
    char name[NAME_SIZE];
    struct timespec used;
    uint64_t size;
} stored_file;

typedef struct stored_files {
    stored_file *files;
    size_t count, capacity;
    uint64_t size;
} stored_files;

/* Returns false without memory. */
static bool files_add(stored_files *list, const char *name, const struct stat *status) {
    if (list->count == list->capacity) {
        const size_t capacity = 2 * list->capacity + 64;
        stored_file *grown = realloc(list->files, capacity * sizeof *grown);
        if (!grown)
            return false;
        list->files = grown;
        list->capacity = capacity;
    }
    stored_file *file = &list->files[list->count++];
    *file = (stored_file){.used = status->st_mtim, .size = (uint64_t)status->st_size};
    memcpy(file->name, name, strlen(name) + 1);
    list->size += file->size;
    return true;
}

static bool ends_with(const char *name, const char *end) {
    const size_t length = strlen(name), end_length = strlen(end);
    return length > end_length && strcmp(name + length - end_length, end) == 0;
}

static void look_at(stored_files *list, int folder, const char *name) {
    const bool unfinished = strncmp(name, GSCL_BINARY_UNFINISHED, strlen(GSCL_BINARY_UNFINISHED)) == 0;
    struct stat status;
    if (strlen(name) >= NAME_SIZE || (!unfinished && !ends_with(name, GSCL_BINARY_SUFFIX)) ||
        fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(status.st_mode))
        return;
    if (!unfinished)
        files_add(list, name, &status);
    else if (difftime(time(NULL), status.st_mtime) > UNFINISHED_AGE)
        unlinkat(folder, name, 0);
}

static int compare_use(const void *a, const void *b) {
    const struct timespec *p = &((const stored_file *)a)->used, *q = &((const stored_file *)b)->used;
    if (p->tv_sec != q->tv_sec)
        return p->tv_sec < q->tv_sec ? -1 : 1;
    return p->tv_nsec < q->tv_nsec ? -1 : p->tv_nsec > q->tv_nsec;
}

void gscl_binary_trim(const char *folder, uint64_t limit) {
    stored_files list = {0};
    DIR *stream = opendir(folder);
    if (!stream)
        return;
    for (const struct dirent *entry = readdir(stream); entry; entry = readdir(stream))
        look_at(&list, dirfd(stream), entry->d_name);
    if (list.count > 0)
        qsort(list.files, list.count, sizeof *list.files, compare_use);
    for (size_t i = 0; i < list.count && list.size > limit; i++) {
        unlinkat(dirfd(stream), list.files[i].name, 0);
        list.size -= list.files[i].size;
    }
    closedir(stream);
    free(list.files);
}
