#include "software/projection.h"

#include "runtime/elementary.h"

#define REACH2 (2 * (gscl_real)GSCL_SUPPORT)    /* squared distance of the outline, in axes */
#define TO_FRAME GSCL_REAL(0.84932180028801907) /* sqrt(log2(e) / 2): exp(-d^2 / 2) = 2^-(TO_FRAME d)^2 */
#define HALF GSCL_REAL(0.5)

/* Columns beyond the outline that are drawn in addition: an absolute part and one of the half chord.  Where rounding
 * moves the outline by less, weights that are not 0 are never cut off. */
#define MARGIN GSCL_REAL(0x1p-6)
#define MARGIN_PART GSCL_REAL(0x1p-13)

/* The integers from x on, and those up to x, within 0..last; none when the first is above the last.  x may be beyond the
 * range of int.  ceil and floor would be calls on many processors. */
static int first_from(gscl_real x, int last) {
    const int whole = x <= 0 ? 0 : x > last ? last + 1 : (int)x;
    return x > whole ? whole + 1 : whole;
}
static int last_to(gscl_real x, int last) {
    return x < 0 ? -1 : x >= last ? last : (int)x;
}

/* Rows or columns whose centres lie within `half` of the centre, inside an image of `size` pixels. */
static bool cover(gscl_real centre, gscl_real half, uint32_t size, uint16_t *first, uint16_t *last) {
    const int from = first_from(centre - half - HALF, (int)size - 1), to = last_to(centre + half - HALF, (int)size - 1);
    *first = (uint16_t)from;
    *last = (uint16_t)(to < 0 ? 0 : to);
    return from <= to;
}

static void project_colour(const gscl_kernel_options *options, const float *params, gscl_ellipse *e) {
    const int channels = options->colours + options->alpha_channel;
    for (int k = 0; k < channels; k++)
        e->colour[k] = params[GSCL_COLOUR + k];
    e->opacity = options->opacity ? (float)(1 / (1 + gscl_exp(-(gscl_real)params[GSCL_OPACITY]))) : 1.0f;
    e->wave_x = params[GSCL_WAVE_X];
    e->wave_y = params[GSCL_WAVE_Y];
    e->wave_phase = params[GSCL_WAVE_PHASE];
    e->wave_amplitude = options->texture ? params[GSCL_WAVE_AMPLITUDE] : 0.0f;
}

bool gscl_ellipse_project(const gscl_kernel_options *options, const float *params, uint32_t width, uint32_t height,
                          gscl_ellipse *e) {
    const gscl_real s1 = gscl_exp((gscl_real)params[GSCL_LOG_S1]);
    const gscl_real s2 = options->shape == GSCL_SHAPE_ISOTROPIC ? s1 : gscl_exp((gscl_real)params[GSCL_LOG_S2]);
    const gscl_real theta = options->shape == GSCL_SHAPE_ROTATED ? (gscl_real)params[GSCL_THETA] : 0;
    const gscl_real c = gscl_cos(theta), s = gscl_sin(theta), i1 = TO_FRAME / s1, i2 = TO_FRAME / s2;
    const gscl_real xx = c * c * s1 * s1 + s * s * s2 * s2, yy = s * s * s1 * s1 + c * c * s2 * s2;
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
    const gscl_real half_width = gscl_real_sqrt(REACH2 * xx), half_height = gscl_real_sqrt(REACH2 * yy);
    return cover(e->x, half_width + MARGIN + MARGIN_PART * half_width, width, &e->box.first_column,
                 &e->box.last_column) &&
           cover(e->y, half_height, height, &e->box.first_row, &e->box.last_row);
}

/* The columns of a chord.  Without branches, because nothing can foresee them. */
static void chord_columns(gscl_real middle, gscl_real half, int last_column, gscl_chord *chord) {
    gscl_real left = middle - half, right = middle + half, limit = last_column;
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

static void chord_exponent(const gscl_ellipse *e, gscl_real dy, gscl_chord *chord) {
    const gscl_real ux = (gscl_real)e->ux, vx = (gscl_real)e->vx,
                    dx = (gscl_real)chord->column + HALF - (gscl_real)e->x;
    const gscl_real u = ux * dx + (gscl_real)e->uy * dy, v = vx * dx + (gscl_real)e->vy * dy;
    chord->a = (float)-(ux * ux + vx * vx);
    chord->b = (float)(-2 * (ux * u + vx * v));
    chord->c = (float)(REACH2 * TO_FRAME * TO_FRAME - (u * u + v * v));
    chord->turns = 0.0f;
    if (e->wave_amplitude > 0.0f) {
        const gscl_real turns = dx * (gscl_real)e->wave_x + dy * (gscl_real)e->wave_y - (gscl_real)e->wave_phase;
        chord->turns = (float)(turns - gscl_real_floor(turns));
    }
}

void gscl_ellipse_chords(const gscl_ellipse *e, int row, int count, int width, gscl_chord *chords) {
    const gscl_real slope = (gscl_real)e->slope, curve = (gscl_real)e->curve, width2 = (gscl_real)e->width2;
    for (int i = 0; i < count; i++) {
        const gscl_real dy = (gscl_real)(row + i) + HALF - (gscl_real)e->y, half2 = (REACH2 - curve * dy * dy) * width2;
        const gscl_real half = half2 > 0 ? half2 : 0;
        chord_columns((gscl_real)e->x + slope * dy - HALF, gscl_real_sqrt(half) * (1 + MARGIN_PART) + MARGIN, width - 1,
                      &chords[i]);
        chord_exponent(e, dy, &chords[i]);
    }
}
