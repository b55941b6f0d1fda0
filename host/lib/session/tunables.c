#include "session/tunables.h"

const struct gscl_session_tunables gscl_session_tunables = {
    .max_fit_pixels = 1u << 25,  /* splats draw at any size */
    .min_background_share = 0.1, /* about the share that one straight border through a small image leaves */
    .stages_share = 0.99,
    .trace_points = 24,
};
