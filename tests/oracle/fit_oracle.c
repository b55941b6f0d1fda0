#include "fit_oracle.h"

#include <math.h>

#define STEP 1e-5

static const double pi = 3.14159265358979323846;

/* A splat as it appears at the level. */
typedef struct {
    double x, y, i1, i2, c, s, opacity;
    const double *colour;
    double wave_x, wave_y, phase, amplitude; /* cycles per pixel of the level, cycles */
} appearance;

static double seen_axis(double log_axis, int level) {
    const double scale = ldexp(1.0, level), blur = (scale * scale - 1.0) / 12.0;
    return sqrt(exp(2.0 * log_axis) + blur) / scale;
}

static appearance appear(const oracle_fit *fit, const double *p) {
    const double scale = ldexp(1.0, fit->level);
    const double filtered = exp(-2.0 * pi * pi * (p[10] * p[10] + p[11] * p[11]) * (scale * scale - 1.0) / 12.0);
    return (appearance){
        .x = p[0] / scale,
        .y = p[1] / scale,
        .i1 = 1.0 / seen_axis(p[2], fit->level),
        .i2 = 1.0 / seen_axis(p[3], fit->level),
        .c = cos(p[4]),
        .s = sin(p[4]),
        .opacity = fit->opacity ? 1.0 / (1.0 + exp(-p[5])) : 1.0,
        .colour = p + 6,
        .wave_x = p[10] * scale,
        .wave_y = p[11] * scale,
        .phase = p[12],
        .amplitude = fit->texture ? p[13] * filtered : 0.0,
    };
}

static double weight_at(const appearance *a, double x, double y) {
    const double dx = x - a->x, dy = y - a->y;
    const double u = (dx * a->c + dy * a->s) * a->i1, v = (dy * a->c - dx * a->s) * a->i2;
    const double q = 0.5 * (u * u + v * v);
    return q < 7.0 ? a->opacity * (exp(-q) - exp(-7.0)) : 0.0;
}

static double wave_at(const appearance *a, double x, double y) {
    return a->amplitude * cos(2.0 * pi * ((x - a->x) * a->wave_x + (y - a->y) * a->wave_y - a->phase));
}

typedef struct {
    size_t count;
    appearance splats[ORACLE_FIT_SPLATS];
} scene;

static void appear_all(const oracle_fit *fit, const double *params, size_t count, scene *s) {
    s->count = count < ORACLE_FIT_SPLATS ? count : ORACLE_FIT_SPLATS;
    for (size_t i = 0; i < s->count; i++)
        s->splats[i] = appear(fit, params + i * ORACLE_PARAMS);
}

static void draw_pixel(const oracle_fit *fit, const scene *s, int index, double *value) {
    const int channels = fit->colours + fit->alpha_channel;
    const double x = index % fit->width + 0.5, y = index / fit->width + 0.5;
    const double e = fit->blend == ORACLE_NORMALIZED ? 1.0 / 1024.0 : 1.0;
    double weights = e;
    for (int k = 0; k < channels; k++)
        value[k] = e * fit->background[k];
    for (size_t i = 0; i < s->count; i++) {
        const double w = weight_at(&s->splats[i], x, y), wave = wave_at(&s->splats[i], x, y),
                     covered = fit->blend == ORACLE_ALPHA ? fmin(w, 0.999) : 0.0;
        weights += w;
        for (int k = 0; k < channels && w > 0.0; k++) {
            const double colour = s->splats[i].colour[k] + (k < fit->colours ? wave : 0.0);
            value[k] = value[k] * (1.0 - covered) + colour * (fit->blend == ORACLE_ALPHA ? covered : w);
        }
    }
    for (int k = 0; k < channels && fit->blend == ORACLE_NORMALIZED; k++)
        value[k] /= weights;
}

void oracle_fit_draw(const oracle_fit *fit, const double *params, size_t count, double *planes) {
    const int pixels = fit->width * fit->height;
    scene s;
    appear_all(fit, params, count, &s);
    for (int i = 0; i < pixels; i++) {
        double value[ORACLE_CHANNELS];
        draw_pixel(fit, &s, i, value);
        for (int k = 0; k < fit->colours + fit->alpha_channel; k++)
            planes[k * pixels + i] = value[k];
    }
}

double oracle_fit_loss(const oracle_fit *fit, const double *params, size_t count) {
    const int pixels = fit->width * fit->height;
    double loss = 0.0;
    scene s;
    appear_all(fit, params, count, &s);
    for (int i = 0; i < pixels; i++) {
        double value[ORACLE_CHANNELS];
        draw_pixel(fit, &s, i, value);
        for (int k = 0; k < fit->colours + fit->alpha_channel; k++) {
            const double e = value[k] - fit->target[k * pixels + i];
            const double weight = fit->weights ? fit->weights[i] : 1.0;
            loss += fit->absolute ? fabs(e) : 0.5 * weight * e * e;
        }
    }
    return ldexp(loss, 2 * fit->level);
}

void oracle_fit_gradient(const oracle_fit *fit, double *params, size_t count, double *gradient) {
    const size_t used = 6 + (size_t)(fit->colours + fit->alpha_channel);
    for (size_t i = 0; i < count * ORACLE_PARAMS; i++) {
        const double at = params[i];
        gradient[i] = 0.0;
        if (i % ORACLE_PARAMS >= used || (i % ORACLE_PARAMS == 5 && !fit->opacity))
            continue;
        params[i] = at + STEP;
        const double above = oracle_fit_loss(fit, params, count);
        params[i] = at - STEP;
        const double below = oracle_fit_loss(fit, params, count);
        params[i] = at;
        gradient[i] = (above - below) / (2.0 * STEP);
    }
}
