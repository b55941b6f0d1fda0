#include "image/tunables.h"

const struct gscl_image_tunables gscl_image_tunables = {
    .histogram_bits = 4,
    .min_background = 0.25,
    .colour_tolerance = 1.5f / 255.0f,
};
