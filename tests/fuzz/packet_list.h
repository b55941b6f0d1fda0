#ifndef FUZZ_PACKET_LIST_H
#define FUZZ_PACKET_LIST_H

#include "coded_memory.h"

/* Reads a list of packets into `memory`.  Returns whether it can be read and has at most max_splats in all packets together. */
bool packet_list_read(const uint8_t *bytes, size_t size, uint32_t max_splats, fuzz_memory *memory,
                      gsf_coded_image *image);

/* Copies a list to `list`, of FUZZ_MAX_FILE bytes, and appends what its repair packets make up for.  Returns the size; 0: nothing. */
size_t packet_list_repair(const uint8_t *bytes, size_t size, uint8_t *list);

#endif
