/* The search for a quality, on given curves of quality against size. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "encode/quality_search.h"
#include "encode/tunables.h"

#define PIXELS 393216.0 /* 768x512 */

static const gscl_quality_tunables *const psnr = &gscl_encode_tunables.psnr;
static const gscl_quality_tunables *const ssimulacra2 = &gscl_encode_tunables.ssimulacra2;

/* Quality of a file: on the scale of the measure `slope` more for each doubling, in steps of quality where `step` is not 0,
 * and with a ripple of this height. */
typedef struct {
    const gscl_quality_tunables *measure;
    double at_1000, slope, step, ripple;
} curve;

static double scale_of(const curve *c, double quality) {
    return c->measure->perfect > 0 ? -log2(c->measure->perfect - quality) : quality;
}

static double quality_at(const curve *c, double scale) {
    return c->measure->perfect > 0 ? c->measure->perfect - exp2(-scale) : scale;
}

static double quality_of(const curve *c, double bytes) {
    const double smooth = quality_at(c, scale_of(c, c->at_1000) + c->slope * log2(bytes / 1000));
    const double quality = smooth + c->ripple * sin(bytes);
    return c->step > 0 ? c->step * floor(quality / c->step) : quality;
}

/* Quality of a probe: lower, as it is in the mean. */
static double probe_quality(const curve *c, double bytes) {
    const gscl_quality_tunables *t = c->measure;
    const double whole = scale_of(c, quality_of(c, bytes));
    return quality_at(c, (whole - t->probe_offset - t->probe_octave * log2(8 * bytes / PIXELS)) / t->probe_gain);
}

typedef struct {
    gscl_quality_search search;
    double best_bytes, best_quality; /* of the last trial that reached the target */
} outcome;

static void add_file(outcome *o, const curve *c) {
    const double bytes = o->search.bytes, quality = quality_of(c, bytes);
    assert_true(bytes >= 1 && bytes <= o->search.max_bytes && bytes == floor(bytes));
    if (o->search.is_probe) {
        assert_int_equal(o->search.trials, 0);
        assert_false(gscl_quality_search_add(&o->search, probe_quality(c, bytes), bytes));
    } else if (gscl_quality_search_add(&o->search, quality, bytes)) {
        assert_true(quality >= o->search.target);
        assert_true(o->best_bytes == 0 || bytes < o->best_bytes);
        o->best_bytes = bytes;
        o->best_quality = quality;
    }
}

static outcome run_search(const curve *c, double target, bool has_probes) {
    outcome o = {.search = gscl_quality_search_begin(c->measure, target, PIXELS, has_probes)};
    while (!o.search.done)
        add_file(&o, c);
    assert_in_range(o.search.trials, 1, gscl_encode_tunables.max_trials);
    assert_in_range(o.search.probes, has_probes, has_probes ? c->measure->max_small_probes : 0);
    return o;
}

static bool is_narrow(const gscl_quality_search *s) {
    return s->high.bytes - s->low.bytes <= gscl_encode_tunables.narrow_share * s->high.bytes;
}

/* The target is met within its tolerance or, on a steep curve, within the sizes that are not told apart. */
static void check_met(const curve *c, double target, bool has_probes) {
    const outcome o = run_search(c, target, has_probes);
    if (!(o.best_quality >= target && (o.best_quality <= target + c->measure->tolerance || is_narrow(&o.search) ||
                                       (c->measure->patience > 0 && o.search.trials > 3))))
        fail_msg("slope %g: %g reached for %g", c->slope, o.best_quality, target);
}

/* With probes and without, unless the largest file is too poor. */
static void check_curve(const curve *c, double target) {
    const gscl_quality_search s = gscl_quality_search_begin(c->measure, target, PIXELS, false);
    if (quality_of(c, s.max_bytes) < target)
        return;
    check_met(c, target, false);
    check_met(c, target, true);
}

static void test_smooth_curves_of_psnr_are_met(void **state) {
    (void)state;
    for (double db = 0.8; db < 6; db += 0.4)
        for (double target = 20; target <= 34; target += 1.7)
            check_curve(&(curve){.measure = psnr, .at_1000 = 22, .slope = db}, target);
}

static void test_smooth_curves_of_ssimulacra2_are_met(void **state) {
    (void)state;
    for (double slope = 0.2; slope < 1; slope += 0.1)
        for (double target = -100; target <= 90; target += 9.5)
            check_curve(&(curve){.measure = ssimulacra2, .at_1000 = -30, .slope = slope}, target);
}

/* Probes that predict exactly leave one trial, where the size is within their reach. */
static void test_probes_save_trials(void **state) {
    (void)state;
    for (double target = -60; target <= 80; target += 10) {
        const curve c = {.measure = ssimulacra2, .at_1000 = -30, .slope = 0.5};
        assert_int_equal(run_search(&c, target, true).search.trials, 1);
    }
}

/* A curve with steps of 2 dB has no size in the target band: the search returns the smallest size that reaches the target. */
static void test_steps_end_the_search(void **state) {
    (void)state;
    const curve c = {.measure = psnr, .at_1000 = 22, .slope = 2.5, .step = 2};
    const outcome o = run_search(&c, 25, false);
    assert_true(o.best_quality == 26);
    assert_true(is_narrow(&o.search)); /* of dB, however many trials it takes */
}

/* Files of nearly the same size differ by more than the tolerance: the search ends all the same, with a file that is good
 * enough. */
static void test_ripples_end_the_search(void **state) {
    (void)state;
    for (double target = 10; target <= 70; target += 2.3) {
        const curve c = {.measure = ssimulacra2, .at_1000 = -30, .slope = 0.4, .ripple = 2};
        const outcome o = run_search(&c, target, true);
        assert_true(o.best_quality >= target && o.best_quality <= target + 5);
        assert_in_range(o.search.trials, 1, 7);
    }
}

/* Between sizes of a few bytes no size is tried again, and a curve that is flatter than any slope does not hold the search
 * up. */
static void test_no_size_is_tried_twice(void **state) {
    (void)state;
    for (double needed = 5; needed < 3000; needed = floor(1.3 * needed) + 1) {
        gscl_quality_search s = gscl_quality_search_begin(ssimulacra2, 20, PIXELS, false);
        double before = 0;
        while (!s.done) {
            assert_true(s.bytes != before);
            before = s.bytes;
            gscl_quality_search_add(&s, s.bytes >= needed ? 40 : 19.9, s.bytes);
        }
        if (!(s.high.bytes >= needed && s.high.bytes <= fmax(1.2 * needed, needed + 6)))
            fail_msg("%g bytes of %g after %d trials", s.high.bytes, needed, s.trials);
    }
}

static void test_unreachable_target_ends_at_the_largest_size(void **state) {
    (void)state;
    const curve c = {.measure = psnr, .at_1000 = 22, .slope = 0.1};
    const outcome o = run_search(&c, 60, false);
    assert_true(o.best_bytes == 0);
    assert_true(o.search.low.bytes == o.search.max_bytes);
    assert_true(o.search.best_quality == o.search.low.quality);
    assert_in_range(o.search.trials, 1, 8); /* the largest size is tried once */
}

/* An image that has no use for more than 30000 bytes: larger budgets are not searched. */
static void test_files_may_be_smaller_than_their_budget(void **state) {
    (void)state;
    gscl_quality_search s = gscl_quality_search_begin(ssimulacra2, 90, PIXELS, false);
    s.bytes = s.max_bytes;
    assert_true(gscl_quality_search_add(&s, 91.5, 30000));
    assert_true(s.high.bytes == 30000 && s.bytes < 30000);
}

/* Equal images have an infinite PSNR and the highest SSIMULACRA 2: sizes between them and others are tried all the same. */
static void test_equal_images_have_a_place_on_the_scale(void **state) {
    (void)state;
    const struct {
        const gscl_quality_tunables *measure;
        double target, poor, equal;
    } cases[] = {{psnr, 60, 30, INFINITY}, {ssimulacra2, 90, 30, 100}};
    for (int i = 0; i < 2; i++) {
        gscl_quality_search s = gscl_quality_search_begin(cases[i].measure, cases[i].target, PIXELS, false);
        while (!s.done) {
            assert_true(isfinite(s.bytes));
            gscl_quality_search_add(&s, s.bytes >= 20000 ? cases[i].equal : cases[i].poor, s.bytes);
        }
        assert_true(s.high.bytes >= 20000 && s.high.bytes < 24000);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_smooth_curves_of_psnr_are_met),
        cmocka_unit_test(test_smooth_curves_of_ssimulacra2_are_met),
        cmocka_unit_test(test_probes_save_trials),
        cmocka_unit_test(test_steps_end_the_search),
        cmocka_unit_test(test_ripples_end_the_search),
        cmocka_unit_test(test_no_size_is_tried_twice),
        cmocka_unit_test(test_unreachable_target_ends_at_the_largest_size),
        cmocka_unit_test(test_files_may_be_smaller_than_their_budget),
        cmocka_unit_test(test_equal_images_have_a_place_on_the_scale),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
