/* The flat (uniform) background of images of isolated objects: drawings, text, stars. */
#ifndef GSCL_LIB_FLAT_BACKGROUND_H
#define GSCL_LIB_FLAT_BACKGROUND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The colour that a large part of an image has. */
typedef struct gscl_flat_background {
    float colour[4];
    double pixels; /* the part of the pixels that have it; 0: there is no flat background */
    double tiles;  /* the part of the tiles (GSCL_TILE) in which all pixels have it */
} gscl_flat_background;

/* `planes`: `channels` (1 to 4) planes of width * height values in 0..1.  False: out of memory. */
bool gscl_find_flat_background(const float *planes, uint32_t width, uint32_t height, int channels,
                               gscl_flat_background *flat);
/* About the part of the pixels of non-flat tiles that have the colour of the background: small where a single border
 * divides the background from the remaining image. */
double gscl_background_share_of_non_flat_tiles(const gscl_flat_background *flat);

#endif
