#include "fit_oracle.h"

#include <math.h>
#include <string.h>

#include "fit_scene.h"

/* Replaces one splat of a scene. */
typedef struct {
    size_t at;
    double weight, wave;
    const double *colour;
    bool clamped; /* where the alpha blend's opacity has no derivative */
} substitute;

static double luma_of(const oracle_fit *fit, const double *value) {
    return fit->colours == 3 ? 0.265 * value[0] + 0.657 * value[1] + 0.078 * value[2] : value[0];
}

static void blend_pixel(const oracle_scene *s, int pixel, const substitute *other, double *value) {
    const oracle_fit *fit = s->fit;
    const double *row = s->weights + (size_t)pixel * s->count;
    const double *waves = s->waves ? s->waves + (size_t)pixel * s->count : NULL;
    const bool alpha = fit->blend == ORACLE_ALPHA, normalized = fit->blend == ORACLE_NORMALIZED;
    double total = normalized ? ORACLE_EPSILON : 1.0;
    for (int k = 0; k < s->channels; k++)
        value[k] = total * fit->background[k];
    for (size_t i = 0; i < s->count; i++) {
        const bool changed = other && other->at == i;
        const double w = changed ? other->weight : row[i], wave = changed ? other->wave : waves ? waves[i] : 0.0;
        if (w == 0.0)
            continue;
        const double *colour = changed ? other->colour : s->splats[i].colour;
        const double covered = changed && other->clamped ? ORACLE_OPAQUE : changed ? w : fmin(w, ORACLE_OPAQUE);
        total += w;
        for (int k = 0; k < s->channels; k++) {
            const double c = colour[k] + (k < fit->colours ? wave : 0.0);
            value[k] = alpha ? value[k] * (1.0 - covered) + c * covered : value[k] + c * w;
        }
    }
    for (int k = 0; k < s->channels && normalized; k++)
        value[k] /= total;
}

void oracle_scene_pixel(const oracle_scene *s, int pixel, double *value) {
    blend_pixel(s, pixel, NULL, value);
}

void oracle_fit_draw(const oracle_fit *fit, const double *params, size_t count, double *planes) {
    oracle_scene s = oracle_scene_new(fit, params, count);
    for (int i = 0; i < s.pixels; i++) {
        double value[ORACLE_CHANNELS];
        oracle_scene_pixel(&s, i, value);
        for (int k = 0; k < s.channels; k++)
            planes[k * s.pixels + i] = value[k];
    }
    oracle_scene_free(&s);
}

double oracle_fit_loss(const oracle_fit *fit, const double *params, size_t count) {
    double loss = 0.0;
    oracle_scene s = oracle_scene_new(fit, params, count);
    for (int i = 0; i < s.pixels; i++) {
        double value[ORACLE_CHANNELS];
        oracle_scene_pixel(&s, i, value);
        for (int k = 0; k < s.channels; k++) {
            const double e = value[k] - fit->target[k * s.pixels + i];
            const double weight = fit->weights ? fit->weights[i] : 1.0;
            loss += fit->absolute ? fabs(e) : 0.5 * weight * e * e;
        }
        if (fit->luma_weights) {
            const double e = luma_of(fit, value) - fit->luma_target[i];
            loss += 0.5 * fit->luma_weights[i] * e * e;
        }
    }
    oracle_scene_free(&s);
    return ldexp(loss, 2 * fit->level);
}

/* ---- Differences ---- */

void oracle_shape_gradient(double *gradient, bool rotated, bool isotropic) {
    if (!rotated)
        gradient[4] = 0.0;
    if (isotropic)
        gradient[2] = gradient[3] = gradient[2] + gradient[3];
}

double oracle_natural_step(const oracle_fit *fit, const double *p, size_t parameter) {
    const oracle_projected_splat a = oracle_project(fit, p);
    const double scale = ldexp(1.0, fit->level), pi = 3.14159265358979323846;
    if (parameter == 0)
        return scale / (hypot(a.c * a.i1, a.s * a.i2) + 2.0 * pi * fabs(a.wave_x));
    if (parameter == 1)
        return scale / (hypot(a.s * a.i1, a.c * a.i2) + 2.0 * pi * fabs(a.wave_y));
    return parameter == 4 ? fmin(a.i1, a.i2) / fmax(a.i1, a.i2) : 1.0;
}

double oracle_difference_step(const oracle_fit *fit, const double *params, size_t parameter) {
    const double natural = oracle_natural_step(fit, params, parameter);
    return exp2(floor(log2(natural)) - (parameter < 6 ? 10.0 : 2.0));
}

/* The splat with other parameters, but on its present side of each kink (the cut, the clamp of alpha). */
static substitute substitute_at(const oracle_scene *s, size_t i, const oracle_projected_splat *a, int pixel) {
    const double x = oracle_pixel_x(s->fit, pixel), y = oracle_pixel_y(s->fit, pixel), pi = 3.14159265358979323846;
    double u, v;
    oracle_frame(a, x, y, &u, &v);
    return (substitute){
        .at = i,
        .weight = a->opacity * (exp(-0.5 * (u * u + v * v)) - exp(-ORACLE_CUT)),
        .wave = a->amplitude * cos(2.0 * pi * ((x - a->x) * a->wave_x + (y - a->y) * a->wave_y - a->phase)),
        .colour = a->colour,
        .clamped = s->weights[(size_t)pixel * s->count + i] >= ORACLE_OPAQUE,
    };
}

/* The loss of a pixel with one substitute, less the loss with the other. */
static double pixel_difference(const oracle_scene *s, int pixel, const substitute *more, const substitute *less) {
    const oracle_fit *fit = s->fit;
    double a[ORACLE_CHANNELS], b[ORACLE_CHANNELS], sum = 0.0;
    blend_pixel(s, pixel, more, a);
    blend_pixel(s, pixel, less, b);
    for (int k = 0; k < s->channels; k++) {
        const double target = fit->target[k * s->pixels + pixel], weight = fit->weights ? fit->weights[pixel] : 1.0;
        /* (a - t)^2 - (b - t)^2 without the cancellation */
        sum += fit->absolute ? fabs(a[k] - target) - fabs(b[k] - target)
                             : 0.5 * weight * (a[k] - b[k]) * (a[k] - target + b[k] - target);
    }
    if (fit->luma_weights) {
        const double more_luma = luma_of(fit, a), less_luma = luma_of(fit, b), target = fit->luma_target[pixel];
        sum += 0.5 * fit->luma_weights[pixel] * (more_luma - less_luma) * (more_luma - target + less_luma - target);
    }
    return sum;
}

/* The loss with the parameter moved up by `step`, less the loss with it moved down by as much. */
static double difference(const oracle_scene *s, size_t i, const double *params, size_t parameter, double step) {
    double up[ORACLE_PARAMS], down[ORACLE_PARAMS], sum = 0.0;
    memcpy(up, params, sizeof up);
    memcpy(down, params, sizeof down);
    up[parameter] += step;
    down[parameter] -= step;
    const oracle_projected_splat above = oracle_project(s->fit, up), below = oracle_project(s->fit, down);
    for (int p = 0; p < s->pixels; p++) {
        if (s->weights[(size_t)p * s->count + i] == 0.0)
            continue;
        const substitute more = substitute_at(s, i, &above, p), less = substitute_at(s, i, &below, p);
        sum += pixel_difference(s, p, &more, &less);
    }
    return ldexp(sum, 2 * s->fit->level);
}

void oracle_fit_gradient(const oracle_fit *fit, const double *params, size_t count, size_t stride, double *gradient) {
    const size_t used = 6 + (size_t)(fit->colours + fit->alpha_channel);
    oracle_scene s = oracle_scene_new(fit, params, count);
    for (size_t i = 0; i < count * ORACLE_PARAMS; i++)
        gradient[i] = 0.0;
    for (size_t i = (count + stride - 1) % stride; i < count; i += stride) {
        for (size_t k = 0; k < used; k++) {
            const double *p = params + i * ORACLE_PARAMS, step = oracle_difference_step(fit, p, k);
            if (k == 5 && !fit->opacity)
                continue;
            gradient[i * ORACLE_PARAMS + k] =
                (8.0 * difference(&s, i, p, k, step) - difference(&s, i, p, k, 2.0 * step)) / (12.0 * step);
        }
    }
    oracle_scene_free(&s);
}
