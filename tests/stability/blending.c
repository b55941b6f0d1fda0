/* Opacities, stacks and sums at their extremes. */
#include <math.h>

#include "scene.h"
#include "synthetic_scene.h"

static void add_splats_of_opacity(scene *s, float logit) {
    for (size_t i = 0; i < scene_scaled(16, 6); i++)
        scene_add(s)[GSCL_OPACITY] = logit;
}

/* exp(-x) overflows, so that the opacity is exactly 0 (or exp(-x) is 0, and the opacity 1). */
static void opacity_0(scene *s) {
    add_splats_of_opacity(s, -INFINITY);
}
static void opacity_1e8(scene *s) {
    add_splats_of_opacity(s, (float)log(1e-8 / (1.0 - 1e-8)));
}
static void opacity_almost_1(scene *s) {
    add_splats_of_opacity(s, (float)log((1.0 - 1e-7) / 1e-7));
}
static void opacity_1(scene *s) {
    add_splats_of_opacity(s, INFINITY);
}

static void add_stack(scene *s, size_t count) {
    scene_resize(s, 5, 3);
    s->stride = 1 + count / 30;
    for (size_t i = 0; i < count; i++) {
        float *p = scene_add(s);
        p[GSCL_X] = 2.5f;
        p[GSCL_Y] = 1.5f;
        scene_set_axes(p, scene_log_uniform(0.3, 2.0), scene_log_uniform(0.3, 2.0));
    }
}

static void stack_of_1000(scene *s) {
    add_stack(s, scene_scaled(1000, 20));
}
static void stack_of_10000(scene *s) {
    add_stack(s, scene_scaled(10000, 30));
}
/* Low opacities: the rear splats stay visible. */
static void stack_of_low_opacity(scene *s) {
    add_stack(s, scene_scaled(1000, 20));
    for (size_t i = 0; i < s->count; i++)
        s->params[i * GSCL_PARAMS + GSCL_OPACITY] = synthetic_uniform(-9.0, -6.0);
}

/* Each splat has a transmittance of 1/1000 to 1/20, so that the product of 15 to 35 of them is below the smallest float. */
static void underflow(scene *s) {
    add_stack(s, scene_scaled(200, 25));
    s->stride = 1; /* the transmittance at the second splat is 1/1000, the minimum after the clamp of the first */
    for (size_t i = 0; i < s->count; i++) {
        float *p = s->params + i * GSCL_PARAMS;
        scene_set_axes(p, scene_log_uniform(4.0, 1e3), scene_log_uniform(4.0, 1e3));
        p[GSCL_OPACITY] = synthetic_uniform(3.0, 20.0);
    }
}

/* A few small splats in a corner: most of the image is background. */
static void unreached(scene *s) {
    for (size_t i = 0; i < 6; i++) {
        float *p = scene_add(s);
        p[GSCL_X] = synthetic_uniform(0.0, 10.0);
        p[GSCL_Y] = synthetic_uniform(0.0, 10.0);
        scene_set_axes(p, 1.0, 0.5);
    }
}

static void cancelling(scene *s) {
    for (size_t i = 0; i < scene_scaled(12, 6); i++) {
        float *p = scene_add(s), *q = scene_add(s);
        for (int k = 0; k < GSCL_PARAMS; k++)
            q[k] = p[k];
        for (int k = 0; k < SCENE_CHANNELS; k++) {
            p[GSCL_COLOUR + k] += 1e4f;
            q[GSCL_COLOUR + k] = -1e4f;
        }
    }
}

const scene_case blending_cases[] = {
    {"opacity 0", opacity_0},
    {"opacity 10^-8", opacity_1e8},
    {"opacity 1 - 10^-7", opacity_almost_1},
    {"opacity 1", opacity_1},
    {"1,000 splats on a pixel", stack_of_1000},
    {"10,000 splats on a pixel", stack_of_10000},
    {"1,000 thin splats on a pixel", stack_of_low_opacity},
    {"transmittance that underflows", underflow},
    {"pixels that no splat reaches", unreached},
    {"colours that cancel at 10^4", cancelling},
    {0},
};
