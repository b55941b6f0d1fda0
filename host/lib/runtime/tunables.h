/* Numbers of this room that were found by trying.  All change speed; of files and decoded images none changes more than
 * roundings, of sums whose order lanes and rows decide. */
#ifndef GSCL_LIB_RUNTIME_TUNABLES_H
#define GSCL_LIB_RUNTIME_TUNABLES_H

#include <stdint.h>

struct gscl_runtime_tunables {
    int cpu_lanes;       /* pixels: neighbours of a row in one vector, CPU mapping; 1, 4 or 16 */
    int cpu_rows;        /* rows: height of the part of a tile that a work-item draws, CPU mapping; divides 16 */
    int cpu_cached_rows; /* pixel vectors: Gaussians that a work-item of fit_tiles caches for its backward pass, CPU
                            mapping; 512 take 32 KB */
    int cpu_splat_lanes; /* splats: handled at once by a work-item of a fit, CPU mapping; 1 or GSCL_MAX_SPLAT_LANES */
    int cpu_link_splats; /* splats: whose links to entries of lists a work-item numbers, CPU mapping */
    /* Splats: whose links are numbered without a kernel that counts those of blocks first, CPU mapping; up to here each
     * work-group can count those before it, and the kernel would have few work-items.  1024 takes 1.03 times as long for 1800
     * splats. */
    int cpu_counted_links;
    int cpu_chunk_items; /* work-items: of a group that take a pixel vector each, CPU mapping; few, so that small images
                            still occupy all cores */
    int gpu_lanes;       /* pixels: neighbours of a row in one vector, GPU mapping; 1, 4 or 16 */
    int gpu_rows;        /* rows: height of the part of a tile that a work-item draws, GPU mapping; divides 16 */
    int gpu_chunk_items; /* work-items: of a group that take a pixel vector each, GPU mapping; a whole number of waves */
    int gpu_chunk_lanes; /* pixels: as gpu_lanes, of the work-items of the visual loss and of SSIM.  4 take up to 150 registers
                            each, and spill some on RDNA; neighbouring work-items load neighbouring pixels with 1 */
    int gpu_band_items;  /* work-items: of a group that lists the splats of a band, GPU mapping; a power of 2 */
    int gpu_bin_items;   /* work-items: of a group that fills the list of a tile, GPU mapping; a power of 2 */
    int gpu_link_splats; /* splats: whose links a group of gpu_band_items numbers, GPU mapping */
    int gpu_counted_links; /* splats: as cpu_counted_links, GPU mapping; more, because each launch waits for the one before */
    int gpu_slot_items; /* work-items: of a group that sums the slots of a splat, GPU mapping; at least 11, the sums of a
                             slot */
    int gpu_rdo_items; /* work-items: of a group that visits a splat in a rate-distortion pass, GPU mapping; a power of 2
                           from 32 to 256.  Fewer leave registers for more groups at once, but launches have few groups, and
                           each takes as long as its largest splat */
};

extern const struct gscl_runtime_tunables gscl_runtime_tunables;

#endif
