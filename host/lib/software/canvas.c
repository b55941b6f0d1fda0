#include "software/canvas.h"

#include <math.h>
#include <string.h>

#include "software/float_bits.h"

/* Functions that are compiled for wider vectors, too; the loader takes the widest that the processor has, which
 * saves a quarter of the time with AVX2.  Their results have the same bits, because each pixel has the same operations, and
 * none is fused.  With the loader of glibc only: that of musl refuses such a library.  Not with ThreadSanitizer, whose code in
 * the function that chooses would run before it has started. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__) && !defined(__UCLIBC__) && \
    !defined(__SANITIZE_THREAD__)
#define FOR_ALL_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define FOR_ALL_VECTORS
#endif

/* Of numbers of pixels, which are multiples of GSCL_ROW_LANES: tells the compiler so, which then needs no loop for a rest. */
#define WHOLE_LANES(n) ((n) & -GSCL_ROW_LANES)

static int planes_of(const gscl_kernel_options *options) {
    return options->colours + options->alpha_channel + 1;
}

/* A row is drawn up to a multiple of GSCL_ROW_LANES pixels. */
size_t gscl_canvas_floats(const gscl_kernel_options *options, int columns, int rows) {
    return 2 * (size_t)planes_of(options) * (size_t)((columns + GSCL_ROW_LANES) * rows);
}

void gscl_canvas_init(gscl_canvas *c, const gscl_kernel_options *options, int columns, int rows, float *floats) {
    c->blend = options->blend;
    c->colours = options->colours;
    c->channels = planes_of(options) - 1;
    c->stride = columns + GSCL_ROW_LANES;
    c->plane = c->stride * rows;
    c->run = floats;
    c->total = floats + (c->channels + 1) * c->plane;
}

static float *plane_of(const gscl_canvas *c, float *planes, int k) {
    return planes + k * c->plane;
}

/* The plane behind those of the channels. */
static float *weights_of(const gscl_canvas *c, float *planes) {
    return plane_of(c, planes, c->channels);
}

static void clear_run(gscl_canvas *c) {
    memset(c->run, 0, (size_t)(c->channels + 1) * (size_t)c->plane * sizeof *c->run);
    c->is_dirty = false;
}

void gscl_canvas_begin(gscl_canvas *c, const float background[4]) {
    const float weight = c->blend == GSCL_NORMALIZED ? GSCL_EPSILON : 0.0f;
    const float factor = c->blend == GSCL_SUM ? 1.0f : weight;
    clear_run(c);
    for (int k = 0; k <= c->channels; k++) {
        const float value = k < c->channels ? factor * background[k] : weight;
        for (int i = 0; i < WHOLE_LANES(c->plane); i++)
            plane_of(c, c->total, k)[i] = value;
    }
}

/* 2^(z - s) for z in 0..s, where s is the exponent on the outline: a polynomial for the 16th root of it, with a relative
 * error below 6e-6 in all. */
static inline float gauss_of(float z) {
    float p = 1.18161102e-07f * z + 8.53439499e-06f;
    p = p * z + 6.06653940e-04f;
    p = p * z + 2.79695895e-02f;
    p = p * z + 6.45648723e-01f;
    p *= p;
    p *= p;
    p *= p;
    return p * p;
}

/* The weight of a Gaussian; exactly 0 for z <= 0. */
static inline float weight_of(float z) {
    return gscl_positive_part(gauss_of(gscl_positive_part(z)) - gauss_of(0.0f));
}

/* cos(2 pi t), |t| < 2^22: folded to a quarter turn of the sine, then a polynomial. */
static inline float cos_turns(float t) {
    const float s = 0.25f - fabsf(t - gscl_nearest_integer(t)), s2 = s * s;
    float p = 3.95358124e+01f * s2 - 7.65496597e+01f;
    p = p * s2 + 8.16009979e+01f;
    p = p * s2 - 4.13416557e+01f;
    p = p * s2 + 6.28318501e+00f;
    return s * p;
}

static inline float weight_at(float a, float b, float c, float t) {
    return weight_of((a * t + b) * t + c);
}

/* The most frequent case: three channels in blend `normalized`, without a wave.  `w`: the plane of weights. */
FOR_ALL_VECTORS static void add_rgb(const gscl_chord *chord, float t0, const float colour[4], float opacity, int n,
                                    float *restrict red, float *restrict green, float *restrict blue,
                                    float *restrict w) {
    const float a = chord->a, b = chord->b, c = chord->c, r = colour[0], g = colour[1], u = colour[2];
    for (int i = 0; i < WHOLE_LANES(n); i++) {
        const float weight = weight_at(a, b, c, t0 + (float)i) * opacity;
        red[i] += weight * r;
        green[i] += weight * g;
        blue[i] += weight * u;
        w[i] += weight;
    }
}

FOR_ALL_VECTORS static void weigh_row(const gscl_chord *chord, float t0, float opacity, int n,
                                      float *restrict weights) {
    const float a = chord->a, b = chord->b, c = chord->c;
    for (int i = 0; i < WHOLE_LANES(n); i++)
        weights[i] = weight_at(a, b, c, t0 + (float)i) * opacity;
}

/* Blend `alpha`: weights become shares of the pixel behind all splats so far. */
FOR_ALL_VECTORS static void shade_row(int n, float *restrict weights, float *restrict minus_opacity) {
    for (int i = 0; i < WHOLE_LANES(n); i++) {
        float w = gscl_lesser_positive(weights[i], GSCL_MAX_ALPHA);
        w = w * minus_opacity[i] + w;
        minus_opacity[i] -= w;
        weights[i] = w;
    }
}

FOR_ALL_VECTORS static void wave_row(const gscl_chord *chord, const gscl_ellipse *e, float t0, int n,
                                     const float *restrict weights, float *restrict waves) {
    for (int i = 0; i < WHOLE_LANES(n); i++)
        waves[i] = weights[i] * e->wave_amplitude * cos_turns(chord->turns + (t0 + (float)i) * e->wave_x);
}

FOR_ALL_VECTORS static void add_scaled(int n, const float *restrict from, float factor, float *restrict to) {
    for (int i = 0; i < WHOLE_LANES(n); i++)
        to[i] += factor * from[i];
}

/* Any blend, number of channels and splat. */
static void add_row(gscl_canvas *canvas, const gscl_ellipse *e, const gscl_chord *chord, float t0, int n, int at) {
    float weights[GSCL_MAX_STRIDE], waves[GSCL_MAX_STRIDE];
    weigh_row(chord, t0, e->opacity, n, weights);
    if (canvas->blend == GSCL_ALPHA)
        shade_row(n, weights, weights_of(canvas, canvas->run) + at);
    else if (canvas->blend == GSCL_NORMALIZED)
        add_scaled(n, weights, 1.0f, weights_of(canvas, canvas->run) + at);
    for (int k = 0; k < canvas->channels; k++)
        add_scaled(n, weights, e->colour[k], plane_of(canvas, canvas->run, k) + at);
    if (!(e->wave_amplitude > 0.0f))
        return;
    wave_row(chord, e, t0, n, weights, waves);
    for (int k = 0; k < canvas->colours; k++)
        add_scaled(n, waves, 1.0f, plane_of(canvas, canvas->run, k) + at);
}

static void draw_chord(gscl_canvas *c, const gscl_ellipse *e, const gscl_chord *chord, int row) {
    const int first = chord->first > c->x ? chord->first : c->x;
    const int end = chord->last < c->x + c->width ? chord->last + 1 : c->x + c->width;
    const int n = (end - first + GSCL_ROW_LANES - 1) & -GSCL_ROW_LANES, at = row * c->stride + first - c->x;
    const float t0 = (float)(first - chord->column);
    float *run = c->run + at;
    if (first >= end)
        return;
    c->is_dirty = true;
    if (c->blend == GSCL_NORMALIZED && c->channels == 3 && !(e->wave_amplitude > 0.0f))
        add_rgb(chord, t0, e->colour, e->opacity, n, run, run + c->plane, run + 2 * c->plane, run + 3 * c->plane);
    else
        add_row(c, e, chord, t0, n, at);
}

void gscl_canvas_draw(gscl_canvas *c, const gscl_ellipse *e) {
    const int first = e->box.first_row > c->y ? e->box.first_row - c->y : 0;
    const int last = e->box.last_row - c->y < c->height ? e->box.last_row - c->y : c->height - 1;
    gscl_chord chords[GSCL_BLOCK_ROWS];
    gscl_ellipse_chords(e, c->y + first, last - first + 1, c->image_width, chords);
    for (int row = first; row <= last; row++)
        draw_chord(c, e, &chords[row - first], row);
}

static void add_planes(gscl_canvas *c) {
    add_scaled((c->channels + 1) * c->plane, c->run, 1.0f, c->total);
}

/* Blend `alpha`: this run lies behind those before. */
static void add_behind(gscl_canvas *c) {
    const float *in_front = weights_of(c, c->total);
    for (int k = 0; k <= c->channels; k++) { /* the last plane changes itself */
        float *total = plane_of(c, c->total, k);
        const float *run = plane_of(c, c->run, k);
        for (int i = 0; i < WHOLE_LANES(c->plane); i++)
            total[i] += (1.0f + in_front[i]) * run[i];
    }
}

void gscl_canvas_end_run(gscl_canvas *c) {
    if (!c->is_dirty)
        return;
    if (c->blend == GSCL_ALPHA)
        add_behind(c);
    else
        add_planes(c);
    clear_run(c);
}

void gscl_canvas_finish(gscl_canvas *c, const float background[4]) {
    const float *weights = weights_of(c, c->total);
    for (int k = 0; k < c->channels; k++) {
        float *values = plane_of(c, c->total, k);
        if (c->blend == GSCL_NORMALIZED)
            for (int i = 0; i < WHOLE_LANES(c->plane); i++)
                values[i] /= weights[i];
        else if (c->blend == GSCL_ALPHA)
            for (int i = 0; i < WHOLE_LANES(c->plane); i++)
                values[i] += (1.0f + weights[i]) * background[k];
    }
}
