/* Numbers of drawing and quantising that were found by trying. */
#ifndef GSCL_LIB_DECODE_TUNABLES_H
#define GSCL_LIB_DECODE_TUNABLES_H

#include <stddef.h>
#include <stdint.h>

struct gscl_decode_tunables {
    /* Bytes of a band of the drawn image: a larger image is drawn in several bands, so that the device needs room for
     * one band only. */
    int band_bytes;
    /* Evaluations of a band where the caller has a callback: a tenth of a second of a core. */
    double band_work;

    /* Pixels up to which the device "host" draws in software, which begins sooner than kernels do. */
    uint64_t software_pixels;

    /* Entries that a row of tiles has room for at first, in addition to one for each splat. */
    int first_entries;
    /* Part 1 / spare_part of a row's entries must be spare after an exact binning; otherwise the lists are enlarged by
     * the part 1 / growth_part.  Splats move until the next exact binning. */
    int spare_part;
    int growth_part;
    /* Largest number of bands of rows of tiles; the rows of a band share a list of splats.  Where a group fills the list of a
     * tile, more of them, as long as their lists have room for at most gpu_listed splats, four bytes each: each of many groups
     * goes over the list of its band, and where bands are single rows begin_lists counts the splats of tiles, too. */
    int max_bands;
    int gpu_max_bands;
    size_t gpu_listed;

    /* Finer steps of luma and of chroma that are tried for the colour of a flat background: steps. */
    int max_finer_luma;
    int max_finer_chroma;
    /* Squared error of that colour, in (1/255)^2, that a bit per splat must save. */
    double error_per_bit;
};

extern const struct gscl_decode_tunables gscl_decode_tunables;

#endif
