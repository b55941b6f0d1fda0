/* Drawing in memory of the caller: splats to the samples of strips of the drawn image. */
#ifndef GSCL_LIB_STRIPS_H
#define GSCL_LIB_STRIPS_H

#include <gscl/gscl.h>

#include "runtime/kernel_options.h"
#include "software/canvas.h"
#include "software/projection.h"

/* Returns the ellipse of splat `i`, which gscl_strips_add had: one that the owner keeps, or one that it writes to *room. */
typedef const gscl_ellipse *(*gscl_ellipse_source)(void *owner, uint32_t i, gscl_ellipse *room);

/* No box of a splat: such a splat does not touch the image. */
#define GSCL_NO_BOX ((gscl_box){.first_row = UINT16_MAX})

typedef struct gscl_strips {
    const gscl_kernel_options *options;
    int columns,
        rows; /* of a block, as gscl_canvas_floats takes them; an image of more columns has GSCL_BLOCK_COLUMNS */
    gscl_ellipse_source source;
    void *owner;
    uint32_t count; /* splats so far */
    gscl_box *boxes;
    uint32_t *listed;      /* splats that touch rows band..band + GSCL_BLOCK_ROWS - 1, in their order */
    uint32_t listed_count; /* of band */
    uint32_t band;         /* a multiple of GSCL_BLOCK_ROWS; any other number before the first drawing */
    gscl_canvas canvas;
} gscl_strips;

/* Bytes of memory for the drawing of `count` splats in blocks of this size. */
size_t gscl_strips_memory(const gscl_kernel_options *options, int columns, int rows, uint32_t count);

/* Begins a drawing without splats, of an image of this width, in so much memory, aligned as for uint32_t.  `strips` has the
 * fields up to `owner`, of whose options those of the fit and of measurements have no effect; the others are set. */
void gscl_strips_begin(gscl_strips *strips, uint32_t full_width, uint32_t count, void *memory);
/* Adds the next splat. */
static inline void gscl_strips_add(gscl_strips *strips, gscl_box box) {
    strips->boxes[strips->count++] = box;
}

/* Draws image->height rows of the drawn image from (x, y) on into image->pixels.  A pixel has the same value in every strip,
 * and with blocks of any size. */
void gscl_strips_draw(gscl_strips *strips, uint32_t x, uint32_t y, const float background[4], const gscl_image *image);

#endif
