/* Changes of image files that keep the checksums of PNG right. */
#ifndef GSCL_FUZZ_IMAGE_MUTATOR_H
#define GSCL_FUZZ_IMAGE_MUTATOR_H

#include <stddef.h>
#include <stdint.h>

/* Of libFuzzer: changes bytes in place and returns their new number. */
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
/* What libFuzzer calls when a target has it. */
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

/* Likewise. */
size_t fuzz_mutate_image(uint8_t *data, size_t size, size_t max_size, unsigned seed);

#endif
