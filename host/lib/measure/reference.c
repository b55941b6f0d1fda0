#include "measure/reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/ellipse.h"

#define MAX_ALPHA 0.999 /* GSCL_MAX_ALPHA is a float */

static const double pi = 3.14159265358979323846;

gscl_result gscl_reference_create(gscl_reference *r, const gscl_kernel_options *options, const float *params,
                                  size_t count, const float background[4], bool cut) {
    *r = (gscl_reference){.blend = options->blend,
                          .colours = options->colours,
                          .channels = options->colours + options->alpha_channel,
                          .opacity = options->opacity,
                          .texture = options->texture,
                          .support = cut ? (double)GSCL_SUPPORT : GSCL_REFERENCE_NO_CUT,
                          .floor = cut ? exp(-(double)GSCL_SUPPORT) : 0,
                          .count = count,
                          .splats = malloc((count + 1) * sizeof *r->splats)};
    if (!r->splats)
        return GSCL_ERROR_OUT_OF_MEMORY;
    for (int k = 0; k < r->channels; k++)
        r->background[k] = background[k];
    for (size_t i = 0; i < count; i++) {
        double p[GSCL_PARAMS];
        for (int k = 0; k < GSCL_PARAMS; k++)
            p[k] = params[i * GSCL_PARAMS + (size_t)k];
        gscl_reference_replace(r, i, p);
    }
    return GSCL_OK;
}

void gscl_reference_free(gscl_reference *r) {
    free(r->splats);
    r->splats = NULL;
}

void gscl_reference_replace(gscl_reference *r, size_t i, const double *p) {
    double c = cos(p[GSCL_THETA]), n = sin(p[GSCL_THETA]), s1 = exp(p[GSCL_LOG_S1]), s2 = exp(p[GSCL_LOG_S2]);
    const gscl_half_size half =
        gscl_ellipse_half_size(p[GSCL_LOG_S1], p[GSCL_LOG_S2], p[GSCL_THETA], 0, sqrt(2 * r->support));
    gscl_reference_splat *s = &r->splats[i];
    *s = (gscl_reference_splat){.x = p[GSCL_X],
                                .y = p[GSCL_Y],
                                .ux = c / s1 * sqrt(0.5),
                                .uy = n / s1 * sqrt(0.5),
                                .vx = -n / s2 * sqrt(0.5),
                                .vy = c / s2 * sqrt(0.5),
                                .half_width = half.width,
                                .half_height = half.height,
                                .opacity = r->opacity ? 1 / (1 + exp(-p[GSCL_OPACITY])) : 1};
    for (int k = 0; k < r->channels; k++)
        s->colour[k] = p[GSCL_COLOUR + k];
    if (!r->texture)
        return;
    s->wave_x = p[GSCL_WAVE_X];
    s->wave_y = p[GSCL_WAVE_Y];
    s->phase = p[GSCL_WAVE_PHASE];
    s->amplitude = p[GSCL_WAVE_AMPLITUDE];
}

/* The pixels of first..end whose centres may lie within `half` of `at`. */
static void clip_span(double at, double half, int *first, int *end) {
    double low = floor(at - half - 0.5), high = ceil(at + half + 0.5);
    if (low > *first)
        *first = low < *end ? (int)low : *end;
    if (high < *end)
        *end = high > *first ? (int)high : *first;
}

gscl_rectangle gscl_reference_box(const gscl_reference *r, size_t i, gscl_rectangle bounds) {
    const gscl_reference_splat *s = &r->splats[i];
    clip_span(s->x, s->half_width, &bounds.x0, &bounds.x1);
    clip_span(s->y, s->half_height, &bounds.y0, &bounds.y1);
    return bounds;
}

/* Blends a splat of weight `w` (opacity included) into a pixel, whose channels are `stride` apart. */
static void blend_pixel(const gscl_reference *r, const gscl_reference_splat *s, double dx, double dy, double w,
                        double *value, size_t stride, double *weight) {
    double wave = 0, a = fmin(w, MAX_ALPHA);
    if (s->amplitude > 0)
        wave = s->amplitude * cos(2 * pi * (dx * s->wave_x + dy * s->wave_y - s->phase));
    *weight += w;
    for (int k = 0; k < r->channels; k++, value += stride) {
        double colour = s->colour[k] + (k < r->colours ? wave : 0);
        *value = r->blend == GSCL_ALPHA ? *value * (1 - a) + colour * a : *value + w * colour;
    }
}

static void draw_splat(const gscl_reference *r, size_t i, gscl_rectangle part, double *planes, double *weights) {
    const gscl_reference_splat *s = &r->splats[i];
    const gscl_rectangle box = gscl_reference_box(r, i, part);
    const size_t width = (size_t)(part.x1 - part.x0), plane = width * (size_t)(part.y1 - part.y0);
    for (int y = box.y0; y < box.y1; y++)
        for (int x = box.x0; x < box.x1; x++) {
            double dx = x + 0.5 - s->x, dy = y + 0.5 - s->y;
            double u = s->ux * dx + s->uy * dy, v = s->vx * dx + s->vy * dy, q = u * u + v * v;
            size_t at = (size_t)(y - part.y0) * width + (size_t)(x - part.x0);
            if (q < r->support)
                blend_pixel(r, s, dx, dy, s->opacity * (exp(-q) - r->floor), planes + at, plane, weights + at);
        }
}

void gscl_reference_draw(const gscl_reference *r, gscl_rectangle part, double *planes, double *weights) {
    const size_t plane = (size_t)(part.x1 - part.x0) * (size_t)(part.y1 - part.y0);
    const bool normalized = r->blend == GSCL_NORMALIZED;
    for (size_t i = 0; i < plane; i++)
        weights[i] = (double)GSCL_EPSILON;
    for (int k = 0; k < r->channels; k++)
        for (size_t i = 0; i < plane; i++)
            planes[(size_t)k * plane + i] = r->background[k] * (normalized ? (double)GSCL_EPSILON : 1);
    for (size_t i = 0; i < r->count; i++)
        draw_splat(r, i, part, planes, weights);
    for (int k = 0; normalized && k < r->channels; k++)
        for (size_t i = 0; i < plane; i++)
            planes[(size_t)k * plane + i] /= weights[i];
}
