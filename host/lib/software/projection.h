/* The ellipse of a splat in the drawn image: which pixels of a row it covers, and the exponent of its Gaussian there. */
#ifndef GSCL_LIB_PROJECTION_H
#define GSCL_LIB_PROJECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "cl/constants.h"
#include "runtime/kernel_options.h"

/* Rows and columns of the drawn image around an outline. */
typedef struct gscl_box {
    uint16_t first_row, last_row, first_column, last_column;
} gscl_box;

/* A splat as it is drawn.  (ux, uy) and (vx, vy) take a place relative to the centre into the splat's own frame (u, v),
 * where the Gaussian is 2^-(u^2 + v^2).  A row at the distance dy from the centre crosses the outline in a chord whose
 * middle lies at x + slope * dy and whose half length is sqrt((2 * GSCL_SUPPORT - curve * dy^2) * width2). */
typedef struct gscl_ellipse {
    float x, y; /* centre, pixels of the drawn image */
    float ux, uy, vx, vy;
    float slope, curve, width2;
    float opacity; /* 0..1 */
    float colour[4];
    float wave_x, wave_y, wave_phase, wave_amplitude; /* as the parameters GSCL_WAVE_... */
    gscl_box box;
} gscl_ellipse;

/* The part of a row that a splat covers.  At `column` + t the Gaussian is 2^(z - s), with z = (a t + b) t + c and the
 * value s that the exponent has on the outline: z is negative outside. */
typedef struct gscl_chord {
    int first, last; /* columns of the drawn image */
    int column;
    float a, b, c;
    float turns; /* phase of the wave at `column`, 0..1 */
} gscl_chord;

/* Computes the ellipse from GSCL_PARAMS parameters for a drawn image of `width` x `height` pixels.  Returns false where
 * the outline does not touch the image. */
bool gscl_ellipse_project(const gscl_kernel_options *options, const float *params, uint32_t width, uint32_t height,
                          gscl_ellipse *ellipse);

/* Computes the chords of `count` rows of the drawn image from `row` on; the image is `width` pixels wide.  A chord depends
 * on the splat and its row alone and lies inside the image; first > last where the outline does not cross the row. */
void gscl_ellipse_chords(const gscl_ellipse *ellipse, int row, int count, int width, gscl_chord *chords);

#endif
