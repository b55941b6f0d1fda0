/* The sums of a block of pixels while splats are drawn into it, and their blending. */
#ifndef GSCL_LIB_CANVAS_H
#define GSCL_LIB_CANVAS_H

#include "runtime/kernel_options.h"
#include "software/projection.h"
#include "software/tunables.h"

/* Floats from row to row: a row is drawn up to a multiple of GSCL_ROW_LANES pixels. */
#define GSCL_CANVAS_STRIDE (GSCL_BLOCK_COLUMNS + GSCL_ROW_LANES)
#define GSCL_CANVAS_PLANE (GSCL_CANVAS_STRIDE * GSCL_BLOCK_ROWS)
#define GSCL_CANVAS_PLANES 5 /* up to four channels, then weights */

/* Planes of a block.  The last plane has the sum of weights (`normalized`), the transmittance less 1 (`alpha`), or
 * nothing (`sum`).  Splats are summed in runs, because the rounding errors of a sum grow with the number of its terms:
 * `run` has the sums of the current run, `total` those of the runs before. */
typedef struct gscl_canvas {
    int blend, colours, channels; /* of the drawing */
    int image_width;              /* of the whole drawn image */
    int x, y, width, height;      /* the block: its place in the drawn image, and its size there, pixels */
    bool is_dirty;                /* something was drawn in this run */
    float run[GSCL_CANVAS_PLANES][GSCL_CANVAS_PLANE];
    float total[GSCL_CANVAS_PLANES][GSCL_CANVAS_PLANE];
} gscl_canvas;

/* Begins a block: `canvas` has all fields up to its size. */
void gscl_canvas_begin(gscl_canvas *canvas, const float background[4]);
/* Draws the part of a splat that lies in the block.  In blend `alpha` the splats come from front to back. */
void gscl_canvas_draw(gscl_canvas *canvas, const gscl_ellipse *ellipse);
/* Ends a run of splats. */
void gscl_canvas_end_run(gscl_canvas *canvas);
/* Turns the sums of row `row` of the block into values of the coded channels, in place: total[k] + row * stride. */
void gscl_canvas_finish_row(gscl_canvas *canvas, int row, const float background[4]);

#endif
