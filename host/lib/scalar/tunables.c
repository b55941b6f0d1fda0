#include "scalar/tunables.h"

const gscl_effort_preset gscl_effort_presets[GSCL_MAX_EFFORT + 1] = {
    /* steps, passes, finest, surplus, lambda_scale, rounds */
    {60, 0, 1, 1.12, 1.0, 0},      {100, 2, 0, 1.08, 0.5, 0},     {180, 3, 0, 1.08, 0.5, 0},
    {300, 4, 0, 1.08, 0.5, 14},    {430, 5, 0, 1.08, 0.5, 24},    {600, 6, 0, 1.08, 0.5, 40},
    {1000, 8, 0, 1.08, 0.5, 70},   {1800, 10, 0, 1.08, 0.5, 120}, {3300, 14, 0, 1.08, 0.5, 210},
    {6000, 20, 0, 1.08, 0.5, 360},
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
    .max_weighted_distance = 60.0,
    .adapt_at = 0.6,
    .adapt_again_at = 0.95,
    .report_interval = 25,
    .sort_interval = 25,
    .fit_share = 0.75,

    .max_search_bytes = 600,
    .search_first_steps = 600,
    .search_first_passes = 6,
    .search_pixels = 24000,
    .search_distance = 20.0,
    .search_removed = 0.02,
    .search_added = 0.03,
    .search_steps = 200,
    .search_passes = 3,
    .search_first_price = 1.0,
    .search_final_pixels = 360000,
    .search_additions = 4,
    .search_trials = 6,
    .search_price_step = 1.5,
    .search_fit_share = 0.2,
    .search_passes_share = 0.25,

    .model_from = 0.15,
    .model_interval = 5,
    .curvature_of_passes = 0.6f,

    .elongation_price = 0.5,
    .min_explained = 0.05,

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

    .rdo_growth = 1.3,
    .rdo_growth_pixels = 3.0,
    .rdo_count_floor = 0.05,
    .rdo_count_spread = 0.25,
    .rdo_textured_share = 0.05,
    .rdo_texture_count = 1.0,
};
