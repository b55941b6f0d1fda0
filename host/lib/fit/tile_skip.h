/* Tiles with little loss are skipped for some steps of the fit (fit_tiles in cl/fit.cl). */
#ifndef GSCL_LIB_FIT_TILE_SKIP_H
#define GSCL_LIB_FIT_TILE_SKIP_H

#include "cl/structs.h"
#include "runtime/buffer.h"

typedef struct gscl_tile_skip {
    gscl_buffer skip_until; /* for each tile (int32_t) the step with which it is computed again, or 0 */
    int32_t step;           /* steps since the last reset: there are losses to compare with when it is above 0 */
} gscl_tile_skip;

/* Computes all tiles from the next step on, until a threshold is set again in `control` (gscl_fit_control): for new splats
 * or a new level. */
gscl_result gscl_tile_skip_reset(gscl_tile_skip *skip, gscl_context *context, size_t tiles, const gscl_buffer *control);
/* The threshold, as a part of the mean loss per sample of the last step.  `non_flat_tiles`: the part of the tiles that is not
 * flat. */
float gscl_tile_skip_share(int channels, double non_flat_tiles);
/* Accepts a zeroed state. */
void gscl_tile_skip_free(gscl_tile_skip *skip);

#endif
