/* Numbers of this room that were found by trying.  None changes a file or a decoded image. */
#ifndef GSCL_LIB_OPENCL_TUNABLES_H
#define GSCL_LIB_OPENCL_TUNABLES_H

#include <stddef.h>
#include <stdint.h>

struct gscl_opencl_tunables {
    double found_build_s; /* seconds: a build that takes less found the program built, in a cache of the OpenCL
                             implementation.  PoCL takes 0.001 to 0.01 s for those and 0.1 to 0.7 s for others */
    size_t pinned_least;  /* bytes: smaller reads are left to the driver, which copies them as soon as a wait ends */
    size_t pinned_half; /* bytes: that the device copies while the host copies as many; PCI Express takes 0.1 to 0.4 ms
                             for 4 MB */
    uint64_t cache_bytes; /* bytes: all built programs in the folder of a cache; those of an encode take 0.6 MB with
                             Intel's runtime, and each combination of effects and blends has its own */
};

extern const struct gscl_opencl_tunables gscl_opencl_tunables;

#endif
