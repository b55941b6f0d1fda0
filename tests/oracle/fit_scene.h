/* Shared by the parts of the fit's oracle: the splats as they appear at the level, and the weight of each at each pixel. */
#ifndef GSCL_FIT_SCENE_H
#define GSCL_FIT_SCENE_H

#include "fit_oracle.h"

#define ORACLE_CUT 7.0         /* a splat ends where q reaches this */
#define ORACLE_OPAQUE 0.999    /* the alpha blend's largest opacity at a pixel */
#define ORACLE_EPSILON 0x1p-10 /* the background's weight in the normalized blend */

/* A splat as it appears at the level. */
typedef struct {
    double x, y, i1, i2, c, s, opacity;
    const double *colour;
    double wave_x, wave_y, phase, amplitude; /* cycles per pixel of the level, cycles */
} oracle_projected_splat;

typedef struct {
    const oracle_fit *fit;
    size_t count;
    int pixels, channels;
    oracle_projected_splat *splats;
    double *weights; /* of each splat: `pixels` rows of `count` */
    double *waves;   /* likewise; NULL without textures */
} oracle_scene;

oracle_projected_splat oracle_project(const oracle_fit *fit, const double *params);
/* The step of differences: about a thousandth of the parameter's natural step (of colours a quarter), as a power of two,
 * so that it is exact for parameters that are floats. */
double oracle_difference_step(const oracle_fit *fit, const double *params, size_t parameter);
/* (u, v) of a pixel in the splat's frame, in axes: q = (u^2 + v^2) / 2. */
void oracle_frame(const oracle_projected_splat *splat, double x, double y, double *u, double *v);
static inline double oracle_pixel_x(const oracle_fit *fit, int pixel) {
    return pixel % fit->width + 0.5;
}
static inline double oracle_pixel_y(const oracle_fit *fit, int pixel) {
    return pixel / fit->width + 0.5;
}

/* The scene refers to `fit` and `params`. */
oracle_scene oracle_scene_new(const oracle_fit *fit, const double *params, size_t count);
void oracle_scene_free(oracle_scene *scene);
/* All channels of a pixel. */
void oracle_scene_pixel(const oracle_scene *scene, int pixel, double *value);

#endif
