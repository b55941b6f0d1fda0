/* A folder of files, each with bytes that are found by a key.  Any number of threads and processes may use a folder at the
 * same time: a file appears whole or not at all, and what is not whole, or belongs to another key, is not found. */
#ifndef GSCL_LIB_BINARY_STORE_H
#define GSCL_LIB_BINARY_STORE_H

#include <stddef.h>
#include <stdint.h>

/* The 64-bit FNV-1a hash of bytes that follow those of an earlier hash; `hash` is GSCL_HASH_START for the first ones. */
#define GSCL_HASH_START UINT64_C(0xCBF29CE484222325)
uint64_t gscl_hash(uint64_t hash, const void *bytes, size_t size);

/* Reads the bytes of a key, to be freed, and marks them as used.  Returns NULL where the folder has none: no file, one of
 * more than `limit` bytes, one that is damaged, or one of a user who is neither this one nor root. */
void *gscl_binary_load(const char *folder, const char *key, uint64_t limit, size_t *size);

/* Stores bytes under a key in place of those that are there.  Makes the folder with those above it where it is missing,
 * and removes the files that were unused for longest so that all take at most `limit` bytes.  Returns 0, or the number of
 * the error (errno); EFBIG for bytes beyond the limit. */
int gscl_binary_save(const char *folder, const char *key, const void *bytes, size_t size, uint64_t limit);

#endif
