/* The software renderer: splats to the samples of a rectangle, on one core, with memory for the splats and one block of
 * pixels. */
#ifndef GSCL_LIB_SOFTWARE_H
#define GSCL_LIB_SOFTWARE_H

#include "runtime/context.h"
#include "runtime/kernel_options.h"

typedef struct gscl_software gscl_software;

/* A rectangle of a drawn image of full_width x full_height pixels (1..GSCL_MAX_DIMENSION). */
typedef struct gscl_software_view {
    uint32_t full_width, full_height;
    uint32_t x, y; /* of the rectangle, whose size is that of the image that is drawn */
} gscl_software_view;

/* A drawing with room for `count` splats; NULL without memory.  `options` as for kernels; those of the fit and of
 * measurements have no effect.  The drawing keeps the pointer to them. */
gscl_software *gscl_software_create(const gscl_kernel_options *options, const gscl_software_view *view, uint32_t count);
/* Accepts NULL. */
void gscl_software_free(gscl_software *software);

/* Adds the next splat: GSCL_PARAMS parameters in pixels of the drawn image. */
void gscl_software_add(gscl_software *software, const float *params);

/* Draws into image->pixels.  A pixel has the same value in every rectangle. */
void gscl_software_draw(gscl_software *software, const float background[4], const gscl_image *image);
/* Rows from `row` of the rectangle on, of at most `height`, that are drawn at once. */
uint32_t gscl_software_rows(const gscl_software *software, uint32_t row, uint32_t height);
/* Draws them into an image of their own. */
void gscl_software_draw_rows(gscl_software *software, const float background[4], uint32_t row, const gscl_image *rows);

#endif
