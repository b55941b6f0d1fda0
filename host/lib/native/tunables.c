#include "native/tunables.h"

const struct gscl_native_tunables gscl_native_tunables = {
    .thread_s = 10e-6,
    .awake_s = 100e-6,
    .parts = 8,
};
