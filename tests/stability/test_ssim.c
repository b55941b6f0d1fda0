/* The SSIM loss's derivative where windows are flat, against central differences of the loss in double precision. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "both_mappings.h"
#include "report.h"
#include "fit/ssim_loss.h"
#include "synthetic_scene.h"

#define WIDTH 23
#define HEIGHT 19
#define PIXELS (WIDTH * HEIGHT)
#define TAPS 11
#define ACROSS (WIDTH - TAPS + 1)
#define DOWN (HEIGHT - TAPS + 1)
#define C1 1e-4
#define C2 9e-4
#define WEIGHT 0.5 /* of the SSIM term */
#define UNIT 0x1p-24
#define STEP 0x1p-12
/* Error of a window's moment, and of a sum over windows: 22 products are added in rows, then in columns. */
#define SUMMED (48.0 * UNIT)

static double window[TAPS];

static int make_window(void **state) {
    double sum = 0.0;
    for (int i = 0; i < TAPS; i++)
        sum += window[i] = exp(-(i - 5) * (i - 5) / (2.0 * 1.5 * 1.5));
    for (int i = 0; i < TAPS; i++)
        window[i] /= sum;
    return open_contexts(state);
}

/* ---- Double precision ---- */

typedef struct {
    double x, y, xx, yy, xy;
} moments;

static moments window_at(const double *a, const double *b, int left, int top) {
    moments m = {0};
    for (int j = 0; j < TAPS; j++) {
        for (int i = 0; i < TAPS; i++) {
            const double w = window[i] * window[j];
            const double x = a[(top + j) * WIDTH + left + i], y = b[(top + j) * WIDTH + left + i];
            m.x += w * x;
            m.y += w * y;
            m.xx += w * x * x;
            m.yy += w * y * y;
            m.xy += w * x * y;
        }
    }
    return m;
}

static double variances(const moments *m) {
    return m->xx - m->x * m->x + m->yy - m->y * m->y + C2;
}

static double ssim_of(const moments *m) {
    return (2.0 * m->x * m->y + C1) / (m->x * m->x + m->y * m->y + C1) * (2.0 * (m->xy - m->x * m->y) + C2) /
           variances(m);
}

/* The part of the loss, times the number of samples, that depends on one pixel of a plane. */
static double loss_around(const double *a, const double *b, int pixel) {
    const int x = pixel % WIDTH, y = pixel / WIDTH;
    double sum = 0.0;
    for (int top = y - TAPS + 1 > 0 ? y - TAPS + 1 : 0; top <= y && top < DOWN; top++) {
        for (int left = x - TAPS + 1 > 0 ? x - TAPS + 1 : 0; left <= x && left < ACROSS; left++) {
            const moments m = window_at(a, b, left, top);
            sum += ssim_of(&m);
        }
    }
    return (1.0 - WEIGHT) * fabs(a[pixel] - b[pixel]) - WEIGHT / 2.0 * sum * PIXELS / (ACROSS * DOWN);
}

static double difference(double *a, const double *b, int pixel, double step) {
    const double at = a[pixel];
    a[pixel] = at + step;
    const double above = loss_around(a, b, pixel);
    a[pixel] = at - step;
    const double below = loss_around(a, b, pixel);
    a[pixel] = at;
    return above - below;
}

/* Rounding of the window's means against the pixel, over the variances; and of its covariances over the variances,
 * which is weighted by the distance of the pixel from the mean. */
static double bound_of(const double *a, const double *b, int pixel) {
    const int x = pixel % WIDTH, y = pixel / WIDTH;
    double sum = 0.0;
    for (int top = y - TAPS + 1 > 0 ? y - TAPS + 1 : 0; top <= y && top < DOWN; top++) {
        for (int left = x - TAPS + 1 > 0 ? x - TAPS + 1 : 0; left <= x && left < ACROSS; left++) {
            const moments m = window_at(a, b, left, top);
            const double b2 = variances(&m), sizes = a[pixel] + b[pixel] + m.x + m.y;
            const double far = fabs(a[pixel] - m.x) + fabs(b[pixel] - m.y) + fabs(m.x - m.y);
            sum += window[x - left] * window[y - top] * 2.0 / b2 * SUMMED * (sizes + (m.xx + m.yy + C2) / b2 * far) +
                   window[x - left] * window[y - top] * 4.0 * SUMMED / (m.x * m.x + m.y * m.y + C1) * (m.x + m.y);
        }
    }
    return WEIGHT / 2.0 * sum * PIXELS / (ACROSS * DOWN) + 4.0 * UNIT;
}

/* ---- Comparison ---- */

static gscl_result differentiate(gscl_context *context, const float *rendering, const float *target, float *slope) {
    const gscl_kernel_options options = {.blend = 0, .colours = 1};
    gscl_ssim ssim = {0};
    gscl_buffer buffers[3] = {{0}, {0}, {0}};
    const size_t bytes = PIXELS * sizeof(float);
    GSCL_TRY(gscl_buffer_reserve_image(context, &buffers[0], bytes));
    GSCL_TRY(gscl_buffer_reserve_image(context, &buffers[1], bytes));
    GSCL_TRY(gscl_buffer_write(context, &buffers[0], 0, rendering, bytes));
    GSCL_TRY(gscl_buffer_write(context, &buffers[1], 0, target, bytes));
    GSCL_TRY(gscl_ssim_derivative(&ssim, context, &options, WIDTH, HEIGHT, &buffers[0], &buffers[1], (float)WEIGHT,
                                  &buffers[2]));
    GSCL_TRY(gscl_buffer_read(context, &buffers[2], 0, slope, bytes));
    for (int i = 0; i < 3; i++)
        gscl_buffer_free(&buffers[i]);
    gscl_ssim_free(&ssim);
    return GSCL_OK;
}

static void check_pair(const char *name, const float *rendering, const float *target) {
    static double a[PIXELS], b[PIXELS];
    float slopes[2][PIXELS], again[PIXELS];
    double worst[2] = {0}, largest_bound = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        a[i] = rendering[i];
        b[i] = target[i];
    }
    for (int m = 0; m < mapping_count; m++) {
        assert_int_equal(differentiate(contexts[m], rendering, target, slopes[m]), GSCL_OK);
        assert_int_equal(differentiate(contexts[m], rendering, target, again), GSCL_OK);
        assert_memory_equal(slopes[m], again, sizeof again);
    }
    for (int i = 0; i < PIXELS; i++) {
        const double expected = (8.0 * difference(a, b, i, STEP) - difference(a, b, i, 2.0 * STEP)) / (12.0 * STEP);
        const double bound = bound_of(a, b, i) + 1e-9;
        largest_bound = fmax(largest_bound, bound);
        for (int m = 0; m < mapping_count; m++) {
            worst[m] = fmax(worst[m], fabs(slopes[m][i] - expected));
            if (!(fabs(slopes[m][i] - expected) <= bound))
                fail_msg("%s: pixel %d: the slope is %.9g, %.9g expected, at most %.3g apart", name, i, slopes[m][i],
                         expected, bound);
        }
    }
    for (int m = 0; m < mapping_count; m++)
        report("SSIM", name, mapping_names[m], "slope of the loss", largest_bound, worst[m]);
}

/* ---- Cases ---- */

static float rendering[PIXELS], target[PIXELS];

static void fill_plane(float *plane, float value, float noise) {
    for (int i = 0; i < PIXELS; i++)
        plane[i] = value + synthetic_uniform(-noise, noise);
}

static void test_flat(void **state) {
    (void)state;
    static const float values[][2] = {{0.4f, 0.4f}, {1.0f, 1.0f}, {0.0f, 0.0f}, {0.4f, 0.5f}, {0.0f, 1.0f}};
    static const char *const names[] = {"flat 0.4 on 0.4", "flat 1 on 1", "flat 0 on 0", "flat 0.4 on 0.5",
                                        "flat 0 on 1"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        fill_plane(rendering, values[i][0], 0.0f);
        fill_plane(target, values[i][1], 0.0f);
        check_pair(names[i], rendering, target);
    }
}

static void test_flat_and_noise(void **state) {
    (void)state;
    fill_plane(rendering, 0.5f, 0.0f);
    fill_plane(target, 0.5f, 0.3f);
    check_pair("flat on noise", rendering, target);
    check_pair("noise on flat", target, rendering);
    fill_plane(rendering, 0.5f, 0.3f);
    check_pair("noise on noise", rendering, target);
}

static void test_nearly_flat(void **state) {
    (void)state;
    fill_plane(rendering, 0.8f, 0.0f);
    for (int i = 0; i < PIXELS; i++)
        target[i] = (float)(30000 + i) / 65535.0f;
    check_pair("flat on a 16-bit gradient", rendering, target);
    fill_plane(target, 0.0f, 0.0f);
    target[9 * WIDTH + 11] = 1.0f;
    check_pair("flat on one hot pixel", rendering, target);
    check_pair("one hot pixel on itself", target, target);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flat),
        cmocka_unit_test(test_flat_and_noise),
        cmocka_unit_test(test_nearly_flat),
    };
    return cmocka_run_group_tests(tests, make_window, close_contexts);
}
