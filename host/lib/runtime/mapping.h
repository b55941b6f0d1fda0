/* How kernels map pixels and splats to work-items (cl/pixel.cl, cl/splat_lanes.cl). */
#ifndef GSCL_LIB_MAPPING_H
#define GSCL_LIB_MAPPING_H

#include "runtime/context.h"
#include "runtime/kernel_options.h"

#define GSCL_MAX_SPLAT_LANES 16

/* The work of a work-item in one mapping, as in gscl_runtime_tunables.  0: the value of gscl_runtime_tunables. */
typedef struct gscl_work_shape {
    int lanes, rows, splat_lanes;
} gscl_work_shape;

/* What an implementation of devices changes of the mappings. */
typedef struct gscl_work_shapes {
    bool wide_groups; /* CPUs are like GPUs: AUTO is the GPU mapping, whose groups the other has, too */
    gscl_work_shape cpu, gpu;
} gscl_work_shapes;

/* Whether the context's device gets the GPU mapping where none is asked for. */
bool gscl_mapping_auto(const gscl_context *context);
/* Pixels of a row that a work-item of this context's mapping handles at once. */
int gscl_mapping_lanes(const gscl_context *context);
/* Rows of such pixels that a work-item handles, one after the other. */
int gscl_mapping_rows(const gscl_context *context);
/* Gaussians of a tile that a work-item of `fit_tiles` caches for its backward pass (cl/raster.cl). */
int gscl_mapping_cached_rows(const gscl_context *context);
/* Splats that a work-item of the program's kernels handles at once; at most GSCL_MAX_SPLAT_LANES. */
int gscl_splat_lanes(const gscl_context *context, gscl_program_kind kind);
/* Work-items of a group that draws one tile. */
size_t gscl_tile_group_size(const gscl_context *context);
/* Work-items of a group that lists the splats of a band of rows of tiles or numbers links (cl/bin.cl, cl/links.cl), a power of
 * 2.  The lists do not depend on it: on a device of smaller groups it is as large as they are. */
size_t gscl_band_group_size(const gscl_context *context);
/* Work-items of a group that lists the splats of a tile; 1 where a work-item lists those of a row of tiles. */
size_t gscl_bin_group_size(const gscl_context *context);
/* Splats whose links a group numbers, and up to how many it counts those before them without counts of blocks. */
size_t gscl_link_splats(const gscl_context *context);
int gscl_counted_links(const gscl_context *context);
/* Work-items of a group that sums the slots of a splat (cl/update.cl); 1 where a work-item sums those of gscl_splat_lanes
 * splats. */
size_t gscl_slot_group_size(const gscl_context *context);
/* Work-items of a group that visits a splat in a rate-distortion pass (cl/rdo_items.cl), a power of 2.  The sums that its
 * decisions follow from have another order with another size. */
size_t gscl_rdo_group_size(const gscl_context *context);
/* Halves it, because the device has too few registers for a kernel in groups of this size; false where it is the least. */
bool gscl_rdo_group_halve(gscl_context *context);
/* Work-items of a group that sums (cl/group_sum.cl): a power of 2, at most GSCL_SUM_ITEMS. */
size_t gscl_sum_group_size(const gscl_context *context);
/* Work-items of a group that take one pixel vector each (cl/visual.cl, cl/ssim.cl), the pixels of such a vector, and the groups
 * that take `rows` rows of `width` pixels. */
size_t gscl_chunk_group_size(const gscl_context *context);
int gscl_chunk_lanes(const gscl_context *context);
size_t gscl_chunk_groups(const gscl_context *context, int width, int rows);

/* The most work-items of a group of any kernel. */
size_t gscl_mapping_largest_group(const gscl_context *context);

#endif
