/* Needles far from their centres, in a view that begins at 16,000 px, where a frame coordinate is a difference of the
 * largest numbers. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "check.h"
#include "fit_oracle.h"
#include "decode/renderer.h"
#include "report.h"
#include "synthetic_scene.h"

#define ORIGIN 16000
#define SIDE 40
#define SAMPLES (SIDE * SIDE * SCENE_CHANNELS)
#define SPLATS 6

typedef struct {
    const char *name;
    double s1, s2;
    double
        nearest; /* minimum distance of centres from the view; the maximum is twice that, or the corner of the image */
} far_case;

static const far_case cases[] = {
    {"64 x 1/2 px, the longest of a fit", 64.0, 0.5, 40.0},
    {"32768 x 1/2 px, the longest of scalar coding", 32768.0, 0.5, 8000.0},
    {"65536 x 1/16 px, the longest of codebooks", 65536.0, 0.0625, 8000.0},
};

/* Diagonal, through the view: centres on a grid of 1/1024 pixel, so that the distance is exact. */
static void make_splats(const far_case *c, float params[SPLATS * GSCL_PARAMS]) {
    synthetic_random_state = 4;
    for (int i = 0; i < SPLATS * GSCL_PARAMS; i++)
        params[i] = 0.0f;
    for (int i = 0; i < SPLATS; i++) {
        float *p = params + i * GSCL_PARAMS;
        const float away = floorf(synthetic_uniform(c->nearest, fmin(2.0 * c->nearest, ORIGIN)));
        p[GSCL_X] = (float)ORIGIN + floorf(synthetic_uniform(0.0, SIDE)) - away + 0.5f;
        p[GSCL_Y] = (float)ORIGIN + floorf(synthetic_uniform(0.0, SIDE)) - away + 0.5f;
        scene_set_axes(p, c->s1, c->s2);
        p[GSCL_THETA] = (float)(atan2(1.0, 1.0) + synthetic_uniform(-1e-4, 1e-4));
        p[GSCL_OPACITY] = synthetic_uniform(-2.0, 4.0);
        for (int k = 0; k < SCENE_CHANNELS; k++)
            p[GSCL_COLOUR + k] = synthetic_uniform(0.0, 1.0);
    }
}

static const float background[4] = {0.3f, 0.5f, 0.7f, 0.0f};

static gscl_result draw_needles(gscl_context *context, int blend, const float *params, float *planes) {
    const gscl_kernel_options options = {.blend = blend, .colours = SCENE_CHANNELS, .opacity = 1};
    gscl_renderer r;
    GSCL_TRY(gscl_renderer_create(&r, context, &options));
    GSCL_TRY(gscl_renderer_set_view(&r, 0, ORIGIN, ORIGIN, SIDE, SIDE));
    GSCL_TRY(gscl_renderer_set_splats(&r, params, SPLATS, background));
    GSCL_TRY(gscl_renderer_render(&r));
    GSCL_TRY(gscl_buffer_read(context, &r.image, 0, planes, SAMPLES * sizeof *planes));
    gscl_renderer_free(&r);
    return GSCL_OK;
}

static void check_case(const far_case *c, int blend, int mapping) {
    static double expected[SAMPLES], bounds[SAMPLES], gradient_bounds[SPLATS * ORACLE_PARAMS], target[SAMPLES];
    float params[SPLATS * GSCL_PARAMS], planes[SAMPLES];
    double seen[SPLATS * ORACLE_PARAMS], worst = 0.0, largest = 0.0;
    oracle_fit fit = {.blend = (oracle_blend)blend,
                      .colours = SCENE_CHANNELS,
                      .opacity = true,
                      .width = SIDE,
                      .height = SIDE,
                      .background = {background[0], background[1], background[2]},
                      .target = target};
    make_splats(c, params);
    for (int i = 0; i < SPLATS * GSCL_PARAMS; i++)
        seen[i] = params[i] - (i % GSCL_PARAMS <= GSCL_Y ? ORIGIN : 0.0);
    oracle_fit_draw(&fit, seen, SPLATS, expected);
    oracle_fit_bounds(&fit, seen, SPLATS, bounds, gradient_bounds);
    assert_int_equal(draw_needles(stability_context(mapping), blend, params, planes), GSCL_OK);
    for (int i = 0; i < SAMPLES; i++) {
        const double error = fabs(planes[i] - expected[i]);
        worst = fmax(worst, 255.0 * error);
        largest = fmax(largest, 255.0 * bounds[i]);
        if (!(error <= bounds[i]))
            fail_msg("%s, %s, %s mapping: sample %d is %.9g, %.9g expected, at most %.3g apart", c->name,
                     stability_blends[blend], stability_mapping_name(mapping), i, planes[i], expected[i], bounds[i]);
    }
    char detail[40];
    snprintf(detail, sizeof detail, "%s, %s", stability_blends[blend], stability_mapping_name(mapping));
    report("far needles", c->name, detail, "sample, in 1/255", largest, worst);
}

static void test_far_needles(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int blend = 0; blend < 3; blend++)
            for (int mapping = 0; mapping < stability_mapping_count(); mapping++)
                check_case(&cases[i], blend, mapping);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_far_needles)};
    return cmocka_run_group_tests(tests, stability_open, stability_close);
}
