/* The search for a PSNR, on given curves of PSNR against size. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "encode/psnr_search.h"
#include "encode/tunables.h"

#define PIXELS 393216.0 /* 768x512 */

/* PSNR of a file of this size: `db` more for each doubling, in steps where the curve is not smooth. */
typedef struct {
    double at_1000, db, step;
} curve;

static double psnr_of(const curve *c, double bytes) {
    const double psnr = c->at_1000 + c->db * log2(bytes / 1000);
    return c->step > 0 ? c->step * floor(psnr / c->step) : psnr;
}

typedef struct {
    gscl_psnr_search search;
    double best_bytes, best_db; /* of the last trial that reached the target */
} outcome;

static outcome run_search(const curve *c, double target) {
    outcome o = {.search = gscl_psnr_search_begin(target, PIXELS)};
    while (!o.search.done) {
        const double bytes = o.search.bytes, psnr = psnr_of(c, bytes);
        assert_true(bytes >= 1 && bytes <= o.search.max_bytes);
        if (gscl_psnr_search_add(&o.search, psnr)) {
            assert_true(psnr >= target);
            assert_true(o.best_bytes == 0 || bytes < o.best_bytes);
            o.best_bytes = bytes;
            o.best_db = psnr;
        }
    }
    assert_in_range(o.search.trials, 1, gscl_encode_tunables.max_trials);
    return o;
}

static void test_smooth_curves_are_met(void **state) {
    (void)state;
    for (double db = 0.8; db < 6; db += 0.4)
        for (double target = 20; target <= 34; target += 1.7) {
            const curve c = {.at_1000 = 22, .db = db};
            if (psnr_of(&c, gscl_psnr_search_begin(target, PIXELS).max_bytes) < target)
                continue;
            const outcome o = run_search(&c, target);
            assert_true(o.best_db >= target && o.best_db <= target + gscl_encode_tunables.tolerance_db);
        }
}

/* A curve with steps of 2 dB has no size in the target band: the search returns the smallest size that reaches the target. */
static void test_steps_end_the_search(void **state) {
    (void)state;
    const curve c = {.at_1000 = 22, .db = 2.5, .step = 2};
    const outcome o = run_search(&c, 25);
    assert_true(o.best_db == 26);
}

static void test_unreachable_target_ends_at_the_largest_size(void **state) {
    (void)state;
    const curve c = {.at_1000 = 22, .db = 0.1};
    const outcome o = run_search(&c, 60);
    assert_true(o.best_bytes == 0);
    assert_true(o.search.low_bytes == o.search.max_bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_smooth_curves_are_met),
        cmocka_unit_test(test_steps_end_the_search),
        cmocka_unit_test(test_unreachable_target_ends_at_the_largest_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
