/* The visual loss and its derivative on the device, beside the loss in double precision and its differences. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <gscl/gscl.h>
#include "both_mappings.h"
#include "cl/constants.h"
#include "fit/tunables.h"
#include "fit/visual_loss.h"
#include "image/ssimulacra2.h"
#include "synthetic_scene.h"
#include "visual.h"

enum { WIDTH = 150, HEIGHT = 131, PLANE = WIDTH * HEIGHT };

typedef struct {
    int colours, channels, level, width, height; /* of the level */
    float target[4 * PLANE], rendering[4 * PLANE];
    double exact_target[4 * PLANE], exact_rendering[4 * PLANE];
    gscl_pyramid pyramid;
    gscl_buffer device_rendering;
} scene;

static void check_call(int mapping, gscl_result result) {
    if (result != GSCL_OK)
        fail_msg("%s", gscl_context_message(contexts[mapping]));
}

/* A target with smooth places, edges and noise, and a rendering that is a blurred and disturbed one. */
static scene *make_scene(int mapping, int colours, int alpha, int level) {
    scene *s = calloc(1, sizeof *s);
    *s = (scene){.colours = colours, .channels = colours + alpha, .level = level};
    synthetic_random_state = 7;
    static float full[4 * PLANE];
    for (int i = 0; i < s->channels * PLANE; i++) {
        const int x = i % WIDTH, y = i / WIDTH % HEIGHT, k = i / PLANE;
        float v = 0.5f + 0.3f * sinf(0.11f * (float)(x + 7 * k)) * cosf(0.07f * (float)y);
        v += (x / 20 + y / 30) % 2 ? 0.15f : 0.0f;
        full[i] = fminf(fmaxf(v + (x > WIDTH / 2 ? synthetic_uniform(-0.2, 0.2) : 0.0f), 0.0f), 1.0f);
    }
    check_call(mapping, gscl_pyramid_create(&s->pyramid, contexts[mapping], WIDTH << level, HEIGHT << level, level,
                                            s->channels, false, full));
    assert_int_equal(s->pyramid.first_level, level);
    s->width = (int)gscl_pyramid_width(&s->pyramid, level);
    s->height = (int)gscl_pyramid_height(&s->pyramid, level);
    memcpy(s->target, full, sizeof full);
    for (int i = 0; i < s->channels * PLANE; i++) {
        const int left = i % WIDTH ? i - 1 : i;
        s->rendering[i] = 0.5f * (s->target[i] + s->target[left]) + synthetic_uniform(-0.06, 0.06);
        s->exact_target[i] = s->target[i];
        s->exact_rendering[i] = s->rendering[i];
    }
    check_call(mapping, gscl_buffer_reserve_image(contexts[mapping], &s->device_rendering, sizeof s->rendering));
    check_call(mapping, gscl_buffer_write(contexts[mapping], &s->device_rendering, 0, s->rendering,
                                          (size_t)(s->channels * PLANE) * sizeof(float)));
    return s;
}

static void free_scene(scene *s) {
    gscl_pyramid_free(&s->pyramid);
    gscl_buffer_free(&s->device_rendering);
    free(s);
}

/* The part of the derivative by one sample that comes from the visual loss. */
static double expected_derivative(scene *s, int sample) {
    const double step = 1e-5, value = s->exact_rendering[sample];
    double sums[2];
    for (int side = 0; side < 2; side++) {
        s->exact_rendering[sample] = value + (side ? step : -step);
        sums[side] = oracle_visual_sum(s->exact_target, s->exact_rendering, s->colours, WIDTH, HEIGHT, s->level,
                                       GSCL_VISUAL_FIRST_SCALE, gscl_fit_tunables.visual_peaks);
    }
    s->exact_rendering[sample] = value;
    return (sums[1] - sums[0]) / (2 * step) * PLANE / 2000.0;
}

static void check_scene(int mapping, int colours, int alpha, int level) {
    scene *s = make_scene(mapping, colours, alpha, level);
    const gscl_kernel_options options = {.colours = colours, .alpha_channel = alpha};
    const gscl_visual_comparison comparison = {
        .pyramid = &s->pyramid, .options = &options, .level = level, .rendering = &s->device_rendering, .share = 1.0f};
    static float found[4 * PLANE];
    gscl_visual visual = {0};
    gscl_buffer derivative = {0};
    double loss, error2 = 0, size2 = 0;
    check_call(mapping, gscl_visual_derivative(&visual, &comparison, &derivative));
    check_call(mapping, gscl_visual_read_loss(&visual, contexts[mapping], &loss));
    const double sum = oracle_visual_sum(s->exact_target, s->exact_rendering, colours, WIDTH, HEIGHT, level,
                                         GSCL_VISUAL_FIRST_SCALE, gscl_fit_tunables.visual_peaks);
    assert_float_equal(loss, sum * PLANE / 2000.0, 2e-5 * loss);
    check_call(mapping, gscl_buffer_read(contexts[mapping], &derivative, 0, found,
                                         (size_t)(s->channels * PLANE) * sizeof(float)));
    for (int i = 0; i < 60; i++) {
        const int sample = i < 4 ? (int[]){0, WIDTH - 1, PLANE - WIDTH, PLANE - 1}[i]
                                 : (int)synthetic_uniform(0, (float)(colours * PLANE - 1));
        const double expected = expected_derivative(s, sample);
        const double device = (double)found[sample] - ((double)s->rendering[sample] - s->target[sample]);
        error2 += (device - expected) * (device - expected);
        size2 += expected * expected;
    }
    if (!(sqrt(error2) <= 1e-3 * sqrt(size2)))
        fail_msg("%d colours, level %d: error %.3g of the derivative's size %.3g", colours, level, sqrt(error2),
                 sqrt(size2));
    for (int i = colours * PLANE; i < s->channels * PLANE; i++)
        assert_float_equal(found[i], s->rendering[i] - s->target[i], 1e-6);
    gscl_visual_free(&visual);
    gscl_buffer_free(&derivative);
    free_scene(s);
}

static void test_derivative(void **state) {
    (void)state;
    for (int m = 0; m < mapping_count; m++) {
        check_scene(m, 3, 0, 0);
        check_scene(m, 1, 0, 0);
        check_scene(m, 3, 1, 1);
    }
}

/* The reference of these tests, with the finest scale, is SSIMULACRA 2 but for weights below 0.01, where images are grey. */
static void test_reference(void **state) {
    (void)state;
    scene *s = make_scene(0, 1, 0, 0);
    double sum;
    assert_true(gscl_ssimulacra2_sum(s->target, s->rendering, WIDTH, HEIGHT, 1, &sum) == GSCL_OK);
    assert_float_equal(oracle_visual_sum(s->exact_target, s->exact_rendering, 1, WIDTH, HEIGHT, 0, 0, 0), sum,
                       2e-3 * sum);
    free_scene(s);
}

/* At a level beyond the last scale the loss is squared error alone. */
static void test_small_levels(void **state) {
    (void)state;
    static float found[3 * PLANE];
    for (int level = GSCL_VISUAL_SCALES - 1; level < GSCL_VISUAL_SCALES + 3; level++) {
        scene *s = make_scene(0, 3, 0, level);
        const gscl_kernel_options options = {.colours = 3};
        const gscl_visual_comparison comparison = {.pyramid = &s->pyramid,
                                                   .options = &options,
                                                   .level = level,
                                                   .rendering = &s->device_rendering,
                                                   .share = 1.0f};
        gscl_visual *visual = calloc(1, sizeof *visual); /* of its own, so that sanitizers see what is beyond it */
        gscl_buffer derivative = {0};
        double loss;
        assert_non_null(visual);
        check_call(0, gscl_visual_derivative(visual, &comparison, &derivative));
        check_call(0, gscl_visual_read_loss(visual, contexts[0], &loss));
        check_call(0, gscl_buffer_read(contexts[0], &derivative, 0, found, sizeof found));
        assert_true((loss > 0) == (level < GSCL_VISUAL_SCALES));
        for (int i = 0; i < 3 * PLANE && level >= GSCL_VISUAL_SCALES; i++)
            assert_float_equal(found[i], s->rendering[i] - s->target[i], 1e-6);
        gscl_visual_free(visual);
        free(visual);
        gscl_buffer_free(&derivative);
        free_scene(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_reference), cmocka_unit_test(test_derivative),
                                       cmocka_unit_test(test_small_levels)};
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
