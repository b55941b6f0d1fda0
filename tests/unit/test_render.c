/* The renderer: rendering directly to samples equals rendering to floats, also when the lists of splats overflow first;
 * and the directions of splats are those of their angles. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "both_mappings.h"
#include "cl/constants.h"
#include "decode/renderer.h"

#define WIDTH 1000 /* 63 tiles, the last one cut off */
#define HEIGHT 20
#define CHANNELS 3
#define SPLATS 100

static void check_call(gscl_context *context, gscl_result result) {
    if (result != GSCL_OK)
        fail_msg("%s", gscl_context_message(context));
}

/* Every splat covers every tile, which are far more entries than the initial lists hold. */
static void make_splats(float *params) {
    for (int i = 0; i < SPLATS; i++) {
        float *p = params + (size_t)i * GSCL_PARAMS, at = (float)i / SPLATS;
        p[GSCL_X] = WIDTH * at;
        p[GSCL_Y] = HEIGHT * (1.0f - at);
        p[GSCL_LOG_S1] = p[GSCL_LOG_S2] = logf(600.0f + (float)i);
        p[GSCL_THETA] = at;
        for (int k = 0; k < CHANNELS; k++)
            p[GSCL_COLOUR + k] = 0.5f + 0.5f * sinf((float)(3 * i + k));
    }
}

static gscl_renderer create_renderer(gscl_context *context) {
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = CHANNELS};
    const float background[4] = {0.1f, 0.5f, 0.9f};
    static float params[SPLATS * GSCL_PARAMS];
    gscl_renderer r;
    make_splats(params);
    check_call(context, gscl_renderer_create(&r, context, &options));
    check_call(context, gscl_renderer_set_view(&r, 0, 0, 0, WIDTH, HEIGHT));
    check_call(context, gscl_renderer_set_splats(&r, params, SPLATS, background));
    return r;
}

static void check_overflowing_lists(gscl_context *context) {
    static float planes[CHANNELS * WIDTH * HEIGHT];
    static uint8_t samples[WIDTH * HEIGHT * CHANNELS];
    const gscl_sample_layout rgb8 = {CHANNELS, GSCL_SAMPLE_U8, 0};
    gscl_renderer exact = create_renderer(context), direct = create_renderer(context);
    check_call(context, gscl_renderer_render(&exact));
    check_call(context, gscl_buffer_read(context, &exact.image, 0, planes, sizeof planes));
    check_call(context, gscl_renderer_samples(&direct, rgb8, samples, WIDTH * CHANNELS));
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        for (size_t k = 0; k < CHANNELS; k++)
            assert_int_equal(samples[i * CHANNELS + k], floorf(planes[k * WIDTH * HEIGHT + i] * 255.0f + 0.5f));
    assert_true(direct.row_capacity >= SPLATS * ((WIDTH + GSCL_TILE - 1) / GSCL_TILE));
    gscl_renderer_free(&exact);
    gscl_renderer_free(&direct);
}

static void test_overflowing_lists_are_drawn_again(void **unused) {
    (void)unused;
    for (int i = 0; i < mapping_count; i++)
        check_overflowing_lists(contexts[i]);
}

#define ANGLES 1000
#define SIDE 16 /* pixels */

/* Angles of all quarter turns, near them and between them; a fifth of them as large as cl/direction.cl accepts. */
static float angle_of(int i) {
    const float angle = (float)(i - ANGLES / 2) * 0.0314159f;
    return i % 5 ? angle : 6000.0f * angle;
}

static void check_directions(gscl_context *context) {
    static float params[ANGLES * GSCL_PARAMS], projected[ANGLES * GSCL_PROJECTED];
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = CHANNELS};
    const float background[4] = {0};
    gscl_renderer r;
    for (int i = 0; i < ANGLES; i++) { /* sigma is 1: exp(0) */
        params[i * GSCL_PARAMS + GSCL_X] = params[i * GSCL_PARAMS + GSCL_Y] = SIDE / 2;
        params[i * GSCL_PARAMS + GSCL_THETA] = angle_of(i);
    }
    check_call(context, gscl_renderer_create(&r, context, &options));
    check_call(context, gscl_renderer_set_view(&r, 0, 0, 0, SIDE, SIDE));
    check_call(context, gscl_renderer_set_splats(&r, params, ANGLES, background));
    check_call(context, gscl_renderer_render(&r));
    check_call(context, gscl_buffer_read(context, &r.projected, 0, projected, sizeof projected));
    const double length = sqrt(0.5 / log(2)); /* of a direction, in the units of the projection */
    for (int i = 0; i < ANGLES; i++) {
        const float *p = projected + i * GSCL_PROJECTED;
        assert_true(fabs(p[GSCL_PROJECTED_UX] / length - cos((double)angle_of(i))) < 2e-7);
        assert_true(fabs(p[GSCL_PROJECTED_UY] / length - sin((double)angle_of(i))) < 2e-7);
        assert_true(fabs(p[GSCL_PROJECTED_VX] / length + sin((double)angle_of(i))) < 2e-7);
    }
    gscl_renderer_free(&r);
}

static void test_directions_are_exact(void **unused) {
    (void)unused;
    for (int i = 0; i < mapping_count; i++)
        check_directions(contexts[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_overflowing_lists_are_drawn_again),
                                       cmocka_unit_test(test_directions_are_exact)};
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
