/* Files, by names in UTF-8 whose folders are separated by slashes, and their descriptors.  What fails sets errno: EBUSY where
 * another program has a file open in a way that forbids it, as programs may on Windows. */
#ifndef GSCL_SYSTEM_FILES_H
#define GSCL_SYSTEM_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct system_status {
    bool is_regular, is_folder; /* neither: a pipe, a device and the like */
    uint64_t size;              /* bytes of a regular file */
    uint64_t device, number;    /* together the same for the same file alone */
} system_status;

/* The status of the file behind all links, or of an open one. */
bool system_status_of(const char *name, system_status *status);
bool system_status_of_open(int file, system_status *status);
bool system_is_same(const system_status *a, const system_status *b);

/* Text for a value of errno, until the next call. */
const char *system_error_text(int error);

bool system_exists(const char *name);

/* Whether a file may be written, and another may take its place now. */
bool system_may_write(const char *name);

/* Whether a person reads what is written to a file. */
bool system_is_terminal(int file);

/* A stream, or a descriptor (-1 on failure) that no started program inherits.  What is opened to append is made where it is
 * missing, and can be read, too. */
FILE *system_open_stream(const char *name);
int system_open_to_read(const char *name);
int system_open_to_append(const char *name);
int system_duplicate(int file);

bool system_make_folder(const char *name);
bool system_remove_folder(const char *name);
bool system_remove_file(const char *name);

/* Gives a file the name `to`, at once, in place of a file that has it. */
bool system_replace(const char *from, const char *to);

/* Waits until a file, or all below a folder (NULL: everywhere), is stored. */
bool system_store(int file);
void system_store_below(const char *folder);

bool system_set_size(int file, uint64_t size);

/* Locks a file for this process alone, until it is closed.  EWOULDBLOCK: another process has it. */
bool system_lock(int file);

/* A file without a name, in $TMPDIR or the folder of the system for temporary files; -1 on failure. */
int system_make_scratch(void);

/* Reads or writes `size` bytes at an offset, all or fail. */
bool system_read_at(int file, void *bytes, size_t size, uint64_t offset);
bool system_write_at(int file, const void *bytes, size_t size, uint64_t offset);

/* Waits until there is something to read, or the end.  Returns false after the time. */
bool system_has_input(int file, int milliseconds);

#endif
