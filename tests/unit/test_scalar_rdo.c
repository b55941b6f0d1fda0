/* The rate-distortion passes: they end in a minimum of the error, and buffers that they reuse do not change their result. */
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
#include "fit/fit.h"
#include "decode/quantise.h"
#include "fit/tunables.h"
#include "scalar/scalar_rdo.h"
#include "synthetic_scene.h"

#define WIDTH 75
#define HEIGHT 61
#define SPLATS 14
#define PASSES 60
#define FREE 1e-9 /* lambda scale: bits cost nothing */

/* Kinds of splats: opaque ellipses, opaque circles, ellipses with opacities. */
typedef enum { ELLIPSES, CIRCLES, TRANSLUCENT } splat_kind;

typedef struct {
    splat_kind kind;
    gscl_context *context;
    gscl_coded_image coded;
    gscl_fit fit;
    gscl_scalar_rdo rdo;
} scene;

static void check_call(const scene *s, gscl_result result) {
    if (result != GSCL_OK)
        fail_msg("%s", gscl_context_message(s->context));
}

/* The left half is smooth, the right half has waves and noise, so that the weights of pixels differ much. */
static void make_target(float *planes) {
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        const int x = i % WIDTH, y = i / WIDTH % HEIGHT;
        const float wave = 0.3f * sinf(0.7f * (float)x + 0.3f * (float)y) + synthetic_uniform(-0.15, 0.15);
        planes[i] = 0.4f + 0.003f * (float)y + (x < WIDTH / 2 ? 0.02f * sinf(0.2f * (float)x) : wave);
    }
}

static void make_splat(scene *s, gsf_splat *splat) {
    float p[GSCL_PARAMS] = {synthetic_uniform(0, WIDTH), synthetic_uniform(0, HEIGHT), synthetic_uniform(0.5, 2.5),
                            synthetic_uniform(0.5, 2.5), synthetic_uniform(0, 3)};
    if (s->coded.file.header.has_opacity)
        p[GSCL_OPACITY] = synthetic_uniform(-2, 2);
    for (int k = 0; k < 3; k++)
        p[GSCL_COLOUR + k] = synthetic_uniform(0.2, 0.7);
    gscl_quantise(&s->coded.file, p, splat);
}

static void open_scene(scene *s, gscl_context *context, gsf_blend blend, int weighted, bool texture, splat_kind kind) {
    static float planes[3 * WIDTH * HEIGHT];
    memset(s, 0, sizeof *s);
    s->kind = kind;
    s->context = context;
    s->coded.file.header = (gsf_header){.blend = blend,
                                        .coding = GSF_CODING_SCALAR,
                                        .layout = GSF_RGB,
                                        .has_chroma = true,
                                        .has_opacity = kind == TRANSLUCENT,
                                        .has_rotation = kind != CIRCLES,
                                        .has_anisotropy = kind != CIRCLES,
                                        .has_texture = texture,
                                        .width = WIDTH,
                                        .height = HEIGHT,
                                        .splat_count = SPLATS};
    s->coded.file.steps = (gsf_steps){.scale = 6, .position = 8, .angle = 4, .luma = 8, .chroma = 4, .opacity = 3};
    synthetic_random_state = 7;
    make_target(planes);
    gscl_kernel_options options = gscl_coded_image_options(&s->coded.file.header);
    options.weighted = weighted;
    check_call(s, gscl_fit_create(&s->fit, context, &options, WIDTH, HEIGHT, 0, planes));
    check_call(s, gscl_coded_image_reserve(&s->coded, SPLATS));
    for (int i = 0; i < SPLATS; i++)
        make_splat(s, &s->coded.file.splats[i]);
    for (int k = 0; k < 3; k++)
        s->coded.file.background[k] = gscl_quantise_background(&s->coded.file.header, s->fit.background[k]);
}

static void close_scene(scene *s) {
    gscl_scalar_rdo_free(&s->rdo, s->context);
    gscl_fit_free(&s->fit);
    gscl_coded_image_free(&s->coded);
}

/* The (weighted) squared error of the coded image, drawn anew. */
static double error_of(scene *s) {
    static float errors[WIDTH * HEIGHT];
    float *params = malloc((SPLATS + 1) * GSCL_PARAMS * sizeof *params), background[4];
    double sum = 0.0;
    assert_non_null(params);
    gscl_coded_image_params(&s->coded, params, background);
    check_call(s, gscl_fit_replace(&s->fit, params, s->coded.file.header.splat_count, background));
    check_call(s, gscl_fit_error(&s->fit, errors));
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        sum += errors[i];
    free(params);
    return sum;
}

/* Every other pass scans for waves.  A pass depends on the codes alone: where one with a scan and one without change none, the
 * passes after them would do the same. */
static void run_passes_with(scene *s, gscl_scalar_rdo_settings settings, int passes) {
    gsf_splat before[SPLATS];
    for (int pass = 0, unchanged = 0; pass < passes && unchanged < 2; pass++) {
        const uint32_t count = s->coded.file.header.splat_count;
        memcpy(before, s->coded.file.splats, count * sizeof *before);
        settings.scan_textures = pass % 2 == 0;
        check_call(s, gscl_scalar_rdo_pass(&s->rdo, &s->fit, &s->coded, &settings));
        const bool same = s->coded.file.header.splat_count == count &&
                          memcmp(before, s->coded.file.splats, count * sizeof *before) == 0;
        unchanged = same ? unchanged + 1 : 0;
    }
}

static void run_passes(scene *s, double lambda_scale, bool keep_all) {
    run_passes_with(s, (gscl_scalar_rdo_settings){.lambda_scale = lambda_scale, .keep_all = keep_all}, PASSES);
}

/* No step of one colour code lowers the error any more. */
static void check_minimum(scene *s, int variant) {
    /* Circles, and translucent splats, overlap: passes converge slowly, in ever smaller steps. */
    const double slack = s->kind == ELLIPSES ? 1e-4 : 5e-3;
    const double least = error_of(s);
    const gsf_steps *steps = &s->coded.file.steps;
    for (uint32_t i = 0; i < s->coded.file.header.splat_count; i++) {
        gsf_splat *splat = &s->coded.file.splats[i], original = *splat;
        int min, max;
        gsf_luma_range(s->coded.file.header.blend, steps->luma, gsf_colour_fineness(steps, splat->major, splat->aspect),
                       &min, &max);
        int16_t *const codes[] = {&splat->luma, &splat->co, &splat->cg};
        for (int k = 0; k < 6; k++) {
            *codes[k / 2] = (int16_t)(*codes[k / 2] + (k % 2 ? 1 : -1));
            const bool possible = splat->luma >= min && splat->luma <= max;
            const double error = possible ? error_of(s) : least;
            *splat = original;
            if (!(error >= least * (1 - slack)))
                fail_msg("variant %d: splat %u: the error is %.7g, but %.7g with another colour", variant, i, least,
                         error);
        }
    }
}

static void test_free_bits_reach_a_minimum(void **state) {
    (void)state;
    for (int variant = 0; variant < 48; variant++) {
        scene s;
        open_scene(&s, contexts[variant / 8 % mapping_count], variant & 1 ? GSF_BLEND_SUM : GSF_BLEND_NORMALIZED,
                   variant & 2 ? GSCL_WEIGHTED_PIXELS : GSCL_WEIGHTED_NOT, variant & 4, (splat_kind)(variant / 16));
        const double before = error_of(&s);
        run_passes(&s, FREE, true);
        assert_int_equal(s.coded.file.header.splat_count, SPLATS);
        assert_true(error_of(&s) < 0.9 * before);
        check_minimum(&s, variant);
        close_scene(&s);
    }
}

/* Squared error and twice the visual loss of the coded image, drawn anew. */
static double visual_distortion_of(scene *s) {
    const int weighted = s->fit.renderer.options.weighted;
    const gscl_visual_comparison comparison = {.pyramid = &s->fit.pyramid,
                                               .options = &s->fit.renderer.options,
                                               .rendering = &s->fit.renderer.image,
                                               .share = s->fit.visual_share};
    gscl_visual visual = {0};
    gscl_buffer derivative = {0};
    double sum, loss;
    s->fit.model_level = -1;
    s->fit.renderer.options.weighted = GSCL_WEIGHTED_NOT;
    sum = error_of(s);
    check_call(s, gscl_visual_derivative(&visual, &comparison, &derivative));
    check_call(s, gscl_visual_read_loss(&visual, s->context, &loss));
    s->fit.renderer.options.weighted = weighted;
    gscl_visual_free(&visual);
    gscl_buffer_free(&derivative);
    return sum + 2 * loss;
}

/* From the minimum of squared error on, passes with a model of the visual loss lower the sum of both.  The share is large
 * enough to be worth other codes where waves draw the target nearly as it is. */
static void test_passes_lower_the_visual_loss(void **state) {
    (void)state;
    for (int variant = 0; variant < 8; variant++) {
        scene s;
        open_scene(&s, contexts[variant % mapping_count], variant & 2 ? GSF_BLEND_SUM : GSF_BLEND_NORMALIZED,
                   GSCL_WEIGHTED_LUMA, variant & 4, ELLIPSES);
        s.fit.renderer.options.weighted = GSCL_WEIGHTED_NOT;
        run_passes(&s, FREE, true);
        s.fit.visual_share = 0.18f;
        const double before = visual_distortion_of(&s);
        s.fit.renderer.options.weighted = GSCL_WEIGHTED_LUMA;
        run_passes(&s, FREE, true);
        const double after = visual_distortion_of(&s);
        if (!(after < before))
            fail_msg("variant %d: %.6g before, %.6g after", variant, before, after);
        close_scene(&s);
    }
}

static void test_expensive_bits_drop_all_splats(void **state) {
    (void)state;
    for (int m = 0; m < mapping_count; m++) {
        scene s;
        open_scene(&s, contexts[m], GSF_BLEND_NORMALIZED, false, true, ELLIPSES);
        run_passes(&s, 1e4, false);
        assert_int_equal(s.coded.file.header.splat_count, 0);
        close_scene(&s);
    }
}

/* Splats of layers before keep their codes, and are not dropped. */
static void test_fixed_splats_stay(void **state) {
    (void)state;
    for (int m = 0; m < mapping_count; m++) {
        gsf_splat before[SPLATS / 2];
        scene s;
        open_scene(&s, contexts[m], GSF_BLEND_NORMALIZED, false, true, ELLIPSES);
        s.coded.file.header.enhancement_layers = 1;
        for (int i = 0; i < SPLATS; i++)
            s.coded.file.splats[i].layer = i >= SPLATS / 2;
        check_call(&s, gscl_coded_image_sort(&s.coded, NULL));
        memcpy(before, s.coded.file.splats, sizeof before);
        s.fit.fixed = SPLATS / 2;
        run_passes(&s, 1e4, false);
        assert_int_equal(s.coded.file.header.splat_count, SPLATS / 2);
        assert_memory_equal(s.coded.file.splats, before, sizeof before);
        close_scene(&s);
    }
}

/* The sum of the aspect codes beyond the aspect ratio up to which elongation has no price. */
static int elongation_at_price(gscl_context *context, gsf_blend blend, double price) {
    scene s;
    int sum = 0;
    open_scene(&s, context, blend, GSCL_WEIGHTED_NOT, false, ELLIPSES);
    const int free_codes = (int)(2 * 32 / (s.coded.file.steps.scale + 4.0)); /* of log2 4 */
    run_passes_with(&s, (gscl_scalar_rdo_settings){.lambda_scale = FREE, .keep_all = true, .elongation_price = price},
                    PASSES);
    for (int i = 0; i < SPLATS; i++)
        if (s.coded.file.splats[i].aspect > free_codes)
            sum += s.coded.file.splats[i].aspect - free_codes;
    close_scene(&s);
    return sum;
}

/* In the blend sum, where each of these splats removes much of the error under it, the price is next to nothing. */
static void test_a_price_of_elongation_makes_splats_shorter(void **state) {
    (void)state;
    for (int variant = 0; variant < 4; variant++) {
        gscl_context *context = contexts[variant / 2 % mapping_count];
        const bool sum = variant % 2;
        const gsf_blend blend = sum ? GSF_BLEND_SUM : GSF_BLEND_NORMALIZED;
        const int at_none = elongation_at_price(context, blend, 0), at_high = elongation_at_price(context, blend, 1);
        if (!(sum ? at_high <= at_none : 2 * at_high < at_none))
            fail_msg("variant %d: aspect codes of %d without a price, of %d at 1", variant, at_none, at_high);
    }
}

static int waves_that_explain(gscl_context *context, int weighted, double min_explained) {
    scene s;
    int waves = 0;
    open_scene(&s, context, GSF_BLEND_NORMALIZED, weighted, true, ELLIPSES);
    run_passes_with(
        &s, (gscl_scalar_rdo_settings){.lambda_scale = FREE, .keep_all = true, .min_explained = min_explained}, 10);
    for (int i = 0; i < SPLATS; i++)
        waves += s.coded.file.splats[i].texture.amplitude > 0;
    close_scene(&s);
    return waves;
}

/* No wave explains all of noise, and most explain little of it. */
static void test_waves_explain_their_part_of_the_error(void **state) {
    (void)state;
    for (int variant = 0; variant < 6; variant++) {
        const int weighted[] = {GSCL_WEIGHTED_NOT, GSCL_WEIGHTED_PIXELS, GSCL_WEIGHTED_LUMA};
        int waves[3];
        for (int i = 0; i < 3; i++)
            waves[i] = waves_that_explain(contexts[variant % mapping_count], weighted[variant / 2], 0.5 * i);
        if (!(waves[0] > waves[1] && waves[1] > 0 && waves[2] == 0))
            fail_msg("variant %d: %d waves, %d at one half, %d at 1", variant, waves[0], waves[1], waves[2]);
    }
}

static void check_same_files(scene *a, scene *b) {
    uint8_t *a_bytes, *b_bytes;
    size_t a_size, b_size;
    check_call(a, gscl_coded_image_write(&a->coded, &a_bytes, &a_size));
    check_call(b, gscl_coded_image_write(&b->coded, &b_bytes, &b_size));
    assert_int_equal(a_size, b_size);
    assert_memory_equal(a_bytes, b_bytes, b_size);
    gscl_free(a_bytes);
    gscl_free(b_bytes);
}

/* A pass with arrays and buffers that a larger scene has used leaves the same codes as a pass with new ones. */
static void test_reused_buffers_change_nothing(void **state) {
    (void)state;
    const gscl_scalar_rdo_settings settings = {.lambda_scale = 0.1, .keep_all = true, .scan_textures = true};
    for (int m = 0; m < mapping_count; m++) {
        scene reused, fresh;
        open_scene(&reused, contexts[m], GSF_BLEND_NORMALIZED, false, true, TRANSLUCENT);
        for (int pass = 0; pass < 8; pass++) /* enough to fill all groups, were they not emptied */
            check_call(&reused, gscl_scalar_rdo_pass(&reused.rdo, &reused.fit, &reused.coded, &settings));
        const void *weights = reused.rdo.weights.memory, *codes = reused.rdo.device_codes.memory;
        const gscl_scalar_rdo rdo = reused.rdo;
        reused.rdo = (gscl_scalar_rdo){0};
        close_scene(&reused);
        open_scene(&reused, contexts[m], GSF_BLEND_SUM, true, false, ELLIPSES);
        open_scene(&fresh, contexts[m], GSF_BLEND_SUM, true, false, ELLIPSES);
        reused.rdo = rdo;
        reused.coded.file.header.splat_count = fresh.coded.file.header.splat_count = SPLATS / 2;
        for (int pass = 0; pass < 3; pass++) {
            check_call(&reused, gscl_scalar_rdo_pass(&reused.rdo, &reused.fit, &reused.coded, &settings));
            check_call(&fresh, gscl_scalar_rdo_pass(&fresh.rdo, &fresh.fit, &fresh.coded, &settings));
            gscl_scalar_rdo_free(&fresh.rdo, fresh.context);
        }
        assert_ptr_equal(reused.rdo.weights.memory, weights);
        assert_ptr_equal(reused.rdo.device_codes.memory, codes);
        check_same_files(&reused, &fresh);
        close_scene(&reused);
        close_scene(&fresh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_bits_reach_a_minimum),
        cmocka_unit_test(test_passes_lower_the_visual_loss),
        cmocka_unit_test(test_expensive_bits_drop_all_splats),
        cmocka_unit_test(test_fixed_splats_stay),
        cmocka_unit_test(test_a_price_of_elongation_makes_splats_shorter),
        cmocka_unit_test(test_waves_explain_their_part_of_the_error),
        cmocka_unit_test(test_reused_buffers_change_nothing),
    };
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
