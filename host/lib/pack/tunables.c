#include "pack/tunables.h"

const struct gscl_pack_tunables gscl_pack_tunables = {
    .rounding = 1e-4,
    .same_place = 1.0 / 128,
    .least_weight = 1.0 / 32,
    .finest_factor = 0.125,
    .coarsest_factor = 4,
    .steps_per_octave = 4,
    .surpluses = {1.0, 1.1},
    .first_share = 0.87,
    .unreached_share = 1.05,
    .max_trials = 6,
    .psnr_excess = 0.03,
};
