/* The renderer: drawing straight into samples is the same as drawing into floats, whatever the lists had room for. */
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

static void check(gscl_context *context, gscl_result result) {
    if (result != GSCL_OK)
        fail_msg("%s", gscl_context_message(context));
}

/* Every splat is seen in every tile: far more entries than the lists have room for to begin with. */
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

static gscl_renderer create(gscl_context *context) {
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = CHANNELS};
    const float background[4] = {0.1f, 0.5f, 0.9f};
    static float params[SPLATS * GSCL_PARAMS];
    gscl_renderer r;
    make_splats(params);
    check(context, gscl_renderer_create(&r, context, &options));
    check(context, gscl_renderer_set_view(&r, 0, 0, 0, WIDTH, HEIGHT));
    check(context, gscl_renderer_set_splats(&r, params, SPLATS, background));
    return r;
}

static void check_overflowing_lists(gscl_context *context) {
    static float planes[CHANNELS * WIDTH * HEIGHT];
    static uint8_t samples[WIDTH * HEIGHT * CHANNELS];
    const gscl_sample_layout rgb8 = {CHANNELS, GSCL_SAMPLE_U8, 0};
    gscl_renderer exact = create(context), straight = create(context);
    check(context, gscl_renderer_render(&exact));
    check(context, gscl_buffer_read(context, &exact.image, 0, planes, sizeof planes));
    check(context, gscl_renderer_samples(&straight, rgb8, samples, WIDTH * CHANNELS));
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        for (size_t k = 0; k < CHANNELS; k++)
            assert_int_equal(samples[i * CHANNELS + k], floorf(planes[k * WIDTH * HEIGHT + i] * 255.0f + 0.5f));
    assert_true(straight.row_capacity >= SPLATS * ((WIDTH + GSCL_TILE - 1) / GSCL_TILE));
    gscl_renderer_free(&exact);
    gscl_renderer_free(&straight);
}

static void test_overflowing_lists_are_drawn_again(void **unused) {
    (void)unused;
    for (int i = 0; i < 2; i++)
        check_overflowing_lists(contexts[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_overflowing_lists_are_drawn_again)};
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
