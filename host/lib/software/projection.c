#include "software/projection.h"

#include <math.h>

#include "runtime/elementary.h"

#define REACH2 (2.0 * (double)GSCL_SUPPORT) /* squared distance of the outline, in axes */
#define TO_FRAME 0.84932180028801907        /* sqrt(log2(e) / 2): exp(-d^2 / 2) = 2^-(TO_FRAME d)^2 */

/* Columns beyond the outline that are drawn in addition: an absolute part and one of the half chord.  Where rounding
 * moves the outline by less, weights that are not 0 are never cut off. */
#define MARGIN 0.01
#define MARGIN_PART 1e-4

/* The integers from x on, and those up to x, within 0..last; none when the first is above the last.  x may be beyond the
 * range of int.  ceil and floor would be calls on many processors. */
static int first_from(double x, int last) {
    const int whole = x <= 0 ? 0 : x > last ? last + 1 : (int)x;
    return x > whole ? whole + 1 : whole;
}
static int last_to(double x, int last) {
    return x < 0 ? -1 : x >= last ? last : (int)x;
}

/* Rows or columns whose centres lie within `half` of the centre, inside an image of `size` pixels. */
static bool cover(double centre, double half, uint32_t size, uint16_t *first, uint16_t *last) {
    const int from = first_from(centre - half - 0.5, (int)size - 1), to = last_to(centre + half - 0.5, (int)size - 1);
    *first = (uint16_t)from;
    *last = (uint16_t)(to < 0 ? 0 : to);
    return from <= to;
}

static void project_colour(const gscl_kernel_options *options, const float *params, gscl_ellipse *e) {
    const int channels = options->colours + options->alpha_channel;
    for (int k = 0; k < channels; k++)
        e->colour[k] = params[GSCL_COLOUR + k];
    e->opacity = options->opacity ? (float)(1 / (1 + gscl_exp(-(double)params[GSCL_OPACITY]))) : 1.0f;
    e->wave_x = params[GSCL_WAVE_X];
    e->wave_y = params[GSCL_WAVE_Y];
    e->wave_phase = params[GSCL_WAVE_PHASE];
    e->wave_amplitude = options->texture ? params[GSCL_WAVE_AMPLITUDE] : 0.0f;
}

bool gscl_ellipse_project(const gscl_kernel_options *options, const float *params, uint32_t width, uint32_t height,
                          gscl_ellipse *e) {
    const double s1 = gscl_exp((double)params[GSCL_LOG_S1]);
    const double s2 = options->shape == GSCL_SHAPE_ISOTROPIC ? s1 : gscl_exp((double)params[GSCL_LOG_S2]);
    const double theta = options->shape == GSCL_SHAPE_ROTATED ? (double)params[GSCL_THETA] : 0.0;
    const double c = gscl_cos(theta), s = gscl_sin(theta), i1 = TO_FRAME / s1, i2 = TO_FRAME / s2;
    const double xx = c * c * s1 * s1 + s * s * s2 * s2, yy = s * s * s1 * s1 + c * c * s2 * s2;
    *e = (gscl_ellipse){.x = params[GSCL_X],
                        .y = params[GSCL_Y],
                        .ux = (float)(c * i1),
                        .uy = (float)(s * i1),
                        .vx = (float)(-s * i2),
                        .vy = (float)(c * i2),
                        .slope = (float)(c * s * (s1 * s1 - s2 * s2) / yy),
                        .curve = (float)(1 / yy),
                        .width2 = (float)(s1 * (s1 / yy) * (s2 * s2))};
    project_colour(options, params, e);
    const double half_width = sqrt(REACH2 * xx), half_height = sqrt(REACH2 * yy);
    return cover(e->x, half_width + MARGIN + MARGIN_PART * half_width, width, &e->first_column, &e->last_column) &&
           cover(e->y, half_height, height, &e->first_row, &e->last_row);
}

/* The columns of a chord.  Without branches, because nothing can foresee them. */
static void chord_columns(double middle, double half, int last_column, gscl_chord *chord) {
    double left = middle - half, right = middle + half, limit = last_column;
    left = left > 0 ? left : 0;
    left = left < limit + 1 ? left : limit + 1;
    right = right < limit ? right : limit;
    right = right > -1 ? right : -1;
    chord->first = (int)left;
    chord->first += left > chord->first;
    chord->last = (int)(right + 1) - 1;
    /* Near the middle, u and v are small, and their roundings with them. */
    middle = middle > left ? middle : left;
    middle = middle < right ? middle : right;
    chord->column = (int)middle;
}

static void chord_exponent(const gscl_ellipse *e, double dy, gscl_chord *chord) {
    const double ux = (double)e->ux, vx = (double)e->vx, dx = chord->column + 0.5 - (double)e->x;
    const double u = ux * dx + (double)e->uy * dy, v = vx * dx + (double)e->vy * dy;
    chord->a = (float)-(ux * ux + vx * vx);
    chord->b = (float)(-2 * (ux * u + vx * v));
    chord->c = (float)(REACH2 * TO_FRAME * TO_FRAME - (u * u + v * v));
    chord->turns = 0.0f;
    if (e->wave_amplitude > 0.0f) {
        const double turns = dx * (double)e->wave_x + dy * (double)e->wave_y - (double)e->wave_phase;
        chord->turns = (float)(turns - floor(turns));
    }
}

void gscl_ellipse_chords(const gscl_ellipse *e, int row, int count, int width, gscl_chord *chords) {
    const double slope = (double)e->slope, curve = (double)e->curve, width2 = (double)e->width2;
    for (int i = 0; i < count; i++) {
        const double dy = row + i + 0.5 - (double)e->y, half2 = (REACH2 - curve * dy * dy) * width2;
        const double half = half2 > 0 ? half2 : 0;
        chord_columns((double)e->x + slope * dy - 0.5, sqrt(half) * (1 + MARGIN_PART) + MARGIN, width - 1, &chords[i]);
        chord_exponent(e, dy, &chords[i]);
    }
}
