/* Numbers of the image room that were found by trying. */
#ifndef GSCL_LIB_IMAGE_TUNABLES_H
#define GSCL_LIB_IMAGE_TUNABLES_H

struct gscl_image_tunables {
    /* Resolution of the histogram of colours in which a flat background is sought: bits of each channel. */
    int histogram_bits;
    /* Part of the pixels that a flat background must have. */
    double min_background;
    /* Largest difference of a channel (0..1) at which a pixel has the colour of the background. */
    float colour_tolerance;
};

extern const struct gscl_image_tunables gscl_image_tunables;

#endif
