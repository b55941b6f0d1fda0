/* Colour steps chosen for a flat background, numbers of blend modes, YCoCg, and bounds of ellipses. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cl/constants.h"
#include "decode/blend.h"
#include "decode/dequantise.h"
#include "decode/ellipse.h"
#include "decode/quantise.h"
#include "decode/ycocg.h"

static const gsf_steps initial =
    {.scale = 6, .position = 8, .angle = 4, .luma = 2, .chroma = 2, .alpha = 4, .opacity = 3, .pivot = 3};

static gsf_coded_image coded_image_of(gsf_layout layout, bool has_chroma) {
    return (gsf_coded_image){.header = {.width = 64, .height = 64, .layout = layout, .has_chroma = has_chroma},
                             .steps = initial};
}

static void assert_steps(const gsf_coded_image *coded, int luma, int chroma) {
    assert_int_equal(coded->steps.luma, luma);
    assert_int_equal(coded->steps.chroma, chroma);
    assert_int_equal(coded->steps.scale, initial.scale);
    assert_int_equal(coded->steps.alpha, initial.alpha);
}

/* Largest error of a colour that is coded with the image's steps, in 1/255. */
static float coded_error(const gsf_coded_image *coded, const float *colour, int channels) {
    float params[GSCL_PARAMS] = {0}, decoded[GSCL_PARAMS], largest = 0;
    gsf_splat splat;
    for (int k = 0; k < channels; k++)
        params[GSCL_COLOUR + k] = colour[k];
    gscl_quantise(coded, params, &splat);
    gscl_dequantise(coded, &splat, decoded);
    for (int k = 0; k < channels; k++)
        largest = fmaxf(largest, 255 * fabsf(decoded[GSCL_COLOUR + k] - colour[k]));
    return largest;
}

static void test_colours_with_a_code_keep_the_steps(void **state) {
    (void)state;
    const float black[3] = {0, 0, 0}, white[3] = {1, 1, 1}, exact[3] = {0.5f, 0.625f, 0.25f};
    const float *colours[] = {black, white, exact};
    for (int i = 0; i < 3; i++) {
        gsf_coded_image coded = coded_image_of(GSF_RGB, true);
        gscl_fit_steps_to_colour(&coded, colours[i]);
        assert_steps(&coded, initial.luma, initial.chroma);
    }
}

static void test_colours_between_codes_get_finer_steps(void **state) {
    (void)state;
    const float cream[3] = {240 / 255.0f, 236 / 255.0f, 220 / 255.0f};
    gsf_coded_image coded = coded_image_of(GSF_RGB, true);
    float before = coded_error(&coded, cream, 3);
    gscl_fit_steps_to_colour(&coded, cream);
    assert_steps(&coded, 3, 3);
    assert_true(coded_error(&coded, cream, 3) < before / 2);
}

static void test_small_gains_keep_the_steps(void **state) {
    (void)state;
    const float nearly[3] = {0.4028f, 0.4028f, 0.4028f}; /* 0.87 / 255 off; with the next finer steps 0.71 / 255 */
    gsf_coded_image coded = coded_image_of(GSF_RGB, true);
    gscl_fit_steps_to_colour(&coded, nearly);
    assert_steps(&coded, initial.luma, initial.chroma);
}

static void test_grey_uses_luma_alone(void **state) {
    (void)state;
    const float dark[2] = {13 / 255.0f, 1};
    gsf_coded_image coded = coded_image_of(GSF_GREY, false);
    float before = coded_error(&coded, dark, 1);
    gscl_fit_steps_to_colour(&coded, dark);
    assert_steps(&coded, 3, initial.chroma);
    assert_true(coded_error(&coded, dark, 1) < before / 2);
}

static void test_no_steps_beyond_the_finest(void **state) {
    (void)state;
    const float between[3] = {0.3019f, 0.7031f, 0.1011f};
    gsf_coded_image coded = coded_image_of(GSF_RGB, true);
    coded.steps.luma = coded.steps.chroma = 15;
    gscl_fit_steps_to_colour(&coded, between);
    assert_steps(&coded, 15, 15);
}

static void test_blends_convert_both_ways(void **state) {
    (void)state;
    const gscl_blend blends[] = {GSCL_BLEND_NORMALIZED, GSCL_BLEND_ALPHA, GSCL_BLEND_SUM};
    const gsf_blend formats[] = {GSF_BLEND_NORMALIZED, GSF_BLEND_ALPHA, GSF_BLEND_SUM};
    const int kernels[] = {GSCL_NORMALIZED, GSCL_ALPHA, GSCL_SUM};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(gscl_blend_to_format(blends[i]), formats[i]);
        assert_int_equal(gscl_blend_from_format(formats[i]), blends[i]);
        assert_int_equal(gscl_blend_to_kernels(blends[i]), kernels[i]);
        assert_int_equal(gscl_blend_from_kernels(kernels[i]), blends[i]);
    }
}

static void test_ycocg_and_back(void **state) {
    (void)state;
    const float rgb[3] = {0.25f, 0.5f, 1.0f};
    const gscl_ycocg c = gscl_ycocg_from_rgb(rgb);
    float back[3];
    assert_float_equal(c.y, 0.5625, 1e-9);
    assert_float_equal(c.co, -0.75, 1e-9);
    assert_float_equal(c.cg, -0.125, 1e-9);
    gscl_ycocg_to_rgb(c, back);
    for (int k = 0; k < 3; k++)
        assert_float_equal(back[k], rgb[k], 1e-6);
}

static void test_half_sizes_of_ellipses(void **state) {
    (void)state;
    const double log_s1 = log(4.0), log_s2 = log(3.0), right_angle = 1.57079632679489662;
    gscl_half_size half = gscl_ellipse_half_size(log_s1, log_s2, 0, 0, 2);
    assert_float_equal(half.width, 8, 1e-6);
    assert_float_equal(half.height, 6, 1e-6);
    half = gscl_ellipse_half_size(log_s1, log_s2, right_angle, 9, 1);
    assert_float_equal(half.width, sqrt(18), 1e-6);
    assert_float_equal(half.height, 5, 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_colours_with_a_code_keep_the_steps),
        cmocka_unit_test(test_colours_between_codes_get_finer_steps),
        cmocka_unit_test(test_small_gains_keep_the_steps),
        cmocka_unit_test(test_grey_uses_luma_alone),
        cmocka_unit_test(test_no_steps_beyond_the_finest),
        cmocka_unit_test(test_blends_convert_both_ways),
        cmocka_unit_test(test_ycocg_and_back),
        cmocka_unit_test(test_half_sizes_of_ellipses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
