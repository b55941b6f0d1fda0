#include "runtime/tunables.h"

const struct gscl_runtime_tunables gscl_runtime_tunables = {
    .cpu_lanes = 16,
    .cpu_rows = 16,
    .cpu_cached_rows = 512,
    .cpu_splat_lanes = 16,
    .cpu_link_splats = 64,
    .gpu_lanes = 4,
    .gpu_rows = 1,
    .gpu_band_items = 256,
    .gpu_bin_items = 64,
    .gpu_link_items = 32,
    .gpu_slot_items = 32,
    .gpu_rdo_items = 64,
};
