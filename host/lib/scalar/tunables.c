#include "scalar/tunables.h"

const gscl_effort_preset gscl_effort_presets[GSCL_MAX_EFFORT + 1] = {
    /* steps, passes, finest, surplus, lambda_scale */
    {60, 0, 1, 1.12, 1.0},    {100, 2, 0, 1.08, 0.5},   {180, 3, 0, 1.08, 0.5},  {300, 4, 0, 1.08, 0.5},
    {430, 5, 0, 1.08, 0.5},   {600, 6, 0, 1.08, 0.5},   {1000, 8, 0, 1.08, 0.5}, {1800, 10, 0, 1.08, 0.5},
    {3300, 14, 0, 1.08, 0.5}, {6000, 20, 0, 1.08, 0.5},
};

const gscl_effort_preset gscl_probe_preset = {.steps = 180, .passes = 2, .surplus = 1.08, .lambda_scale = 0.5};

const struct gscl_scalar_tunables gscl_scalar_tunables = {
    .start_share = 0.3,
    .expected_bits_per_splat = 32.0,
    .min_bits_per_splat = 26.0,
    .wide_surplus = 0.2,
    .wide_steps = 0.6,
    .densify_rounds = 12,
    .densify_until = 0.48,
    .measure_round = 8,

    .small_image_pixels = 65536,
    .full_size_distance = 12.0,
    .quarter_until = 0.3,
    .half_until = 0.55,
    .max_quarter_until = 0.5,
    .max_half_until = 0.85,
    .level_check_interval = 4,
    .min_level_residual = 0.1,
    .rounding_residual = 0.98e-6,
    .probe_distance = 12.0,
    .min_covering_splats = 4,

    .learning_rate = 2.0,
    .min_learning_rate = 0.02,
    .quantise_from = 0.25,
    .adapt_at = 0.6,
    .adapt_again_at = 0.95,
    .model_from = 0.15,
    .model_interval = 4,
    .report_interval = 25,
    .sort_interval = 25,
    .fit_share = 0.75,

    .texture_effort = 1,
    .scan_interval = 3,
    .min_textured_share = 0.01,

    .budget_aim = 0.99,
    .full_share = 0.985,
    .densify_below = 0.97,
    .densify_steps_divisor = 12,
    .max_densify_steps = 80,
    .max_densifications = 4,
    .lambda_gain = 2.0,
    .final_lambda_gain = 4.0,
    .excess_exponent = 1.5,
    .rollback_factor = 0.7,
    .slack_factor = 0.5,
    .max_final_passes = 12,
    .max_slack_passes = 4,
    .min_lambda_scale = 0.02,
    .max_lambda_scale = 1e4,

    .layer_shares = {0.1, 0.25, 0.5, 1.0},
    .min_layer_bytes = 60.0,

    .curvature_of_passes = 0.6f,
    .rdo_growth = 1.3,
    .rdo_growth_pixels = 3.0,
    .rdo_count_floor = 0.05,
    .rdo_count_spread = 0.25,
    .rdo_textured_share = 0.05,
    .rdo_texture_count = 1.0,
};
