/* Centres at and beyond borders, and at coordinates where the spacing of floats is large. */
#include <math.h>

#include "scene.h"
#include "synthetic_scene.h"

/* Some splats reach into the image, others are too far away. */
static void outside(scene *s) {
    static const double beyond[] = {0.5, 3.0, 20.0, 1e3, 1e5};
    for (int i = 0; i < 20; i++) {
        float *p = scene_add(s);
        const float by = (float)beyond[i % 5];
        p[i / 5 % 2 ? GSCL_X : GSCL_Y] = i / 10 ? -by : by + (float)(i / 5 % 2 ? s->width : s->height);
    }
}

static void corners(scene *s) {
    for (int i = 0; i < 9; i++) {
        float *p = scene_add(s);
        p[GSCL_X] = 0.5f * (float)(i % 3 * s->width);
        p[GSCL_Y] = 0.5f * (float)(i / 3 * s->height);
    }
}

/* Centres on the borders of tiles in x and in y, and on the next float on either side. */
static void tile_borders(scene *s) {
    scene_resize(s, 35, (int)scene_scaled(33, 18));
    for (int i = 0; i < 18; i++) {
        float *p = scene_add(s);
        const float x = 16.0f * (float)(1 + i / 9), towards[] = {0.0f, x, 100.0f};
        p[GSCL_X] = nextafterf(x, towards[i % 3]);
        p[GSCL_Y] = nextafterf(x, towards[i / 3 % 3]);
        scene_set_axes(p, scene_log_uniform(0.3, 6.0), scene_log_uniform(0.3, 6.0));
    }
}

/* Outlines that end on the border of a tile, or on the next float on either side. */
static void touching_outlines(scene *s) {
    scene_resize(s, 35, (int)scene_scaled(33, 18));
    for (int i = 0; i < 12; i++) {
        float *p = scene_add(s);
        const double reach = i % 2 ? 8.0 : 8.5; /* of the tile, or of its last pixel's centre */
        scene_set_axes(p, reach / sqrt(14.0), reach / sqrt(14.0) * (i < 6 ? 1.0 : 0.3));
        p[GSCL_LOG_S1] = nextafterf(p[GSCL_LOG_S1], i % 3 ? i % 3 == 1 ? 10.0f : -10.0f : p[GSCL_LOG_S1]);
        p[GSCL_X] = p[GSCL_Y] = 8.0f;
        p[GSCL_THETA] = i < 6 ? p[GSCL_THETA] : 0.0f;
    }
}

static void place_far(scene *s, int along, int across, int length) {
    for (int i = 0; i < 16; i++) {
        float *p = scene_add(s);
        p[along] = synthetic_uniform(length - (length > 400 ? 400.0 : 60.0), length);
        p[across] = synthetic_uniform(0.0, 3.0);
        scene_set_axes(p, scene_log_uniform(0.5, i % 4 ? 5.0 : 1e3), scene_log_uniform(0.5, 2.0));
        p[GSCL_THETA] = i % 4 ? p[GSCL_THETA] : along == GSCL_X ? 0.0f : 1.57079633f;
    }
}
static void far_right(scene *s) {
    const int width = (int)scene_scaled(16384, 100);
    scene_resize(s, width, 3);
    place_far(s, GSCL_X, GSCL_Y, width);
}
static void far_down(scene *s) {
    const int height = (int)scene_scaled(16384, 100);
    scene_resize(s, 3, height);
    place_far(s, GSCL_Y, GSCL_X, height);
}

const scene_case place_cases[] = {
    {"centres outside the image", outside},
    {"centres on corners and edges", corners},
    {"centres on tile borders, +-1 ulp", tile_borders},
    {"outlines on tile borders, +-1 ulp", touching_outlines},
    {"x at 16,000 px", far_right},
    {"y at 16,000 px", far_down},
    {0},
};
