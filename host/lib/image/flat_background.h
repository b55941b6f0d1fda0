/* Pictures of things on a plain ground: drawings, text, stars. */
#ifndef GSCL_LIB_GROUND_H
#define GSCL_LIB_GROUND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The one colour of a good part of a picture. */
typedef struct gscl_flat_background {
    float colour[4];
    double pixels; /* the part of the pixels that has it; 0: no colour has a good part, */
    double tiles;  /* the part of the tiles (cl/constants.h) that hold nothing else */
} gscl_flat_background;

/* `planes`: `channels` (1 to 4) planes of width * height values in 0..1.  False: out of memory. */
bool gscl_find_flat_background(const float *planes, uint32_t width, uint32_t height, int channels,
                               gscl_flat_background *flat);
/* About the part of the other tiles' pixels that has it: small where one border divides the ground from the rest. */
double gscl_background_share_of_non_flat_tiles(const gscl_flat_background *ground);
/* Whether pixel `at` has that colour; `pixels`: of a plane. */
bool gscl_matches_background(const float *planes, size_t pixels, int channels, const float colour[4], size_t at);

#endif
