/* Adam over 10^5 steps, against an implementation in double precision: gradients of 0, of 10^-30, 10^10 and others. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "both_mappings.h"
#include "fit/fit.h"
#include "report.h"
#include "runtime/queue.h"
#include "scene.h"

#define SIDE 64
#define STEPS 100000
#define HALF_PERIOD 512 /* steps after which gradients change sign */
#define USED (GSCL_COLOUR + SCENE_CHANNELS)
#define UNIT 0x1p-24

/* A moment decays by beta a step, so that the roundings of 1 / (1 - beta) steps add up.  A step rounds the second
 * moment four times and the first moment three times. */
#define FIRST_BOUND (3.0 * UNIT / 0.1)
#define SECOND_BOUND (4.0 * UNIT / 0.01)
/* Of one step: both moments, both corrections (exp2 of up to 3 ulp, which is largest at the first steps), and the
 * rate. */
#define STEP_BOUND (FIRST_BOUND + SECOND_BOUND + 40.0 * UNIT)

/* ---- Gradients ---- */

typedef float (*gradient_maker)(long step);

static float flips(long step) {
    return step / HALF_PERIOD % 2 ? -1.0f : 1.0f;
}
static float zero(long step) {
    (void)step;
    return 0.0f;
}
static float tiny(long step) {
    return 1e-30f * flips(step);
}
static float huge(long step) {
    return 1e10f * flips(step);
}
static float huge_once(long step) {
    return step < 10 ? 1e10f : 0.0f;
}
static float tiny_then_1(long step) {
    return step < STEPS / 2 ? 1e-30f : flips(step);
}
static float near_epsilon(long step) {
    return 1e-10f * flips(step);
}

static const struct {
    const char *name;
    gradient_maker gradient;
    unsigned only; /* bits of the parameters that have this gradient */
} cases[] = {
    {"gradient exactly 0", zero, ~0u},
    {"gradient 10^-30", tiny, ~(1u << GSCL_THETA)},
    {"gradient 10^10", huge, ~(1u << GSCL_THETA)},
    {"gradient 1", flips, ~(1u << GSCL_THETA)},
    {"gradient 10^10 ten times, then 0", huge_once, ~(1u << GSCL_THETA)},
    {"gradient 10^-30, then 1", tiny_then_1, ~(1u << GSCL_THETA)},
    {"gradient as small as epsilon", near_epsilon, ~(1u << GSCL_THETA)},
    {"gradient of the angle, 1", flips, 1u << GSCL_THETA},
    {"gradient of one axis, 1", flips, 1u << GSCL_LOG_S1},
};
#define CASES (sizeof cases / sizeof *cases)

static float gradient_of(size_t which, size_t parameter, long step) {
    return parameter < USED && cases[which].only >> parameter & 1 ? cases[which].gradient(step) : 0.0f;
}

/* ---- Double precision (cl/update.cl) ---- */

typedef struct {
    double p[GSCL_PARAMS], m[GSCL_PARAMS], v[GSCL_PARAMS];
    double largest_m[GSCL_PARAMS], largest_v[GSCL_PARAMS];
} state;

static double within(double x, double low, double high) {
    return fmin(fmax(x, low), high);
}

static void rotate(double *x, double *y, double c, double s) {
    const double rotated = c * *x - s * *y;
    *y = c * *y + s * *x;
    *x = rotated;
}

static void rates_of(const double *p, double *rates) {
    const double s1 = exp(p[GSCL_LOG_S1]), s2 = exp(p[GSCL_LOG_S2]);
    const double roundness = sqrt(2.0 / (1.0 + fmax(s1, s2) / fmin(s1, s2)));
    const double all[USED] = {0.06 * s1, 0.06 * s2, 0.08, 0.08, 0.06 * pow(roundness, 1.5), 0.04, 0.012, 0.012, 0.012};
    memcpy(rates, all, sizeof all);
}

static void keep_within(double *p, const gscl_limits *b) {
    p[GSCL_X] = within(p[GSCL_X], 0.0, b->width);
    p[GSCL_Y] = within(p[GSCL_Y], 0.0, b->height);
    const double apart = p[GSCL_LOG_S1] - p[GSCL_LOG_S2], excess = 0.5 * (fabs(apart) - b->log_aspect);
    if (excess > 0.0) {
        p[GSCL_LOG_S1] -= copysign(excess, apart);
        p[GSCL_LOG_S2] += copysign(excess, apart);
    }
    for (int k = GSCL_LOG_S1; k <= GSCL_LOG_S2; k++)
        p[k] = within(p[k], b->log_min, b->log_max);
    p[GSCL_OPACITY] = within(p[GSCL_OPACITY], -8.0, 8.0);
    for (int k = GSCL_COLOUR; k < USED; k++)
        p[k] = within(p[k], b->colour_min, b->colour_max);
}

static void reference_step(state *s, size_t which, long step, const gscl_limits *bounds) {
    const double beta1 = 0.9f, beta2 = 0.99f, age = (double)(step + 1);
    const double correct1 = 1.0 / (1.0 - pow(beta1, age)), correct2 = 1.0 / (1.0 - pow(beta2, age));
    const double c = cos(s->p[GSCL_THETA]), n = sin(s->p[GSCL_THETA]);
    double rates[USED], steps[USED];
    rates_of(s->p, rates);
    for (size_t k = 0; k < USED; k++)
        steps[k] = gradient_of(which, k, step);
    rotate(&steps[GSCL_X], &steps[GSCL_Y], c, -n);
    for (size_t k = 0; k < USED; k++) {
        s->m[k] = beta1 * s->m[k] + (1.0 - beta1) * steps[k];
        s->v[k] = beta2 * s->v[k] + (1.0 - beta2) * steps[k] * steps[k];
        s->largest_m[k] = fmax(s->largest_m[k], fabs(s->m[k]));
        s->largest_v[k] = fmax(s->largest_v[k], s->v[k]);
        steps[k] = rates[k] * s->m[k] * correct1 / (sqrt(s->v[k] * correct2) + 1e-10);
    }
    rotate(&steps[GSCL_X], &steps[GSCL_Y], c, n);
    for (size_t k = 0; k < USED; k++)
        s->p[k] -= steps[k];
    keep_within(s->p, bounds);
}

/* ---- The library ---- */

typedef struct {
    float p[CASES * GSCL_PARAMS], m[CASES * GSCL_PARAMS], v[CASES * GSCL_PARAMS];
} outcome;

static void check_call(gscl_context *context, gscl_result result) {
    if (result != GSCL_OK)
        fail_msg("%s", gscl_context_message(context));
}

static void start_params(float *p) {
    memset(p, 0, CASES * GSCL_PARAMS * sizeof *p);
    for (size_t i = 0; i < CASES; i++, p += GSCL_PARAMS) {
        p[GSCL_X] = p[GSCL_Y] = SIDE / 2;
        p[GSCL_LOG_S1] = 1.5f;
        p[GSCL_LOG_S2] = 0.5f;
        p[GSCL_THETA] = 0.3f;
        p[GSCL_COLOUR] = p[GSCL_COLOUR + 1] = p[GSCL_COLOUR + 2] = 0.5f;
    }
}

static gscl_result run_steps(gscl_fit *fit, long count) {
    float gradients[CASES * GSCL_PARAMS], before[CASES * GSCL_PARAMS];
    for (long step = 0; step < count; step++) {
        for (size_t i = 0; i < CASES * GSCL_PARAMS; i++)
            gradients[i] = gradient_of(i / GSCL_PARAMS, i % GSCL_PARAMS, step);
        if (step == 0 || memcmp(gradients, before, sizeof before))
            GSCL_TRY(gscl_buffer_write(fit->context, &fit->gradients, 0, gradients, sizeof gradients));
        memcpy(before, gradients, sizeof before);
        GSCL_TRY(gscl_fit_adam(fit, &fit->renderer.params, 1.0f));
        if (step % 1000 == 999)
            GSCL_TRY(gscl_finish(fit->context));
    }
    return GSCL_OK;
}

static void run_fit(gscl_context *context, long count, outcome *o, gscl_limits *limits) {
    static float target[SIDE * SIDE * SCENE_CHANNELS];
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = SCENE_CHANNELS, .opacity = 1};
    gscl_fit fit;
    start_params(o->p);
    check_call(context, gscl_fit_create(&fit, context, &options, SIDE, SIDE, 0, target));
    check_call(context, gscl_fit_append(&fit, o->p, CASES));
    check_call(context, run_steps(&fit, count));
    check_call(context, gscl_fit_read(&fit, o->p));
    check_call(context, gscl_buffer_read(context, &fit.first_moment, 0, o->m, sizeof o->m));
    check_call(context, gscl_buffer_read(context, &fit.second_moment, 0, o->v, sizeof o->v));
    *limits = fit.limits;
    gscl_fit_free(&fit);
}

/* ---- Comparison ---- */

/* The errors of a parameter accumulate until it is clamped to its limits, which the angle does not have. */
static double parameter_bound(size_t parameter, const double *rates, long count, double size) {
    const double steps = parameter == GSCL_THETA ? (double)count : fmin((double)count, 2.0 * HALF_PERIOD);
    return steps * (rates[parameter] * STEP_BOUND + UNIT * size);
}

static void check_outcome(size_t which, const outcome *o, const state *s, long count, const char *mapping) {
    static const double sizes[USED] = {SIDE, SIDE, 5.0, 5.0, 40.0, 8.0, 1.0, 1.0, 1.0};
    double rates[USED], first = 0.0, second = 0.0, parameter = 0.0;
    rates_of(s->p, rates);
    rates[GSCL_X] = rates[GSCL_Y] = 0.06 * SIDE; /* the longest axis */
    rates[GSCL_THETA] = 0.06;
    for (size_t k = 0; k < USED; k++) {
        const size_t at = which * GSCL_PARAMS + k;
        assert_true(isfinite(o->p[at]) && isfinite(o->m[at]) && isfinite(o->v[at]));
        if (s->largest_m[k] > 0.0)
            first = fmax(first, fabs(o->m[at] - s->m[k]) / s->largest_m[k]);
        if (s->largest_v[k] > 1e-30) /* smaller values are 0 in a float */
            second = fmax(second, fabs(o->v[at] - s->v[k]) / s->largest_v[k]);
        parameter = fmax(parameter, fabs(o->p[at] - s->p[k]) / parameter_bound(k, rates, count, sizes[k]));
    }
    report("Adam", cases[which].name, mapping, "first moment, relative", FIRST_BOUND, first);
    report("Adam", cases[which].name, mapping, "second moment, relative", SECOND_BOUND, second);
    report("Adam", cases[which].name, mapping, "parameter, of its bound", 1.0, parameter);
    if (!(first <= FIRST_BOUND && second <= SECOND_BOUND && parameter <= 1.0))
        fail_msg("%s, %s: moments are off by %g and %g, parameters by %g of their bound", cases[which].name, mapping,
                 first, second, parameter);
}

static void test_many_steps(void **unused) {
    (void)unused;
    static outcome outcomes[2], again;
    static state states[CASES];
    gscl_limits limits = {0};
    const long count = (long)scene_scaled(STEPS, 40);
    for (int m = 0; m < mapping_count; m++)
        run_fit(contexts[m], count, &outcomes[m], &limits);
    run_fit(contexts[0], count, &again, &limits);
    assert_memory_equal(&outcomes[0], &again, sizeof again);
    float start[CASES * GSCL_PARAMS];
    start_params(start);
    for (size_t i = 0; i < CASES; i++) {
        for (size_t k = 0; k < GSCL_PARAMS; k++)
            states[i].p[k] = start[i * GSCL_PARAMS + k];
        for (long step = 0; step < count; step++)
            reference_step(&states[i], i, step, &limits);
        for (int m = 0; m < mapping_count; m++)
            check_outcome(i, &outcomes[m], &states[i], count, mapping_names[m]);
    }
}

/* Without a gradient no bit of a parameter changes. */
static void test_zero_gradients_change_nothing(void **unused) {
    (void)unused;
    static outcome o;
    gscl_limits limits;
    float start[CASES * GSCL_PARAMS];
    start_params(start);
    for (int m = 0; m < mapping_count; m++) {
        run_fit(contexts[m], 30, &o, &limits);
        assert_memory_equal(o.p, start, GSCL_PARAMS * sizeof *start);
        for (size_t k = GSCL_PARAMS; k < 2 * GSCL_PARAMS; k++)
            assert_true(fabsf(o.p[k] - start[k]) <= 1e-12f);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_many_steps),
        cmocka_unit_test(test_zero_gradients_change_nothing),
    };
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
