#include "runtime/tunables.h"

#include "cl/constants.h"

const struct gscl_runtime_tunables gscl_runtime_tunables = {
    .cpu_lanes = GSCL_CPU_LANES,
    .cpu_rows = GSCL_CPU_ROWS,
    .cpu_cached_rows = GSCL_CPU_CACHED_ROWS,
    .cpu_splat_lanes = GSCL_CPU_SPLAT_LANES,
    .cpu_link_splats = GSCL_CPU_LINK_SPLATS,
    .cpu_counted_links = 2048,
    .cpu_chunk_items = 16,
    .gpu_lanes = 4,
    .gpu_rows = 1,
    .gpu_chunk_items = 64,
    .gpu_chunk_lanes = 1,
    .gpu_band_items = 256,
    .gpu_bin_items = 64,
    .gpu_link_splats = 8,
    .gpu_counted_links = 8192,
    .gpu_slot_items = 32,
    .gpu_rdo_items = 256,
};
