/* An index of pictures in a temporary file without a name, so that the memory of a batch does not grow with the number of
 * its pictures: 32 bytes for each one are on disk (64 at most, and 96 while the table grows), in $TMPDIR or /tmp. */
#ifndef GSCL_TOOL_NAME_INDEX_H
#define GSCL_TOOL_NAME_INDEX_H

#include <stdbool.h>
#include <stdint.h>

typedef struct name_entry {
    uint64_t key[2]; /* of the output, or of the input where it has no output */
    uint64_t input;  /* hash of the input's name */
    uint64_t state;  /* of the caller; not 0 */
} name_entry;

typedef struct name_index {
    int file; /* -1: none */
    uint64_t capacity, count;
} name_index;

/* Functions return false with errno when the file fails. */
bool name_index_create(name_index *index);
void name_index_free(name_index *index);

/* Finds the entry of a key.  entry->state is 0 when there is none. */
bool name_index_get(const name_index *index, const uint64_t key[2], name_entry *entry);

/* Adds an entry, or replaces the one of its key. */
bool name_index_put(name_index *index, const name_entry *entry);

#endif
