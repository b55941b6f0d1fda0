#include "native/tunables.h"

const struct gscl_native_tunables gscl_native_tunables = {
    .thread_s = 50e-6,
    .parts = 8,
};
