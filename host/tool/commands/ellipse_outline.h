/* Drawing splats as ellipse outlines. */
#ifndef GSCL_TOOL_ELLIPSE_OUTLINE_H
#define GSCL_TOOL_ELLIPSE_OUTLINE_H

#include <gscl/gscl.h>

/* Draws the 1-sigma contour of a splat, one pixel wide and smoothed, onto an RGB or RGBA image of U8 samples with packed
 * rows.  `scale_x`, `scale_y`: pixels of the image per pixel of the encoded size. */
void outline_draw(gscl_image *image, const gscl_splat *splat, double scale_x, double scale_y);

#endif
