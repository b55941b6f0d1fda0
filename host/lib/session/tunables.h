/* Numbers of session/ that were found by trying. */
#ifndef GSCL_LIB_SESSION_TUNABLES_H
#define GSCL_LIB_SESSION_TUNABLES_H

#include <stdint.h>

struct gscl_session_tunables {
    uint64_t max_fit_pixels;     /* pixels: a larger image is fitted at a smaller level of the pyramid */
    double min_background_share; /* share of the pixels of non-flat tiles that have the background's colour; above it
                                    the image has isolated objects and its splats get opacity */
    double stages_share; /* 0..1; of the time of an encode, in its progress, that its stages take: the rest is for
                                    writing and measuring the file */
    int trace_points;    /* trace points of a fit, besides those of the passes that follow */
};

extern const struct gscl_session_tunables gscl_session_tunables;

#endif
