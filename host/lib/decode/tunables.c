#include "decode/tunables.h"

const struct gscl_decode_tunables gscl_decode_tunables = {
    .band_bytes = 16 << 20,
    .band_work = 5e7,

    .software_pixels = 65536,

    .first_entries = 1024,
    .spare_part = 4,
    .growth_part = 2,
    .max_bands = 32,
    .gpu_max_bands = 256,
    .gpu_listed = (size_t)32 << 20,

    .max_finer_luma = 2,
    .max_finer_chroma = 3,
    .error_per_bit = 2.0,
};
