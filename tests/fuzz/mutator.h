/* The custom mutators of the targets. */
#ifndef GSCL_FUZZ_MUTATOR_H
#define GSCL_FUZZ_MUTATOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Of libFuzzer: changes bytes in place and returns their new number. */
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
/* What libFuzzer calls when a target has it. */
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

/* Likewise, of a gscl file, which begins with the magic bytes, or else of a bare picture.  Keeps what a reader checks first:
 * magic, check, blocks and the end of the picture. */
size_t fuzz_mutate_file(uint8_t *data, size_t size, size_t max_size, unsigned seed);
/* Likewise, of a list of packets, or else of any bytes.  Keeps the checks of packets and the ends of their pictures. */
size_t fuzz_mutate_packets(uint8_t *data, size_t size, size_t max_size, unsigned seed);
/* Likewise, of an image file.  Keeps the checksums of PNG right. */
size_t fuzz_mutate_image(uint8_t *data, size_t size, size_t max_size, unsigned seed);

/* ---- What mutators share ---- */

/* Begins pseudo-random numbers, and gives the next one, below n. */
void fuzz_begin_picks(unsigned seed);
uint32_t fuzz_pick(uint32_t n);
/* The size of the picture, of a file or of a packet, that a decoder of these bytes reads, if it is smaller. */
size_t fuzz_picture_end(const uint8_t *picture, size_t size, bool in_packet);

#endif
