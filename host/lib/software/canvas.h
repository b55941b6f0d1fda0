/* The sums of a block of pixels while splats are drawn into it, and their blending. */
#ifndef GSCL_LIB_CANVAS_H
#define GSCL_LIB_CANVAS_H

#include <stddef.h>

#include "runtime/kernel_options.h"
#include "software/projection.h"
#include "software/tunables.h"

#define GSCL_MAX_STRIDE (GSCL_BLOCK_COLUMNS + GSCL_ROW_LANES)

/* Planes of a block, one for each channel and one for weights.  The last plane has the sum of weights (`normalized`), the
 * transmittance less 1 (`alpha`), or nothing (`sum`).  Splats are summed in runs, because the rounding errors of a sum grow
 * with the number of its terms: `run` has the sums of the current run, `total` those of the runs before. */
typedef struct gscl_canvas {
    int blend, colours, channels; /* of the drawing */
    int image_width;              /* of the whole drawn image */
    int stride, plane;            /* floats from row to row, and from plane to plane */
    float *run, *total;
    int x, y, width, height; /* the block: its place in the drawn image, and its size there, pixels */
    bool is_dirty;           /* something was drawn in this run */
} gscl_canvas;

/* Floats of a canvas for blocks of so many columns, a multiple of GSCL_ROW_LANES up to GSCL_BLOCK_COLUMNS, and rows, 1 to
 * GSCL_BLOCK_ROWS. */
size_t gscl_canvas_floats(const gscl_kernel_options *options, int columns, int rows);
/* Sets the fields up to `total`, but for image_width.  `floats`: memory for gscl_canvas_floats. */
void gscl_canvas_init(gscl_canvas *canvas, const gscl_kernel_options *options, int columns, int rows, float *floats);

/* Begins the block of the fields from x to height. */
void gscl_canvas_begin(gscl_canvas *canvas, const float background[4]);
/* Draws the part of a splat that lies in the block.  In blend `alpha` the splats come from front to back. */
void gscl_canvas_draw(gscl_canvas *canvas, const gscl_ellipse *ellipse);
/* Ends a run of splats. */
void gscl_canvas_end_run(gscl_canvas *canvas);
/* Turns the sums into values of the coded channels, in place: that of channel k at column i of row j of the block is
 * total[k * plane + j * stride + i]. */
void gscl_canvas_finish(gscl_canvas *canvas, const float background[4]);

#endif
