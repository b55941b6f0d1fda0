/* Changes of gscl files that keep what a reader checks first: magic, check, blocks and the end of the picture. */
#ifndef GSCL_FUZZ_READER_MUTATOR_H
#define GSCL_FUZZ_READER_MUTATOR_H

#include <stddef.h>
#include <stdint.h>

/* Of libFuzzer: changes bytes in place and returns their new number. */
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
/* What libFuzzer calls when a target has it. */
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

/* Likewise, for a file that begins with the magic bytes, or else a bare picture. */
size_t fuzz_mutate_file(uint8_t *data, size_t size, size_t max_size, unsigned seed);

#endif
