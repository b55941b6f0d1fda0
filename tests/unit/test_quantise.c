/* Steps of colour that are chosen for the colour of a plain ground. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cl/constants.h"
#include "decode/quantise.h"

static const gsf_steps usual =
    {.scale = 6, .position = 8, .angle = 4, .luma = 8, .chroma = 4, .alpha = 4, .opacity = 3};

static gsf_coded_image picture_of(gsf_layout layout, bool has_chroma) {
    return (gsf_coded_image){.header = {.width = 64, .height = 64, .layout = layout, .has_chroma = has_chroma},
                             .steps = usual};
}

static void assert_steps(const gsf_coded_image *picture, int luma, int chroma) {
    assert_int_equal(picture->steps.luma, luma);
    assert_int_equal(picture->steps.chroma, chroma);
    assert_int_equal(picture->steps.scale, usual.scale);
    assert_int_equal(picture->steps.alpha, usual.alpha);
}

/* Largest error of a colour that is coded with the picture's steps, in 1/255. */
static float coded_error(const gsf_coded_image *picture, const float *colour, int channels) {
    float params[GSCL_PARAMS] = {0}, coded[GSCL_PARAMS], largest = 0;
    gsf_splat splat;
    for (int k = 0; k < channels; k++)
        params[GSCL_COLOUR + k] = colour[k];
    gscl_quantise(picture, params, &splat);
    gscl_dequantise(picture, &splat, coded);
    for (int k = 0; k < channels; k++)
        largest = fmaxf(largest, 255 * fabsf(coded[GSCL_COLOUR + k] - colour[k]));
    return largest;
}

static void test_colours_with_a_code_keep_the_steps(void **state) {
    (void)state;
    const float black[3] = {0, 0, 0}, white[3] = {1, 1, 1}, coded[3] = {0.5f, 0.625f, 0.25f};
    const float *colours[] = {black, white, coded};
    for (int i = 0; i < 3; i++) {
        gsf_coded_image picture = picture_of(GSF_RGB, true);
        gscl_fit_steps_to_colour(&picture, colours[i]);
        assert_steps(&picture, usual.luma, usual.chroma);
    }
}

static void test_colours_between_codes_get_finer_steps(void **state) {
    (void)state;
    const float cream[3] = {240 / 255.0f, 236 / 255.0f, 220 / 255.0f};
    gsf_coded_image picture = picture_of(GSF_RGB, true);
    float before = coded_error(&picture, cream, 3);
    gscl_fit_steps_to_colour(&picture, cream);
    assert_steps(&picture, 10, 7);
    assert_true(coded_error(&picture, cream, 3) < before / 2);
}

static void test_a_little_is_not_worth_finer_steps(void **state) {
    (void)state;
    const float nearly[3] = {0.4028f, 0.4028f, 0.4028f}; /* 0.87 / 255 off; with the next steps 0.71 / 255 */
    gsf_coded_image picture = picture_of(GSF_RGB, true);
    gscl_fit_steps_to_colour(&picture, nearly);
    assert_steps(&picture, usual.luma, usual.chroma);
}

static void test_grey_looks_at_luma_alone(void **state) {
    (void)state;
    const float dark[2] = {13 / 255.0f, 1};
    gsf_coded_image picture = picture_of(GSF_GREY, false);
    float before = coded_error(&picture, dark, 1);
    gscl_fit_steps_to_colour(&picture, dark);
    assert_steps(&picture, 9, usual.chroma);
    assert_true(coded_error(&picture, dark, 1) < before / 2);
}

static void test_no_steps_beyond_the_finest(void **state) {
    (void)state;
    const float between[3] = {0.3019f, 0.7031f, 0.1011f};
    gsf_coded_image picture = picture_of(GSF_RGB, true);
    picture.steps.luma = picture.steps.chroma = 15;
    gscl_fit_steps_to_colour(&picture, between);
    assert_steps(&picture, 15, 15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_colours_with_a_code_keep_the_steps),
        cmocka_unit_test(test_colours_between_codes_get_finer_steps),
        cmocka_unit_test(test_a_little_is_not_worth_finer_steps),
        cmocka_unit_test(test_grey_looks_at_luma_alone),
        cmocka_unit_test(test_no_steps_beyond_the_finest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
