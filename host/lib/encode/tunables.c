#include "encode/tunables.h"

const struct gscl_encode_tunables gscl_encode_tunables = {
    .auto_bpp = 0.125,
    .auto_bytes = 256.0,
    .few_splats = 40,
    .min_visual_bytes = 600,

    .min_probe_bytes = 100,
    .probe_bits = 34,
    .coherence_level = 1,
    .coherence_window = 0.6,
    .max_probe_coherence = 0.3,
    .max_probe_colour = 8.0 / 255,

    .max_trials = 12,
    .tolerance_db = 0.3,
    .db_per_doubling = 2.5,
    .first_bpp = 0.1,
    .min_bytes = 64,
    .max_bpp = 32,
    .max_bytes = 4096,
};
