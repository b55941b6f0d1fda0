#include "fit_scene.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

static double axis_at_level(double log_axis, int level) {
    const double scale = ldexp(1.0, level), blur = (scale * scale - 1.0) / 12.0;
    return sqrt(exp(2.0 * log_axis) + blur) / scale;
}

oracle_projected_splat oracle_project(const oracle_fit *fit, const double *p) {
    const double scale = ldexp(1.0, fit->level);
    const double filtered = exp(-2.0 * pi * pi * (p[10] * p[10] + p[11] * p[11]) * (scale * scale - 1.0) / 12.0);
    return (oracle_projected_splat){
        .x = p[0] / scale,
        .y = p[1] / scale,
        .i1 = 1.0 / axis_at_level(p[2], fit->level),
        .i2 = 1.0 / axis_at_level(p[3], fit->level),
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

void oracle_frame(const oracle_projected_splat *a, double x, double y, double *u, double *v) {
    const double dx = x - a->x, dy = y - a->y;
    *u = (dx * a->c + dy * a->s) * a->i1;
    *v = (dy * a->c - dx * a->s) * a->i2;
}

static double weight_at(const oracle_projected_splat *a, double x, double y) {
    double u, v;
    oracle_frame(a, x, y, &u, &v);
    const double q = 0.5 * (u * u + v * v);
    return q < ORACLE_CUT ? a->opacity * (exp(-q) - exp(-ORACLE_CUT)) : 0.0;
}

static double wave_at(const oracle_projected_splat *a, double x, double y) {
    return a->amplitude * cos(2.0 * pi * ((x - a->x) * a->wave_x + (y - a->y) * a->wave_y - a->phase));
}

oracle_scene oracle_scene_new(const oracle_fit *fit, const double *params, size_t count) {
    oracle_scene s = {
        .fit = fit, .count = count, .pixels = fit->width * fit->height, .channels = fit->colours + fit->alpha_channel};
    s.splats = calloc(count + 1, sizeof *s.splats);
    s.weights = calloc((size_t)s.pixels * count + 1, sizeof *s.weights);
    s.waves = fit->texture ? calloc((size_t)s.pixels * count + 1, sizeof *s.waves) : NULL;
    if (!s.splats || !s.weights || (fit->texture && !s.waves))
        abort();
    for (size_t i = 0; i < count; i++) {
        s.splats[i] = oracle_project(fit, params + i * ORACLE_PARAMS);
        for (int p = 0; p < s.pixels; p++) {
            const double x = oracle_pixel_x(fit, p), y = oracle_pixel_y(fit, p);
            s.weights[(size_t)p * count + i] = weight_at(&s.splats[i], x, y);
            if (s.waves)
                s.waves[(size_t)p * count + i] = wave_at(&s.splats[i], x, y);
        }
    }
    return s;
}

void oracle_scene_free(oracle_scene *s) {
    free(s->splats);
    free(s->weights);
    free(s->waves);
}
