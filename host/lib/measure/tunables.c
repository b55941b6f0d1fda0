#include "measure/tunables.h"

const struct gscl_measure_tunables gscl_measure_tunables = {
    .warm_up_runs = 3,
    .multiply_add_items = 4096,
    .copy_bytes = 64u << 20,
    .forward_flop = 28.0,
    .step_flop = 100.0,

    .max_part_side = 128,
    .difference_step = 1e-6,

    .unquantised_steps = 60,
    .unquantised_rate = 0.1f,
};
