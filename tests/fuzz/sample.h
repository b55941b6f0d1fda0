#ifndef FUZZ_SAMPLE_H
#define FUZZ_SAMPLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Whether what takes long is done with this input: with all in replay.c; where FUZZ_SAMPLE is defined, with one in `interval`, which
 * all its bytes choose, so that the next change of an input that was chosen is not chosen again. */
bool fuzz_is_sampled(const uint8_t *bytes, size_t size, unsigned interval);

#endif
