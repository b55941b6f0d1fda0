/* Hashes of names, which are the same on every machine and in every version: files hold them. */
#ifndef GSCL_TOOL_NAME_HASH_H
#define GSCL_TOOL_NAME_HASH_H

#include <stddef.h>
#include <stdint.h>

/* SipHash-2-4 of some bytes with the key (`key`, 0).  Different keys give independent hashes. */
uint64_t name_hash(const char *bytes, size_t size, uint64_t key);

#endif
