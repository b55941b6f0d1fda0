/* Bounds on the effect of rounding to single precision in the fit's kernels: a running error analysis of cl/raster.cl,
 * cl/fit.cl and cl/update.cl in double precision.  Each value has a bound on its error, to which each operation adds its
 * own rounding.  The bounds on OpenCL's functions are those of its specification, so that they hold on any device. */
#include <math.h>
#include <stdlib.h>

#include "fit_scene.h"

#define UNIT 0x1p-24           /* rounding of one operation, relative */
#define RECORD (26.0 * UNIT)   /* of an entry of the frame: cos 4 ulp, exp 3, sqrt 3, division 2.5, product 1/2 */
#define GAUSS (22.0 * UNIT)    /* of a Gaussian: polynomial 4e-7, and q, which is at most 10.1 */
#define LOGISTIC (14.0 * UNIT) /* of an opacity: exp 3 ulp, sum, division 2.5 ulp */
#define AXES (30.0 * UNIT)     /* of a ratio of axes */
#define DOUBLE_UNIT 0x1p-49    /* of a pixel in double precision: a few operations */
#define TILE 16
#define STEEPEST 0.715 /* slope of 2^-r^2 */

/* In the kernel's frame g = 2^-(u^2 + v^2). */
static const double ln2 = 0.69314718055994531, to_frame = 0.84932180028801905, factor = 1.3862943611198906,
                    cut2 = 10.098865286222744;

/* A splat at a pixel, with its errors. */
typedef struct {
    double u, v, du, dv;
    double g, most, dg; /* the Gaussian, its largest possible value, its error */
    double rounding;    /* of the Gaussian, relative, where u and v are exact */
    double w, dw;       /* the weight with its opacity */
    bool is_inside;     /* or may be, with rounding: the splat is drawn here */
    bool is_at_cut;     /* rounding decides whether it is drawn */
} sample;

/* Errors of a splat's frame coordinates, after `steps` additions from the first row to this one. */
static void frame_errors(const oracle_projected_splat *a, double x, double y, sample *s) {
    const double i1 = a->i1 * to_frame, i2 = a->i2 * to_frame;
    const double height = sqrt(14.0) * hypot(a->s / a->i1, a->c / a->i2);
    const double steps = fmin(TILE, 2.0 * height + 3.0);
    const double dx = fabs(x - a->x), dy = fabs(y - a->y), c = fabs(a->c), n = fabs(a->s);
    const double walked_u = (dx * c + (dy + steps) * n) * i1, walked_v = (dx * n + (dy + steps) * c) * i2;
    s->du = RECORD * (dx * c + dy * n) * i1 + (3.0 + steps) * UNIT * walked_u;
    s->dv = RECORD * (dx * n + dy * c) * i2 + (3.0 + steps) * UNIT * walked_v;
}

/* Rounding of the rows of a splat that is not rotated.  Row n is the first one times n ratios, each of which is the one
 * before times the square of 2^-step^2.  The error of an exp2 is 3 ulp and that of its argument: it enters once with the
 * first row, n times with the first ratio 2^(-2 v step) 2^-step^2, and n (n - 1) / 2 times with the square. */
static double stepped_rounding(const oracle_projected_splat *a) {
    const double step = a->i2 * to_frame, height = sqrt(14.0) / a->i2, n = fmin(TILE - 1, floor(2.0 * height) + 1.0);
    const double bend = ln2 * step * step * 2.0 * RECORD + 7.0 * UNIT;
    const double ratio = ln2 * 2.0 * sqrt(cut2) * step * (RECORD + 4.0 * UNIT) + 7.0 * UNIT + bend;
    return 20.0 * UNIT + n * (ratio + 2.0 * UNIT) + n * (n - 1.0) / 2.0 * (2.0 * bend + UNIT);
}

static sample sample_at(const oracle_fit *fit, const oracle_projected_splat *a, double x, double y) {
    sample s = {.rounding = GAUSS + (fit->stepped ? stepped_rounding(a) : 0.0)};
    oracle_frame(a, x, y, &s.u, &s.v);
    s.u *= to_frame;
    s.v *= to_frame;
    frame_errors(a, x, y, &s);
    const double r = hypot(s.u, s.v), dr = s.du + s.dv, cut = sqrt(cut2), near = fmax(r - dr, 0.0);
    s.is_inside = near < cut * (1.0 + 4.0 * UNIT);
    if (!s.is_inside)
        return s;
    s.is_at_cut = fabs(r - cut) <= dr + s.rounding;
    s.g = exp2(-r * r);
    s.most = exp2(-near * near);
    s.dg = fmin(factor * (r + dr) * s.most, STEEPEST) * dr + s.rounding * s.most;
    s.w = r < cut ? a->opacity * (s.g - exp2(-cut2)) : 0.0;
    s.dw = a->opacity * (s.dg + 2.0 * UNIT) + LOGISTIC * s.w;
    return s;
}

/* A value and a bound on its error. */
typedef struct {
    double value, error;
} term;

static double power(double x, int n) {
    return n == 2 ? x * x : n == 1 ? x : 1.0;
}

/* u^a v^b g.  At the cut the error is the whole value. */
static term moment(const sample *s, int a, int b) {
    const double u = fabs(s->u) + s->du, v = fabs(s->v) + s->dv, most = power(u, a) * power(v, b) * s->most;
    term t = {power(fabs(s->u), a) * power(fabs(s->v), b) * s->g, (18.0 * UNIT + s->rounding) * most};
    if (a > 0)
        t.error += a * s->du * power(u, a - 1) * power(v, b) * s->most;
    if (b > 0)
        t.error += b * s->dv * power(u, a) * power(v, b - 1) * s->most;
    t.error += factor * (u * s->du + v * s->dv) * most;
    if (s->is_at_cut || s->w <= 0.0) {
        t.error += most;
        t.value = s->w > 0.0 ? t.value : 0.0;
    }
    return t;
}

/* ---- A pixel ---- */

typedef struct {
    double value[ORACLE_CHANNELS], error[ORACLE_CHANNELS];
    double total, total_error;                                   /* of weights (normalized) */
    double slope[ORACLE_CHANNELS], slope_error[ORACLE_CHANNELS]; /* dL/dvalue */
    double mean, mean_error;                                     /* dot(value, slope); alpha: of the part behind */
    double parts[ORACLE_CHANNELS];                               /* magnitudes that add up to the value */
    double transmittance, transmittance_error;                   /* alpha */
} pixel_state;

/* Sums of weights and colours, their rounding and that of the quotient. */
static void draw_sums(const oracle_scene *s, const sample *samples, pixel_state *p) {
    const bool normalized = s->fit->blend == ORACLE_NORMALIZED;
    double weights = ORACLE_EPSILON, *partial = p->parts;
    p->total_error = 0.0;
    for (int k = 0; k < s->channels; k++) {
        partial[k] = fabs(s->fit->background[k]) * (normalized ? ORACLE_EPSILON : 1.0);
        p->error[k] = UNIT * partial[k];
    }
    for (size_t i = 0; i < s->count; i++) {
        if (!samples[i].is_inside)
            continue;
        const double *c = s->splats[i].colour;
        weights += samples[i].w;
        p->total_error += samples[i].dw + UNIT * weights;
        for (int k = 0; k < s->channels; k++) {
            partial[k] += samples[i].w * fabs(c[k]);
            p->error[k] += samples[i].dw * fabs(c[k] - (normalized ? p->value[k] : 0.0)) + UNIT * partial[k];
        }
    }
    p->total = weights;
    const double rounded = UNIT * (double)s->count;
    for (int k = 0; k < s->channels && normalized; k++) {
        partial[k] /= weights;
        p->error[k] =
            (p->error[k] + fabs(p->value[k]) * rounded * weights) / fmax(weights - p->total_error, ORACLE_EPSILON) +
            8.0 * UNIT * fabs(p->value[k]);
    }
}

/* One splat of the alpha blend, front to back: returns its share and updates the transmittance, of which the forward pass
 * stores the difference from 1 (raster.cl) and the backward pass the value (fit.cl). */
static term pass_through(pixel_state *p, const sample *s, bool forward) {
    const double a = fmin(s->w, ORACLE_OPAQUE), da = s->w - s->dw >= ORACLE_OPAQUE ? UNIT : s->dw;
    const term share = {a * p->transmittance, da * (p->transmittance + p->transmittance_error) +
                                                  a * p->transmittance_error + 2.0 * UNIT * a * p->transmittance};
    const double behind = p->transmittance * (1.0 - a);
    p->transmittance_error = (1.0 - a) * p->transmittance_error + da * (p->transmittance + p->transmittance_error) +
                             UNIT * (forward ? share.value + 1.0 - behind : 3.0 * p->transmittance);
    p->transmittance = behind;
    return share;
}

static void draw_alpha(const oracle_scene *s, const sample *samples, pixel_state *p) {
    double *partial = p->parts;
    p->transmittance = 1.0;
    p->transmittance_error = 0.0;
    for (int k = 0; k < s->channels; k++)
        p->error[k] = partial[k] = 0.0;
    for (size_t i = s->count; i-- > 0;) {
        if (!samples[i].is_inside)
            continue;
        const term share = pass_through(p, &samples[i], true);
        for (int k = 0; k < s->channels; k++) {
            const double c = fabs(s->splats[i].colour[k]);
            partial[k] += share.value * c;
            p->error[k] += share.error * c + UNIT * partial[k];
        }
    }
    /* Of 1 + the stored difference, and of the sum; without fma that of the product comes first. */
    const double roundings = s->fit->rounds_products ? 3.0 : 2.0;
    for (int k = 0; k < s->channels; k++)
        p->error[k] += p->transmittance_error * fabs(s->fit->background[k]) + roundings * UNIT * fabs(p->value[k]);
}

static void draw_with_errors(const oracle_scene *s, int pixel, const sample *samples, pixel_state *p) {
    oracle_scene_pixel(s, pixel, p->value);
    if (s->fit->blend == ORACLE_ALPHA)
        draw_alpha(s, samples, p);
    else
        draw_sums(s, samples, p);
}

static void begin_backward(const oracle_scene *s, int pixel, pixel_state *p) {
    const double scale = ldexp(1.0, 2 * s->fit->level);
    p->mean = p->mean_error = 0.0;
    for (int k = 0; k < s->channels; k++) {
        const double e = p->value[k] - s->fit->target[k * s->pixels + pixel];
        p->slope[k] = scale * e;
        p->slope_error[k] = scale * (p->error[k] + 2.0 * UNIT * fabs(e));
        p->mean += p->value[k] * p->slope[k];
        p->mean_error += (fabs(p->value[k]) + p->error[k]) * p->slope_error[k] + p->error[k] * fabs(p->slope[k]) +
                         4.0 * UNIT * fabs(p->value[k] * p->slope[k]);
    }
    p->transmittance = 1.0;
    p->transmittance_error = 0.0;
}

/* dL/dweight of a splat at a pixel; `share`: its part of the blend. */
static term slope_by_weight(const oracle_scene *s, size_t i, const sample *at, pixel_state *p, term *share) {
    term by_share = {0};
    for (int k = 0; k < s->channels; k++) {
        const double c = s->splats[i].colour[k];
        by_share.value += c * p->slope[k];
        by_share.error += fabs(c) * (p->slope_error[k] + 4.0 * UNIT * fabs(p->slope[k]));
    }
    if (s->fit->blend == ORACLE_SUM) {
        *share = (term){at->w, at->dw};
        return by_share;
    }
    if (s->fit->blend == ORACLE_NORMALIZED) {
        const double least = fmax(p->total - p->total_error, ORACLE_EPSILON), relative = p->total_error / least;
        const term h = {(by_share.value - p->mean) / p->total, 0.0};
        *share = (term){at->w / p->total, at->dw / least + at->w / p->total * (relative + 4.0 * UNIT)};
        return (term){h.value, (by_share.error + p->mean_error) / least + fabs(h.value) * (relative + 6.0 * UNIT)};
    }
    const double a = fmin(at->w, ORACLE_OPAQUE), through = 1.0 - a, transmittance = p->transmittance,
                 transmittance_error = p->transmittance_error;
    const double least = fmax(through - at->dw - UNIT, 1.0 - ORACLE_OPAQUE);
    *share = pass_through(p, at, false);
    p->mean -= share->value * by_share.value;
    p->mean_error += share->error * (fabs(by_share.value) + by_share.error) + share->value * by_share.error +
                     2.0 * UNIT * (fabs(p->mean) + fabs(share->value * by_share.value));
    term h = {transmittance * by_share.value - p->mean / through, 0.0};
    h.error = transmittance_error * (fabs(by_share.value) + by_share.error) + transmittance * by_share.error +
              p->mean_error / least + fabs(p->mean) * (at->dw + 4.0 * UNIT) / (through * least) +
              4.0 * UNIT * fabs(transmittance * by_share.value);
    if (fabs(at->w - ORACLE_OPAQUE) <= at->dw + UNIT)
        h.error += fabs(h.value);
    else if (at->w > ORACLE_OPAQUE)
        h = (term){0};
    return h;
}

/* ---- A splat ---- */

enum { SUM_U, SUM_V, SUM_UU, SUM_UV, SUM_VV, SUM_WEIGHT, SUM_COLOUR, SUMS = SUM_COLOUR + ORACLE_CHANNELS };

/* Sums over a splat's pixels: of magnitudes, and of errors. */
typedef struct {
    term sums[SUMS];
    double differenced; /* bound on the effect of oracle_fit_gradient's own rounding on the loss */
} splat_sums;

static void add(term *sum, term h, double scale, term t) {
    sum->value += fabs(h.value) * scale * t.value;
    sum->error += scale * (h.error * (t.value + t.error) + fabs(h.value) * (t.error + LOGISTIC * t.value));
}

static void add_pixel(const oracle_scene *s, size_t i, const sample *at, const pixel_state *p, term h, term share,
                      splat_sums *to) {
    static const int powers[5][2] = {{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    for (int k = 0; k < 5; k++)
        add(&to->sums[k], h, s->splats[i].opacity, moment(at, powers[k][0], powers[k][1]));
    const double plain = at->w > 0.0 ? at->g - exp2(-cut2) : 0.0;
    add(&to->sums[SUM_WEIGHT], h, 1.0, (term){plain, at->dg + 2.0 * UNIT});
    for (int k = 0; k < s->channels; k++)
        add(&to->sums[SUM_COLOUR + k], (term){p->slope[k], p->slope_error[k]}, 1.0, share);
    for (int k = 0; k < s->channels; k++)
        to->differenced += DOUBLE_UNIT * fabs(p->slope[k]) * (p->parts[k] + fabs(p->value[k]));
}

/* From sums to the parameters, with the rounding of sums of so many terms. */
static void finish(const oracle_scene *s, size_t i, const double *params, const splat_sums *from, double *gradient) {
    const oracle_projected_splat *a = &s->splats[i];
    const double tiles = ((s->fit->width + TILE - 1) / TILE) * ((s->fit->height + TILE - 1) / TILE);
    const double adding = (24.0 + tiles) * UNIT, ratio = a->i1 / a->i2, inv_scale = ldexp(1.0, -s->fit->level);
    double e[SUMS];
    for (int k = 0; k < SUMS; k++)
        e[k] = from->sums[k].error + (adding + RECORD + 4.0 * UNIT) * from->sums[k].value;
    const double i1 = factor * a->i1 * to_frame * inv_scale, i2 = factor * a->i2 * to_frame * inv_scale;
    gradient[0] = fabs(a->c) * i1 * e[SUM_U] + fabs(a->s) * i2 * e[SUM_V];
    gradient[1] = fabs(a->s) * i1 * e[SUM_U] + fabs(a->c) * i2 * e[SUM_V];
    gradient[2] = factor * e[SUM_UU]; /* times what the level's blur leaves, at most 1 */
    gradient[3] = factor * e[SUM_VV];
    gradient[4] =
        factor * (e[SUM_UV] * fabs(ratio - 1.0 / ratio) + AXES * (ratio + 1.0 / ratio) * from->sums[SUM_UV].value);
    const double o = a->opacity, left = 1.0 - o, change = LOGISTIC * o * left + 7.0 * UNIT * o;
    gradient[5] = s->fit->opacity ? e[SUM_WEIGHT] * o * (left + change) +
                                        from->sums[SUM_WEIGHT].value * (change * left + o * (change + UNIT))
                                  : 0.0;
    for (int k = 0; k < s->channels; k++)
        gradient[6 + k] = e[SUM_COLOUR + k];
    for (size_t k = 0; k < 6 + (size_t)s->channels; k++)
        gradient[k] += from->differenced / oracle_difference_step(s->fit, params, k);
}

void oracle_fit_bounds(const oracle_fit *fit, const double *params, size_t count, double *planes, double *gradient) {
    oracle_scene s = oracle_scene_new(fit, params, count);
    sample *samples = calloc(count + 1, sizeof *samples);
    splat_sums *sums = calloc(count + 1, sizeof *sums);
    if (!samples || !sums)
        abort();
    for (int pixel = 0; pixel < s.pixels; pixel++) {
        pixel_state p;
        for (size_t i = 0; i < count; i++)
            samples[i] = sample_at(fit, &s.splats[i], oracle_pixel_x(fit, pixel), oracle_pixel_y(fit, pixel));
        draw_with_errors(&s, pixel, samples, &p);
        begin_backward(&s, pixel, &p);
        for (size_t j = 0; j < count; j++) {
            const size_t i = fit->blend == ORACLE_ALPHA ? count - 1 - j : j;
            if (!samples[i].is_inside)
                continue;
            term share;
            const term h = slope_by_weight(&s, i, &samples[i], &p, &share);
            add_pixel(&s, i, &samples[i], &p, h, share, &sums[i]);
        }
        for (int k = 0; k < s.channels; k++)
            planes[k * s.pixels + pixel] = p.error[k];
    }
    for (size_t i = 0; i < count * ORACLE_PARAMS; i++)
        gradient[i] = 0.0;
    for (size_t i = 0; i < count; i++)
        finish(&s, i, params + i * ORACLE_PARAMS, &sums[i], gradient + i * ORACLE_PARAMS);
    free(samples);
    free(sums);
    oracle_scene_free(&s);
}
