/* Axes and angles at their extremes. */
#include <math.h>

#include "scene.h"
#include "synthetic_scene.h"

static const double pi = 3.14159265358979323846;

static void place_on_pixel(const scene *s, float *p) {
    p[GSCL_X] = (float)synthetic_random((uint32_t)s->width) + 0.5f;
    p[GSCL_Y] = (float)synthetic_random((uint32_t)s->height) + 0.5f;
}

/* Needles through the centres of pixels, along rows, columns and diagonals, and at any angle. */
static void needles(scene *s, double aspect) {
    for (size_t i = 0; i < scene_scaled(24, 8); i++) {
        float *p = scene_add(s);
        place_on_pixel(s, p);
        scene_set_axes(p, sqrt(aspect), 1.0 / sqrt(aspect));
        if (i % 4 < 3)
            p[GSCL_THETA] = (float)((double)synthetic_random(4) * pi / 4.0);
    }
}

static void needles_3(scene *s) {
    needles(s, 1e3);
}
static void needles_4(scene *s) {
    needles(s, 1e4);
}
static void needles_5(scene *s) {
    needles(s, 1e5);
}
static void needles_6(scene *s) {
    needles(s, 1e6);
}

/* Three of four have weight at a pixel's centre; the others are mostly between centres. */
static void sub_pixel(scene *s) {
    for (size_t i = 0; i < scene_scaled(40, 10); i++) {
        float *p = scene_add(s);
        place_on_pixel(s, p);
        scene_set_axes(p, scene_log_uniform(1e-3, 2e-3), 1e-3);
        p[GSCL_X] += synthetic_uniform(-2e-3, 2e-3);
        p[GSCL_Y] += synthetic_uniform(-2e-3, i % 4 ? 2e-3 : 0.4);
    }
}

static void large_axes(scene *s) {
    for (size_t i = 0; i < scene_scaled(16, 6); i++) {
        float *p = scene_add(s);
        scene_set_axes(p, 1e6, scene_log_uniform(1e4, 1e6));
        if (i % 2) {
            p[GSCL_X] = synthetic_uniform(-1e6, 1e6);
            p[GSCL_Y] = synthetic_uniform(-1e6, 1e6);
        }
    }
}

/* 0, pi/2 and pi as floats, the neighbouring floats, and angles slightly beside them. */
static void right_angles(scene *s) {
    const float beside[] = {0.0f, 1e-6f, -1e-6f, 1e-3f};
    for (int quarter = 0; quarter < 3; quarter++) {
        const float angle = (float)(quarter * pi / 2.0);
        for (int i = 0; i < 6; i++) {
            float *p = scene_add(s);
            scene_set_axes(p, scene_log_uniform(4.0, 20.0), scene_log_uniform(0.3, 2.0));
            p[GSCL_THETA] = i < 4 ? angle + beside[i] : nextafterf(angle, i == 4 ? 10.0f : -10.0f);
        }
    }
}

static void isotropic(scene *s) {
    s->isotropic = true;
    for (size_t i = 0; i < scene_scaled(20, 6); i++) {
        float *p = scene_add(s);
        p[GSCL_LOG_S2] = p[GSCL_LOG_S1];
    }
}

const scene_case shape_cases[] = {
    {"needles, aspect 10^3", needles_3},
    {"needles, aspect 10^4", needles_4},
    {"needles, aspect 10^5", needles_5},
    {"needles, aspect 10^6", needles_6},
    {"axes of 10^-3 px", sub_pixel},
    {"axes of 10^6 px", large_axes},
    {"angles 0, pi/2, pi", right_angles},
    {"isotropic", isotropic},
    {0},
};
