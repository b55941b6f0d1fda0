/* The report of gscl_encode: times of the stages and the convergence trace. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "one_context.h"
#include "synthetic_image.h"

#define WIDTH 96
#define HEIGHT 80

typedef struct {
    uint8_t *bytes;
    size_t size;
    gscl_encode_report report;
} outcome;

static void encode_with_trace(gscl_profile profile, gscl_target target, double value, bool trace, outcome *o) {
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, WIDTH, HEIGHT, 3, GSCL_SAMPLE_U8);
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.profile = profile;
    settings.target = target;
    settings.target_value = value;
    settings.effort = 1;
    settings.trace = trace;
    memset(&o->report, 0x55, sizeof o->report);
    o->report.struct_size = sizeof o->report;
    assert_int_equal(gscl_encode(context, &image, &settings, &o->bytes, &o->size, &o->report), GSCL_OK);
    synthetic_image_free(&image);
}

/* The time to record the trace counts neither in the total nor in a stage. */
static void test_stages_add_up_to_the_encode(void **state) {
    (void)state;
    for (int trace = 0; trace < 2; trace++) {
        outcome o;
        encode_with_trace(GSCL_PROFILE_DEFAULT, GSCL_TARGET_BYTES, 500, trace, &o);
        double seconds = 0;
        for (uint32_t i = 0; i < o.report.stage_count; i++) {
            assert_true(o.report.stages[i].count > 0 && o.report.stages[i].seconds >= 0);
            seconds += o.report.stages[i].seconds;
        }
        assert_string_equal(o.report.stages[0].name, "prepare");
        assert_true(seconds <= o.report.seconds && seconds > 0.99 * o.report.seconds);
        assert_true((o.report.trace_count > 0) == (trace > 0));
        gscl_free(o.bytes);
    }
}

/* Points are in order, the PSNR rises, and the last is that of the file but for samples that are clamped and rounded. */
static void check_trace(const gscl_encode_report *r) {
    const gscl_trace_point *first = &r->trace[0], *last = &r->trace[r->trace_count - 1];
    assert_in_range(r->trace_count, 10, GSCL_MAX_TRACE_POINTS);
    for (const gscl_trace_point *point = first + 1; point <= last; point++) {
        assert_true(point->seconds >= point[-1].seconds && point->steps >= point[-1].steps);
        assert_true(point->psnr > 5 && point->psnr < 100 && point->splats > 0 && point->stage[0]);
    }
    assert_true(last->seconds <= r->seconds && last->psnr > first->psnr);
    assert_true(fabs(last->psnr - r->psnr) < 0.3);
}

static void test_trace(void **state) {
    (void)state;
    for (int profile = GSCL_PROFILE_DEFAULT; profile <= GSCL_PROFILE_PAPER; profile++) {
        outcome with, without;
        encode_with_trace((gscl_profile)profile, GSCL_TARGET_BYTES, 600, true, &with);
        encode_with_trace((gscl_profile)profile, GSCL_TARGET_BYTES, 600, false, &without);
        check_trace(&with.report);
        assert_int_equal(with.size, without.size);
        assert_memory_equal(with.bytes, without.bytes, with.size);
        gscl_free(with.bytes);
        gscl_free(without.bytes);
    }
}

/* A search for a PSNR fits several times, but where its first guess is right; the trace is that of the last fit. */
static void test_trace_of_the_last_fit(void **state) {
    (void)state;
    outcome o = {0};
    for (double psnr = 24; o.report.trials <= 1; psnr++) {
        gscl_free(o.bytes);
        encode_with_trace(GSCL_PROFILE_DEFAULT, GSCL_TARGET_PSNR, psnr, true, &o);
        assert_true(psnr < 28);
    }
    for (uint32_t i = 1; i < o.report.trace_count; i++)
        assert_true(o.report.trace[i].steps >= o.report.trace[i - 1].steps);
    gscl_free(o.bytes);
}

/* An encode that fails leaves no trace in the context. */
static void test_failure_leaves_no_trace(void **state) {
    (void)state;
    float pixels[4] = {0, 0, 0, NAN};
    const gscl_image image = {.width = 2, .height = 2, .channels = 1, .sample = GSCL_SAMPLE_F32, .pixels = pixels};
    uint8_t *bytes;
    size_t size;
    outcome o = {.report = {.struct_size = sizeof o.report}};
    assert_int_equal(gscl_encode(context, &image, NULL, &bytes, &size, &o.report), GSCL_ERROR_IMAGE_NOT_FINITE);
    assert_int_equal(o.report.stage_count, 0);
    encode_with_trace(GSCL_PROFILE_DEFAULT, GSCL_TARGET_BYTES, 500, false, &o);
    gscl_free(o.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stages_add_up_to_the_encode),
        cmocka_unit_test(test_trace),
        cmocka_unit_test(test_trace_of_the_last_fit),
        cmocka_unit_test(test_failure_leaves_no_trace),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
