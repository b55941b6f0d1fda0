#include "opencl/tunables.h"

const struct gscl_opencl_tunables gscl_opencl_tunables = {
    .found_build_s = 0.05,
    .pinned_least = (size_t)1 << 20,
    .pinned_half = (size_t)4 << 20,
    .cache_bytes = UINT64_C(64) << 20,
};
