#include "opencl/tunables.h"

const struct gscl_opencl_tunables gscl_opencl_tunables = {
    .found_build_s = 0.05,
    .cache_bytes = UINT64_C(64) << 20,
};
