/* Pictures of things on a plain ground: drawings, text, stars. */
#ifndef GSCL_LIB_GROUND_H
#define GSCL_LIB_GROUND_H

#include <stdbool.h>
#include <stddef.h>

/* Whether a good part of the pixels has one colour, and that colour.  `planes`: `channels` (1 to 4) planes of `pixels`
 * values in 0..1. */
bool gscl_find_ground(const float *planes, size_t pixels, int channels, float colour[4]);
/* Whether pixel `at` has it. */
bool gscl_is_ground(const float *planes, size_t pixels, int channels, const float colour[4], size_t at);

#endif
