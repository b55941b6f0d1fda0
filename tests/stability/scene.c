#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "image/image.h"
#include "synthetic_scene.h"

size_t scene_scaled(size_t count, size_t few) {
    return getenv("STABILITY_SMALL") && few < count ? few : count;
}

int scene_level_width(const scene *s) {
    return (int)gscl_level_size((uint32_t)s->width, s->level);
}
int scene_level_height(const scene *s) {
    return (int)gscl_level_size((uint32_t)s->height, s->level);
}

void scene_resize(scene *s, int width, int height) {
    s->width = width;
    s->height = height;
    for (int i = 0; i < scene_level_width(s) * scene_level_height(s) * SCENE_CHANNELS; i++)
        s->target[i] = synthetic_uniform(0.0, 1.0);
}

void scene_begin(scene *s, const char *name, int blend) {
    snprintf(s->name, sizeof s->name, "%s", name);
    s->blend = blend;
    s->level = 0;
    s->isotropic = false;
    s->shape = GSCL_SHAPE_ROTATED;
    s->count = 0;
    s->stride = 1;
    synthetic_random_state = 12345;
    scene_resize(s, (int)scene_scaled(40, 18), (int)scene_scaled(33, 9));
}

void scene_set_shape(scene *s, int shape) {
    s->shape = shape;
    for (size_t i = 0; i < s->count && shape != GSCL_SHAPE_ROTATED; i++) {
        float *p = s->params + i * GSCL_PARAMS;
        p[GSCL_THETA] = 0.0f;
        if (shape == GSCL_SHAPE_ISOTROPIC)
            p[GSCL_LOG_S2] = p[GSCL_LOG_S1];
    }
}

double scene_log_uniform(double low, double high) {
    return exp(synthetic_uniform(log(low), log(high)));
}

void scene_set_axes(float *p, double s1, double s2) {
    p[GSCL_LOG_S1] = (float)log(s1);
    p[GSCL_LOG_S2] = (float)log(s2);
}

float *scene_add(scene *s) {
    float *p = s->params + s->count++ * GSCL_PARAMS;
    memset(p, 0, GSCL_PARAMS * sizeof *p);
    p[GSCL_X] = synthetic_uniform(0.0, s->width);
    p[GSCL_Y] = synthetic_uniform(0.0, s->height);
    scene_set_axes(p, scene_log_uniform(0.7, 15.0), scene_log_uniform(0.7, 15.0));
    p[GSCL_THETA] = synthetic_uniform(-4.0, 4.0);
    p[GSCL_OPACITY] = synthetic_uniform(-3.0, 3.0);
    for (int k = 0; k < SCENE_CHANNELS; k++)
        p[GSCL_COLOUR + k] = synthetic_uniform(-0.2, 1.2);
    return p;
}
