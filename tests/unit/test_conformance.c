/* The library's decoders against the oracle and against each other: samples differ by at most 1/255. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "every_decoder.h"
#include "joined_tests.h"
#include "oracle.h"
#include "synthetic_image.h"
#include "synthetic_scene.h"

/* ---- Comparison ---- */

static uint32_t integer_sample(const gscl_image *image, size_t index) {
    return image->sample == GSCL_SAMPLE_U8 ? ((const uint8_t *)image->pixels)[index]
                                           : ((const uint16_t *)image->pixels)[index];
}

/* The largest difference between two decodes. */
typedef struct {
    uint32_t difference;
    size_t index;
    uint32_t values[2];
} gap;

static void widen(gap *widest, size_t index, uint32_t a, uint32_t b) {
    const uint32_t difference = a > b ? a - b : b - a;
    if (difference > widest->difference)
        *widest = (gap){difference, index, {a, b}};
}

static void check_gap(const char *name, int decoder, const char *other, const gap *widest, uint32_t allowed) {
    if (widest->difference > allowed)
        fail_msg("%s: decoder %s and %s: sample %zu is %u and %u, at most %u apart expected", name,
                 decoder_names[decoder], other, widest->index, widest->values[0], widest->values[1], allowed);
}

static void check_header(const oracle_image *truth, const gscl_image *image) {
    assert_int_equal(image->width, truth->header.width);
    assert_int_equal(image->height, truth->header.height);
    assert_int_equal(image->channels, truth->samples);
    assert_int_equal(image->sample, truth->header.high_bit_depth ? GSCL_SAMPLE_U16 : GSCL_SAMPLE_U8);
}

/* Decodes the file in all contexts and compares each pair and each with the oracle. */
static void check_file(const char *name, const uint8_t *bytes, size_t size) {
    oracle_image truth;
    gscl_image images[MAX_DECODERS] = {{0}, {0}, {0}};
    if (!oracle_decode(bytes, size, &truth))
        fail_msg("%s: the oracle cannot read the file", name);
    for (int i = 0; i < decoder_count; i++) {
        const gscl_result result = gscl_decode(contexts[i], bytes, size, NULL, &images[i]);
        if (result != GSCL_OK)
            fail_msg("%s: %s", name, gscl_context_message(contexts[i]));
        check_header(&truth, &images[i]);
    }
    const uint32_t peak = truth.header.high_bit_depth ? 65535 : 255, allowed = truth.header.high_bit_depth ? 257 : 1;
    for (int k = 0; k < decoder_count; k++) {
        const int next = (k + 1) % decoder_count;
        gap to_oracle = {0}, to_next = {0};
        for (size_t i = 0; i < synthetic_sample_count(&images[0]); i++) {
            const uint32_t sample = integer_sample(&images[k], i);
            widen(&to_oracle, i, sample, oracle_round(truth.pixels[i], peak));
            widen(&to_next, i, sample, integer_sample(&images[next], i));
        }
        check_gap(name, k, "oracle", &to_oracle, allowed);
        check_gap(name, k, decoder_names[next], &to_next, allowed);
    }
    for (int i = 0; i < decoder_count; i++)
        gscl_free(images[i].pixels);
    oracle_free(&truth);
}

/* ---- Encoded images ---- */

typedef struct {
    synthetic_image_kind kind;
    uint32_t width, height, channels;
    gscl_sample sample;
    gscl_profile profile;
    gscl_blend blend;
    uint32_t splats;
} encoding;

static const char *const kind_names[] = {"gradient", "noise", "shapes", "flat", "texture"};
static const char *const blend_names[] = {"auto", "normalized", "alpha", "sum"};

static void check_encoding(const encoding *e) {
    char name[128];
    snprintf(name, sizeof name, "%s %ux%u, %u channels, sample %d, profile %d, %s, %u splats", kind_names[e->kind],
             e->width, e->height, e->channels, (int)e->sample, (int)e->profile, blend_names[e->blend], e->splats);
    gscl_image image = synthetic_image(e->kind, e->width, e->height, e->channels, e->sample);
    assert_non_null(image.pixels);
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.profile = e->profile;
    settings.blend = e->blend;
    settings.target = GSCL_TARGET_SPLATS;
    settings.target_value = e->splats;
    settings.effort = 0;
    uint8_t *bytes = NULL;
    size_t size = 0;
    gscl_context *encoder = contexts[has_opencl() ? CPU_MAPPING : HOST];
    const gscl_result result = gscl_encode(encoder, &image, &settings, &bytes, &size, NULL);
    if (result != GSCL_OK)
        fail_msg("%s: %s", name, gscl_context_message(encoder));
    check_file(name, bytes, size);
    gscl_free(bytes);
    synthetic_image_free(&image);
}

static void test_encoded_kinds_and_blends(void **state) {
    (void)state;
    for (gscl_blend blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend++) {
        for (synthetic_image_kind kind = SYNTHETIC_GRADIENT; kind <= SYNTHETIC_FLAT; kind++) {
            const encoding e = {kind, 67, 45, 3, GSCL_SAMPLE_U8, GSCL_PROFILE_DEFAULT, blend, 60};
            check_encoding(&e);
        }
    }
}

static void test_encoded_layouts(void **state) {
    (void)state;
    static const gscl_blend blend_of[5] = {0, GSCL_BLEND_NORMALIZED, GSCL_BLEND_SUM, GSCL_BLEND_ALPHA, 0};
    for (gscl_blend blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend++) {
        for (uint32_t channels = 1; channels <= 4; channels++) {
            const gscl_sample sample = (channels + blend) % 2 ? GSCL_SAMPLE_U8 : GSCL_SAMPLE_U16;
            const encoding e = {SYNTHETIC_SHAPES, 40, 33, channels, sample, GSCL_PROFILE_DEFAULT, blend, 30};
            if (channels == 4 || blend == blend_of[channels]) /* building the kernels for each combination is slow */
                check_encoding(&e);
        }
    }
}

static void test_encoded_sizes(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {1, 40}, {300, 1}, {2, 3}, {16, 16}, {17, 15}, {129, 31}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const encoding e = {SYNTHETIC_TEXTURE, sizes[i][0],          sizes[i][1],     3,
                            GSCL_SAMPLE_U8,    GSCL_PROFILE_DEFAULT, GSCL_BLEND_AUTO, 25};
        check_encoding(&e);
    }
}

static void test_encoded_splat_counts(void **state) {
    (void)state;
    static const uint32_t counts[] = {1, 2, 10, 100, 400};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        const encoding e = {SYNTHETIC_TEXTURE, 96,       80, 3, GSCL_SAMPLE_U8, GSCL_PROFILE_DEFAULT,
                            GSCL_BLEND_AUTO,   counts[i]};
        check_encoding(&e);
    }
}

static void test_encoded_paper_profile(void **state) {
    (void)state;
    for (uint32_t channels = 2; channels <= 3; channels++) {
        const encoding e = {SYNTHETIC_SHAPES, 64, 50, channels, GSCL_SAMPLE_U8, GSCL_PROFILE_PAPER,
                            GSCL_BLEND_AUTO,  60};
        check_encoding(&e);
    }
}

/* ---- Synthetic scenes ---- */

/* Writes the scene, checks the file, and frees the scene. */
static void check_scene(const char *name, synthetic_scene *s) {
    uint8_t *bytes = NULL;
    size_t size = 0;
    const gsf_result result = synthetic_scene_write(s, &bytes, &size);
    if (result != GSF_OK)
        fail_msg("%s: gsf_write returns %d", name, (int)result);
    check_file(name, bytes, size);
    free(bytes);
    synthetic_scene_free(s);
}

static synthetic_scene *photo(uint32_t width, uint32_t height, gsf_blend blend, uint32_t splats) {
    const gsf_header header = {.blend = blend,
                               .layout = GSF_RGB,
                               .has_chroma = true,
                               .has_opacity = blend == GSF_BLEND_ALPHA,
                               .has_rotation = true,
                               .has_anisotropy = true,
                               .width = width,
                               .height = height,
                               .splat_count = splats};
    synthetic_scene *s = synthetic_scene_new(&header);
    assert_non_null(s);
    synthetic_random_state = 31 * width + splats;
    synthetic_background(&s->image);
    return s;
}

static const gsf_blend blends[] = {GSF_BLEND_NORMALIZED, GSF_BLEND_ALPHA, GSF_BLEND_SUM};

static void test_needles(void **state) {
    (void)state;
    for (int b = 0; b < 3; b++) {
        for (uint8_t scale = 0; scale < 16; scale += 5) {
            synthetic_scene *s = photo(90, 70, blends[b], 40);
            s->image.steps = (gsf_steps){.scale = scale, .luma = 10, .chroma = 8, .opacity = 15};
            for (uint32_t i = 0; i < 40; i++)
                synthetic_splat(&s->image, &s->image.splats[i], synthetic_random(4), 40 + synthetic_random(24));
            check_scene("needles", s);
        }
    }
}

static void test_needles_along_the_axes(void **state) {
    (void)state;
    for (int b = 0; b < 3; b++) {
        synthetic_scene *s = photo(65, 65, blends[b], 32);
        s->image.steps = (gsf_steps){.scale = 12, .luma = 10, .chroma = 8};
        for (uint32_t i = 0; i < 32; i++) {
            gsf_splat *splat = &s->image.splats[i];
            synthetic_splat(&s->image, splat, 0, 63);
            splat->angle = (uint16_t)(i % 2 ? 256 : i % 4 ? 1 : 0);
            synthetic_place_splat(&s->image, splat, 2.0 * i + 0.5, 64.0 - 2.0 * i);
        }
        check_scene("needles along the axes", s);
    }
}

static void test_sub_pixel_axes(void **state) {
    (void)state;
    for (int b = 0; b < 3; b++) {
        synthetic_scene *s = photo(50, 40, blends[b], 300);
        s->image.steps = (gsf_steps){.scale = 1, .luma = 15, .chroma = 15};
        for (uint32_t i = 0; i < 300; i++)
            synthetic_splat(&s->image, &s->image.splats[i], synthetic_random(3), synthetic_random(4));
        check_scene("sub-pixel axes", s);
    }
}

static void test_large_splats(void **state) {
    char name[64];
    (void)state;
    for (int b = 0; b < 3; b++) {
        for (uint8_t scale = 2; scale < 16; scale = (uint8_t)(scale + 13)) {
            synthetic_scene *s = photo(80, 60, blends[b], 60);
            s->image.steps = (gsf_steps){.scale = scale, .position = 15, .angle = 2, .luma = 13, .chroma = 9};
            for (uint32_t i = 0; i < 60; i++)
                synthetic_splat(&s->image, &s->image.splats[i], 40 + synthetic_random(24), synthetic_random(64));
            snprintf(name, sizeof name, "large splats of scale step %u, blend %d", scale, (int)blends[b]);
            check_scene(name, s);
        }
    }
}

static void test_corners_and_tile_borders(void **state) {
    (void)state;
    for (int b = 0; b < 3; b++) {
        synthetic_scene *s = photo(64, 49, blends[b], 5 * 5 * 3 * 2);
        s->image.steps = (gsf_steps){.scale = 4, .luma = 12, .chroma = 8};
        gsf_splat *splat = s->image.splats;
        for (int i = 0; i < 5 * 5 * 3; i++) {
            for (int offset = 0; offset < 2; offset++, splat++) {
                synthetic_splat(&s->image, splat, i % 3 * 2u, synthetic_random(6));
                synthetic_place_splat(&s->image, splat, 16.0 * (i / 15) - offset * 0.01,
                                      16.0 * (i / 3 % 5) - offset * 0.01);
            }
        }
        check_scene("corners and tile borders", s);
    }
}

static void test_stacked_splats(void **state) {
    (void)state;
    for (int b = 0; b < 3; b++) {
        for (int opaque = 0; opaque < 2; opaque++) {
            synthetic_scene *s = photo(48, 48, blends[b], 500);
            s->image.header.has_opacity = !opaque;
            s->image.steps = (gsf_steps){.scale = 4, .luma = 12, .chroma = 8, .opacity = 15};
            for (uint32_t i = 0; i < 500; i++) {
                gsf_splat *splat = &s->image.splats[i];
                synthetic_splat(&s->image, splat, 8 + synthetic_random(4), synthetic_random(8));
                synthetic_place_splat(&s->image, splat, 20.0 + synthetic_random(8), 20.0 + synthetic_random(8));
            }
            check_scene(opaque ? "opaque stacked splats" : "stacked splats", s);
        }
    }
}

static void test_opacity_extremes(void **state) {
    (void)state;
    for (int b = 0; b < 3; b++) {
        for (uint8_t step = 0; step < 16; step += 5) {
            synthetic_scene *s = photo(40, 40, blends[b], 80);
            s->image.header.has_opacity = true;
            s->image.steps = (gsf_steps){.scale = 4, .luma = 12, .chroma = 8, .opacity = step};
            for (uint32_t i = 0; i < 80; i++) {
                synthetic_splat(&s->image, &s->image.splats[i], synthetic_random(14), synthetic_random(20));
                s->image.splats[i].opacity = i % 2 ? step : 0;
            }
            check_scene("opacity extremes", s);
        }
    }
}

/* Colours outside 0..1 must not be clamped before they are blended. */
static void test_colours_out_of_range(void **state) {
    (void)state;
    for (int b = 0; b < 3; b++) {
        synthetic_scene *s = photo(40, 40, blends[b], 200);
        s->image.steps = (gsf_steps){.scale = 4, .luma = 15, .chroma = 15};
        for (uint32_t i = 0; i < 200; i++) {
            gsf_splat *splat = &s->image.splats[i];
            int min, max;
            synthetic_splat(&s->image, splat, 2 + synthetic_random(16), synthetic_random(10));
            const unsigned fineness = gsf_colour_fineness(&s->image.steps, splat->major, splat->aspect);
            gsf_luma_range(blends[b], 15, fineness, &min, &max);
            splat->luma = (int16_t)(i % 2 ? min : max);
            gsf_chroma_range(15, fineness, &min, &max);
            splat->co = (int16_t)(synthetic_random(2) ? max : min);
            splat->cg = (int16_t)(synthetic_random(2) ? max : min);
        }
        check_scene("colours out of range", s);
    }
}

static synthetic_scene *scalar_scene(int number) {
    const gsf_header header = synthetic_header(number, GSF_CODING_SCALAR);
    synthetic_scene *s = synthetic_scene_new(&header);
    assert_non_null(s);
    synthetic_background(&s->image);
    s->image.has_mean_background = number % 3 == 0;
    synthetic_steps(&s->image);
    for (uint32_t i = 0; i < header.splat_count; i++)
        synthetic_splat(&s->image, &s->image.splats[i], synthetic_random(20),
                        header.has_anisotropy ? synthetic_random(24) : 0);
    return s;
}

static synthetic_scene *codebook_scene(int number) {
    static const int32_t longest[] = {128, 210, 310, 640};
    const gsf_header header = synthetic_header(number, GSF_CODING_CODEBOOK);
    synthetic_scene *s = synthetic_scene_new(&header);
    assert_non_null(s);
    synthetic_background(&s->image);
    s->image.has_mean_background = number % 3 == 0;
    if (header.splat_count > 0)
        synthetic_codebooks(&s->image, longest[synthetic_random(4)]);
    return s;
}

static void test_random_scenes(void **state) {
    (void)state;
    synthetic_random_state = 2024;
    for (int number = 0; number < 48; number++) {
        check_scene("scalar scene", scalar_scene(number));
        check_scene("codebook scene", codebook_scene(number));
    }
}

/* ---- Reading ---- */

static bool close_to(double a, double b) {
    return fabs(a - b) <= 1e-5 + 2e-6 * fabs(b);
}

static void check_splat(const oracle_header *header, const oracle_splat *truth, const gscl_splat *splat) {
    assert_true(close_to(splat->x, truth->x) && close_to(splat->y, truth->y));
    assert_true(close_to(splat->sigma1, truth->s1) && close_to(splat->sigma2, truth->s2));
    assert_true(close_to(splat->theta, truth->theta));
    assert_true(close_to(splat->opacity, truth->opacity));
    for (uint32_t k = 0; k < 3; k++)
        assert_true(close_to(splat->colour[k], truth->colour[header->has_chroma ? k : 0]));
    assert_true(close_to(splat->colour[3], header->has_alpha ? truth->colour[header->colours] : 1.0));
}

static void check_splats(synthetic_scene *s) {
    uint8_t *bytes = NULL;
    size_t size = 0;
    gscl_field field = {.struct_size = sizeof field};
    oracle_image truth;
    assert_int_equal(synthetic_scene_write(s, &bytes, &size), GSF_OK);
    assert_true(oracle_read(bytes, size, &truth));
    assert_int_equal(gscl_read_field(bytes, size, NULL, &field), GSCL_OK);
    assert_int_equal(field.count, truth.header.splats);
    for (size_t i = 0; i < field.count; i++)
        check_splat(&truth.header, &truth.splats[i], &field.splats[i]);
    gscl_free(field.splats);
    oracle_free(&truth);
    free(bytes);
    synthetic_scene_free(s);
}

static void test_splats(void **state) {
    (void)state;
    synthetic_random_state = 7;
    for (int number = 0; number < 48; number++) {
        check_splats(scalar_scene(number));
        check_splats(codebook_scene(number));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_needles),
        cmocka_unit_test(test_needles_along_the_axes),
        cmocka_unit_test(test_sub_pixel_axes),
        cmocka_unit_test(test_large_splats),
        cmocka_unit_test(test_corners_and_tile_borders),
        cmocka_unit_test(test_stacked_splats),
        cmocka_unit_test(test_opacity_extremes),
        cmocka_unit_test(test_colours_out_of_range),
        cmocka_unit_test(test_random_scenes),
        cmocka_unit_test(test_splats),
    };
    const struct CMUnitTest encoder_tests[] = {
        cmocka_unit_test(test_encoded_kinds_and_blends),
        cmocka_unit_test(test_encoded_layouts),
        cmocka_unit_test(test_encoded_sizes),
        cmocka_unit_test(test_encoded_splat_counts),
        cmocka_unit_test(test_encoded_paper_profile),
    };
    JOIN_TESTS(tests);
    if (has_encoder())
        JOIN_TESTS(encoder_tests);
    return run_joined_tests(open_contexts, close_contexts);
}
