#include "fit/tunables.h"

const struct gscl_fit_tunables gscl_fit_tunables = {
    .min_level_side = 32,
    .min_axis = 0.5f,
    .max_aspect = 64.0f,
    .check_interval = 8,
    .max_occupancy = 24.0,
    .max_occupancy_of_smaller_levels = 48.0,
    .max_occupancy_of_alpha = 150.0,
    .tiles_of_small_splat = 4.0,
    .axis_reduction = 0.2f,
    .skip_threshold = 0.02,
    .min_non_flat_tiles = 0.1,
    .seed_axis = 0.4f,
    .new_axis = 0.45f,
    .new_opacity = -0.5f,
    .error_radius = 0.35f,
    .background_distance = 1.5f,
    .min_non_flat_pixels = 0.02f,
    .residual_outliers = 0.01,
};
