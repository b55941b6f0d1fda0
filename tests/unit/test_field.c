/* Fields: the arrays of a file are all that is needed to draw it, and gscl_pack writes them again; those of others are packed
 * for a target, changed where the format has not all that they have, or refused. */
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
#include <gscl/measure.h>

#include "joined_tests.h"
#include "one_context.h"
#include "synthetic_image.h"
#include "synthetic_scene.h"

#define PI 3.14159265358979323846

static void assert_result(gscl_result result, gscl_result expected) {
    if (result != expected)
        fail_msg("%s (%s); expected: %s", gscl_result_text(result), gscl_context_message(context),
                 gscl_result_text(expected));
}

/* ---- Drawing from the arrays alone, as gscl.h describes it ---- */

static double weight_at(const gscl_splat *s, double dx, double dy) {
    const double c = cos(s->theta), n = sin(s->theta);
    const double u = (c * dx + n * dy) / s->sigma1, v = (c * dy - n * dx) / s->sigma2;
    return s->opacity * fmax(0, exp(-(u * u + v * v) / 2) - exp(-GSCL_SPLAT_CUTOFF));
}

static double colour_at(const gscl_splat *s, int channel, double dx, double dy) {
    const double turns = s->wave_x * dx + s->wave_y * dy - s->wave_phase;
    return s->colour[channel] + (channel < 3 ? s->wave_amplitude * cos(2 * PI * turns) : 0);
}

/* R, G, B and alpha of the pixel whose centre is (x, y), before they are clamped. */
static void draw_pixel(const gscl_field *f, double x, double y, double value[4]) {
    double weights = f->blend == GSCL_BLEND_NORMALIZED ? GSCL_BACKGROUND_WEIGHT : 1;
    for (int k = 0; k < 4; k++)
        value[k] = weights * f->background[k];
    for (size_t i = 0; i < f->count; i++) {
        const gscl_splat *s = &f->splats[i];
        const double dx = x - s->x, dy = y - s->y, weight = weight_at(s, dx, dy), a = fmin(weight, GSCL_LARGEST_ALPHA);
        if (weight == 0)
            continue;
        for (int k = 0; k < 4; k++) {
            const double colour = colour_at(s, k, dx, dy);
            value[k] = f->blend == GSCL_BLEND_ALPHA ? value[k] * (1 - a) + a * colour : value[k] + weight * colour;
        }
        weights += f->blend == GSCL_BLEND_NORMALIZED ? weight : 0;
    }
    for (int k = 0; k < 4; k++)
        value[k] /= weights;
}

/* A sample of an image with premultiplied colours. */
static double sample_of(const gscl_field *f, const double value[4], uint32_t channel) {
    const bool has_alpha = f->channels % 2 == 0;
    const double alpha = has_alpha ? fmin(fmax(value[3], 0), 1) : 1;
    return has_alpha && channel == f->channels - 1 ? alpha : fmin(fmax(value[channel], 0), alpha);
}

static gscl_image decoded(const uint8_t *bytes, size_t size, bool bare) {
    gscl_decode_settings settings;
    gscl_image image = {0};
    gscl_decode_settings_default(&settings);
    settings.sample = GSCL_SAMPLE_F32;
    settings.premultiplied = true;
    settings.bare = bare;
    assert_result(gscl_decode(context, bytes, size, &settings, &image), GSCL_OK);
    return image;
}

static gscl_field field_of(const uint8_t *bytes, size_t size, bool bare) {
    gscl_read_settings settings;
    gscl_field field = {.struct_size = sizeof field};
    gscl_read_settings_default(&settings);
    settings.bare = bare;
    assert_result(gscl_read_field(bytes, size, &settings, &field), GSCL_OK);
    return field;
}

/* The sum of weights of a pixel decides how exact a decoder is (FORMAT.md, "Precision"): here 4 per cent of a sample. */
static void check_drawing(const gscl_field *f, const gscl_image *image) {
    const double tolerance = 0.04 / 255 + 1e-5 * (double)f->count;
    for (uint32_t y = 0; y < f->height; y++) {
        for (uint32_t x = 0; x < f->width; x++) {
            double value[4];
            draw_pixel(f, x + 0.5, y + 0.5, value);
            for (uint32_t k = 0; k < f->channels; k++) {
                const size_t at = ((size_t)y * f->width + x) * f->channels + k;
                const double sample = ((const float *)image->pixels)[at];
                if (fabs(sample - sample_of(f, value, k)) > tolerance)
                    fail_msg("pixel %u, %u, channel %u: %g in place of %g", x, y, k, sample_of(f, value, k), sample);
            }
        }
    }
}

static const synthetic_kind kinds[] = {{31, 22, 40, GSF_CODING_SCALAR, false},
                                       {24, 17, 30, GSF_CODING_CODEBOOK, false},
                                       {9, 14, 12, GSF_CODING_SCALAR, true}};
#define KINDS (sizeof kinds / sizeof *kinds)

static void test_arrays_are_all_of_a_picture(void **state) {
    (void)state;
    for (size_t i = 0; i < KINDS; i++) {
        for (int number = 0; number < 24; number++) {
            uint8_t *bytes = NULL;
            size_t size = 0;
            assert_int_equal(synthetic_file_of_kind(&kinds[i], number, &bytes, &size), GSF_OK);
            gscl_field field = field_of(bytes, size, kinds[i].bare);
            gscl_image image = decoded(bytes, size, kinds[i].bare);
            check_drawing(&field, &image);
            gscl_free(image.pixels);
            gscl_free(field.splats);
            free(bytes);
        }
    }
}

/* ---- Packing the field of a file ---- */

static double psnr_between(const gscl_image *a, const gscl_image *b) {
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    assert_result(gscl_compare(a, b, &comparison), GSCL_OK);
    return comparison.psnr;
}

typedef struct {
    uint8_t *bytes;
    size_t size;
    gscl_pack_report report;
} packed;

static packed pack(const gscl_field *field, const gscl_pack_settings *settings) {
    packed p = {.report = {.struct_size = sizeof p.report}};
    assert_result(gscl_pack(context, field, settings, &p.bytes, &p.size, &p.report), GSCL_OK);
    assert_int_equal(p.report.bytes, p.size);
    return p;
}

static void refuse(const gscl_field *field, const gscl_pack_settings *settings, gscl_result expected,
                   const char *message) {
    uint8_t *bytes = NULL;
    size_t size = 0;
    assert_result(gscl_pack(context, field, settings, &bytes, &size, NULL), expected);
    assert_null(bytes);
    if (!strstr(gscl_context_message(context), message))
        fail_msg("\"%s\" lacks \"%s\"", gscl_context_message(context), message);
}

/* Codes that draw the same may differ, as those of a wave without an amplitude; packing them again changes nothing. */
static void test_fields_of_files_are_packed_again(void **state) {
    (void)state;
    for (int number = 0; number < 24; number++) {
        for (size_t i = 0; i < KINDS; i += 2) { /* in scalar coding */
            gscl_pack_settings settings;
            uint8_t *bytes = NULL;
            size_t size = 0;
            gscl_pack_settings_default(&settings);
            settings.bare = kinds[i].bare;
            assert_int_equal(synthetic_file_of_kind(&kinds[i], number, &bytes, &size), GSF_OK);
            gscl_field first = field_of(bytes, size, kinds[i].bare);
            const packed once = pack(&first, &settings);
            gscl_field second = field_of(once.bytes, once.size, kinds[i].bare);
            const packed twice = pack(&second, &settings);
            gscl_image images[2] = {decoded(bytes, size, kinds[i].bare), decoded(once.bytes, once.size, kinds[i].bare)};
            assert_true(psnr_between(&images[0], &images[1]) > 100);
            assert_int_equal(once.report.splats, first.count);
            assert_int_equal(once.report.changed + once.report.outside + once.report.divided, 0);
            assert_int_equal(twice.size, once.size);
            assert_memory_equal(twice.bytes, once.bytes, once.size);
            gscl_free(images[0].pixels), gscl_free(images[1].pixels), gscl_free(once.bytes), gscl_free(twice.bytes);
            gscl_free(first.splats), gscl_free(second.splats), free(bytes);
        }
    }
}

static void test_files_are_packed_to_their_bytes(void **state) {
    (void)state;
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.effort = 2;
    for (uint32_t channels = 1; channels <= 4; channels++) {
        gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 60, 44, channels, GSCL_SAMPLE_U8);
        uint8_t *bytes;
        size_t size;
        assert_result(gscl_encode(context, &image, &settings, &bytes, &size, NULL), GSCL_OK);
        gscl_field field = field_of(bytes, size, false);
        const packed p = pack(&field, NULL);
        assert_int_equal(p.size, size);
        assert_memory_equal(p.bytes, bytes, size);
        gscl_free(p.bytes), gscl_free(field.splats), gscl_free(bytes), synthetic_image_free(&image);
    }
}

/* Splats of a file that somebody has moved are no codes of its steps. */
static void test_changed_fields_of_files(void **state) {
    (void)state;
    uint8_t *bytes = NULL;
    size_t size = 0;
    assert_true(synthetic_file(90, 60, 50, &bytes, &size));
    gscl_field field = field_of(bytes, size, false);
    assert_true(field.has_steps);
    field.splats[7].x += 1.3f;
    packed p = pack(&field, NULL);
    if (!(p.report.psnr > 30 && p.report.position_error < 0.5 && p.report.changed < 5))
        fail_msg("%g dB, %g pixels", p.report.psnr, p.report.position_error);
    gscl_free(p.bytes);
    field.splats[7].sigma1 = 0.1f;
    gscl_pack_settings settings;
    gscl_pack_settings_default(&settings);
    settings.tolerance = 1e-6;
    refuse(&field, &settings, GSCL_ERROR_FIELD, "splat 7: sigma1 is 0.1 pixels");
    field.steps.scale = 16;
    refuse(&field, NULL, GSCL_ERROR_INVALID_ARGUMENT, "steps of the field");
    gscl_free(field.splats), free(bytes);
}

/* ---- Fields of other programs ---- */

enum { WIDTH = 96, HEIGHT = 72, SPLATS = 150 };
static gscl_splat splats[SPLATS];

/* Numbers that no code has exactly; in the blend sum some amplitudes need several splats. */
static gscl_field foreign_field(gscl_blend blend) {
    synthetic_random_state = 11;
    for (size_t i = 0; i < SPLATS; i++) {
        gscl_splat *s = &splats[i];
        *s = (gscl_splat){.x = synthetic_uniform(0, WIDTH),
                          .y = synthetic_uniform(0, HEIGHT),
                          .sigma1 = synthetic_uniform(0.7, 9),
                          .sigma2 = synthetic_uniform(0.7, 9),
                          .theta = synthetic_uniform(-7, 7),
                          .opacity = 1,
                          .colour = {0, 0, 0, 1}};
        for (int k = 0; k < 3; k++)
            s->colour[k] = blend == GSCL_BLEND_SUM ? synthetic_uniform(-0.2, 0.25) : synthetic_uniform(0, 1);
    }
    return (gscl_field){.struct_size = sizeof(gscl_field),
                        .width = WIDTH,
                        .height = HEIGHT,
                        .channels = 3,
                        .sample = GSCL_SAMPLE_U8,
                        .blend = blend,
                        .background = {0.5f, 0.5f, 0.5f, 1},
                        .count = SPLATS,
                        .splats = splats};
}

static gscl_pack_settings settings_for(gscl_target target, double value) {
    gscl_pack_settings settings;
    gscl_pack_settings_default(&settings);
    settings.target = target;
    settings.target_value = value;
    return settings;
}

static void test_finest_steps(void **state) {
    (void)state;
    for (gscl_blend blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend += 2) {
        const gscl_field field = foreign_field(blend);
        const packed p = pack(&field, NULL);
        assert_true(p.report.psnr > 40);
        assert_true(isinf(p.report.field_psnr) && isinf(p.report.changed_psnr));
        assert_true(p.report.position_error < 0.5 && p.report.axis_error < 0.05 && p.report.colour_error < 0.01);
        assert_int_equal(p.report.splats, SPLATS);
        gscl_free(p.bytes);
    }
}

static void test_targets(void **state) {
    (void)state;
    for (gscl_blend blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend += 2) {
        const gscl_field field = foreign_field(blend);
        gscl_pack_settings settings = settings_for(GSCL_TARGET_BYTES, 620);
        const packed with = pack(&field, &settings);
        settings.passes = false;
        const packed without = pack(&field, &settings);
        assert_true(with.size <= 620 && without.size <= 620 && with.size > 560);
        assert_true(with.report.psnr > without.report.psnr);
        assert_true(isnan(with.report.colour_error) && !isnan(without.report.colour_error));
        settings = settings_for(GSCL_TARGET_PSNR, 32);
        const packed reached = pack(&field, &settings);
        settings.passes = false;
        const packed larger = pack(&field, &settings);
        assert_true(reached.report.psnr >= 32 && larger.report.psnr >= 32 && reached.size < larger.size);
        gscl_free(with.bytes), gscl_free(without.bytes), gscl_free(reached.bytes), gscl_free(larger.bytes);
    }
}

static void test_refining_moves_splats(void **state) {
    (void)state;
    const gscl_field field = foreign_field(GSCL_BLEND_NORMALIZED);
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, WIDTH, HEIGHT, 3, GSCL_SAMPLE_U8);
    gscl_pack_settings settings = settings_for(GSCL_TARGET_BYTES, 620);
    settings.reference = &image;
    const packed still = pack(&field, &settings);
    settings.refine = 3;
    const packed moved = pack(&field, &settings);
    assert_true(moved.report.psnr > still.report.psnr + 1);
    assert_true(still.report.field_psnr < 20 && moved.report.splats <= SPLATS && moved.size <= 620);
    gscl_free(still.bytes), gscl_free(moved.bytes), synthetic_image_free(&image);
}

static void test_strong_colours_are_divided(void **state) {
    (void)state;
    gscl_field field = foreign_field(GSCL_BLEND_SUM);
    for (int k = 0; k < 3; k++)
        splats[3].colour[k] = 3.9f, splats[4].colour[k] = -3.9f;
    splats[4].x = splats[3].x + 0.3f, splats[4].y = splats[3].y;
    splats[4].sigma1 = splats[3].sigma1, splats[4].sigma2 = splats[3].sigma2, splats[4].theta = splats[3].theta;
    splats[5].x = -4 * splats[5].sigma1 - 4 * splats[5].sigma2; /* outside */
    splats[6].colour[0] = splats[6].colour[1] = splats[6].colour[2] = 0;
    const packed p = pack(&field, NULL);
    assert_int_equal(p.report.divided, 2);
    assert_int_equal(p.report.outside, 2);
    assert_int_equal(p.report.splats, SPLATS + 2 * 3 - 2);
    assert_int_equal(p.report.changed, 0);
    assert_true(p.report.psnr > 30);
    gscl_free(p.bytes);
}

/* Centres beyond the sides and the corners by up to two standard deviations, and one whose wave would show a wrong phase. */
static void test_centres_outside_the_picture(void **state) {
    (void)state;
    const double places[][2] = {{-6, 20}, {40, -5}, {103, 50}, {60, 81}, {-5, -4}, {102, -3}, {-3, 78}, {99, 77}};
    for (gscl_blend blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend += 2) {
        const gscl_field field = foreign_field(blend);
        gscl_pack_settings settings = settings_for(GSCL_TARGET_AUTO, 0);
        settings.tolerance = 1;
        for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
            splats[i].x = (float)places[i][0], splats[i].y = (float)places[i][1];
            splats[i].sigma1 = 7, splats[i].sigma2 = 4;
        }
        splats[8].x = -1, splats[8].y = 36, splats[8].sigma1 = splats[8].sigma2 = 20;
        splats[8].wave_x = 0.25f, splats[8].wave_y = 0.02f, splats[8].wave_amplitude = 0.3f;
        const packed p = pack(&field, &settings);
        assert_int_equal(p.report.changed, 9);
        if (p.report.changed_psnr < 50)
            fail_msg("blend %d: %g dB", (int)blend, p.report.changed_psnr);
        gscl_free(p.bytes);
    }
}

static void test_changes_are_within_the_tolerance(void **state) {
    (void)state;
    gscl_field field = foreign_field(GSCL_BLEND_NORMALIZED);
    gscl_pack_settings settings = settings_for(GSCL_TARGET_AUTO, 0);
    splats[7].sigma2 = 0.45f;
    const packed p = pack(&field, &settings);
    assert_int_equal(p.report.changed, 1);
    assert_true(p.report.changed_psnr > 40 && p.report.changed_psnr < 120);
    settings.tolerance = 1e-5;
    refuse(&field, &settings, GSCL_ERROR_FIELD, "splat 7: sigma2 is 0.45 pixels, the format has 0.5");
    splats[7].sigma2 = 2;
    splats[8].colour[0] = 2.5f;
    refuse(&field, &settings, GSCL_ERROR_FIELD, "splat 8: ");
    gscl_free(p.bytes);
}

/* The blend alpha has the order of the format. */
static void test_order_of_alpha(void **state) {
    (void)state;
    gscl_field field = foreign_field(GSCL_BLEND_ALPHA);
    field.count = 2;
    splats[0].sigma1 = splats[0].sigma2 = 3, splats[1].sigma1 = splats[1].sigma2 = 20;
    splats[0].x = splats[1].x = 40, splats[0].y = splats[1].y = 30;
    for (int k = 0; k < 3; k++)
        splats[0].colour[k] = 0, splats[1].colour[k] = 1;
    refuse(&field, NULL, GSCL_ERROR_FIELD, "its place is ");
    splats[0].sigma1 = splats[0].sigma2 = 30;
    const packed p = pack(&field, NULL);
    assert_true(p.report.psnr > 28 && p.report.changed == 0);
    gscl_free(p.bytes);
}

/* ---- What is no field ---- */

typedef struct {
    size_t offset; /* of a float of splat 17 */
    float value;
    const char *message;
} bad_number;

static void test_bad_numbers_name_their_splat(void **state) {
    (void)state;
    const bad_number numbers[] = {{offsetof(gscl_splat, x), NAN, "splat 17: x is "},
                                  {offsetof(gscl_splat, y), INFINITY, "splat 17: y is inf"},
                                  {offsetof(gscl_splat, sigma1), 0, "splat 17: sigma1 is 0; it must be 1e-06 to 1e+06"},
                                  {offsetof(gscl_splat, sigma2), -1, "splat 17: sigma2 is -1"},
                                  {offsetof(gscl_splat, sigma2), INFINITY, "splat 17: sigma2 is inf"},
                                  {offsetof(gscl_splat, theta), NAN, "splat 17: theta"},
                                  {offsetof(gscl_splat, opacity), -0.5f, "splat 17: opacity is -0.5"},
                                  {offsetof(gscl_splat, colour[1]), NAN, "splat 17: green"},
                                  {offsetof(gscl_splat, wave_amplitude), NAN, "splat 17: wave_amplitude"}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        const gscl_field field = foreign_field(GSCL_BLEND_NORMALIZED);
        memcpy((char *)&splats[17] + numbers[i].offset, &numbers[i].value, sizeof(float));
        refuse(&field, NULL, GSCL_ERROR_INVALID_ARGUMENT, numbers[i].message);
    }
    const gscl_field field = foreign_field(GSCL_BLEND_NORMALIZED);
    splats[17].layer = 8;
    refuse(&field, NULL, GSCL_ERROR_INVALID_ARGUMENT, "splat 17: layer is 8");
}

static void test_bad_fields(void **state) {
    (void)state;
    gscl_field field = foreign_field(GSCL_BLEND_SUM);
    field.width = 0;
    refuse(&field, NULL, GSCL_ERROR_IMAGE_SIZE, "0x72 pixels");
    field.width = GSCL_MAX_DIMENSION + 1;
    refuse(&field, NULL, GSCL_ERROR_IMAGE_SIZE, "16385x72");
    field = foreign_field(GSCL_BLEND_SUM);
    field.count = 1000000000;
    refuse(&field, NULL, GSCL_ERROR_FIELD, "1000000000 splats; the format has at most 1048576");
    field = foreign_field(GSCL_BLEND_SUM);
    field.splats = NULL;
    refuse(&field, NULL, GSCL_ERROR_INVALID_ARGUMENT, "no splats, but their number");
    field = foreign_field(GSCL_BLEND_AUTO);
    refuse(&field, NULL, GSCL_ERROR_INVALID_ARGUMENT, "blend");
    field = foreign_field(GSCL_BLEND_SUM);
    field.channels = 5;
    refuse(&field, NULL, GSCL_ERROR_INVALID_ARGUMENT, "5 channels");
    field = foreign_field(GSCL_BLEND_SUM);
    field.background[2] = 1.5f;
    refuse(&field, NULL, GSCL_ERROR_INVALID_ARGUMENT, "channel 2 of the field's background is 1.5");
    field = foreign_field(GSCL_BLEND_SUM);
    field.struct_size = 0;
    refuse(&field, NULL, GSCL_ERROR_STRUCT_SIZE, "gscl_field");
    field = foreign_field(GSCL_BLEND_NORMALIZED);
    for (size_t i = 0; i < SPLATS; i++)
        splats[i].sigma1 = splats[i].sigma2 = 30000;
    field.width = field.height = 16384;
    refuse(&field, &(gscl_pack_settings){0}, GSCL_ERROR_STRUCT_SIZE, "gscl_pack_settings");
    for (size_t i = 0; i < SPLATS; i++)
        splats[i].colour[0] = 400000;
    field.blend = GSCL_BLEND_SUM;
    refuse(&field, NULL, GSCL_ERROR_FIELD, "at most 1048576");
}

/* Numbers at the ends of their range are packed, or refused with a message. */
static void test_extreme_numbers(void **state) {
    (void)state;
    static const float numbers[] = {0, 1e-45f, 1e-38f, 1e-10f, 0.4f, 1, 300, 1e5f, 1e10f, 3e38f};
    static const size_t fields[] = {offsetof(gscl_splat, x),
                                    offsetof(gscl_splat, y),
                                    offsetof(gscl_splat, sigma1),
                                    offsetof(gscl_splat, sigma2),
                                    offsetof(gscl_splat, theta),
                                    offsetof(gscl_splat, opacity),
                                    offsetof(gscl_splat, colour[0]),
                                    offsetof(gscl_splat, colour[2]),
                                    offsetof(gscl_splat, wave_x),
                                    offsetof(gscl_splat, wave_phase),
                                    offsetof(gscl_splat, wave_amplitude)};
    gscl_pack_settings settings = settings_for(GSCL_TARGET_AUTO, 0);
    settings.tolerance = 1;
    for (int round = 0; round < 400; round++) {
        gscl_field field = foreign_field((gscl_blend)(GSCL_BLEND_NORMALIZED + round % 3));
        synthetic_random_state = (uint32_t)round + 1;
        field.count = 12;
        for (int i = 0; i < 6; i++) {
            const float number = numbers[synthetic_random(10)] * (synthetic_random(3) == 0 ? -1.0f : 1.0f);
            memcpy((char *)&splats[synthetic_random(12)] + fields[synthetic_random(11)], &number, sizeof number);
        }
        uint8_t *bytes = NULL;
        size_t size = 0;
        gscl_pack_report report = {.struct_size = sizeof report};
        const gscl_result result = gscl_pack(context, &field, &settings, &bytes, &size, &report);
        assert_true(result == GSCL_OK || result == GSCL_ERROR_INVALID_ARGUMENT || result == GSCL_ERROR_FIELD);
        assert_true(result == GSCL_OK ? size > 0 : strlen(gscl_context_message(context)) > 10);
        gscl_free(bytes);
    }
}

static void test_bad_settings(void **state) {
    (void)state;
    const gscl_field field = foreign_field(GSCL_BLEND_SUM);
    gscl_pack_settings settings = settings_for(GSCL_TARGET_SSIMULACRA2, 50);
    refuse(&field, &settings, GSCL_ERROR_INVALID_ARGUMENT, "not for another target");
    settings = settings_for(GSCL_TARGET_BYTES, -1);
    refuse(&field, &settings, GSCL_ERROR_INVALID_ARGUMENT, "the target -1");
    settings = settings_for(GSCL_TARGET_BYTES, 12);
    refuse(&field, &settings, GSCL_ERROR_BUDGET_TOO_SMALL, "12 bytes is too small");
    settings.passes = false;
    refuse(&field, &settings, GSCL_ERROR_BUDGET_TOO_SMALL, "the smallest file of this field without passes has ");
    settings = settings_for(GSCL_TARGET_PSNR, 150);
    refuse(&field, &settings, GSCL_ERROR_TARGET_UNREACHABLE, "150.00 dB cannot be reached");
    settings = settings_for(GSCL_TARGET_AUTO, 0);
    settings.refine = 2;
    refuse(&field, &settings, GSCL_ERROR_CONFLICT, "to refine takes a target");
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, WIDTH, HEIGHT + 1, 3, GSCL_SAMPLE_U8);
    settings = settings_for(GSCL_TARGET_PSNR, 20);
    settings.reference = &image;
    refuse(&field, &settings, GSCL_ERROR_IMAGE_SIZE, "the reference has 96x73 pixels, the field 96x72");
    synthetic_image_free(&image);
}

static void test_covariances(void **state) {
    (void)state;
    for (int i = 0; i < 200; i++) {
        const double s1 = 0.1 + i % 13, s2 = 0.1 + i % 7, theta = (i % 31) / 10.0, c = cos(theta), n = sin(theta);
        gscl_splat s = {0};
        assert_true(gscl_splat_set_covariance(&s, c * c * s1 * s1 + n * n * s2 * s2, c * n * (s1 * s1 - s2 * s2),
                                              n * n * s1 * s1 + c * c * s2 * s2));
        assert_true(fabs(s.sigma1 - fmax(s1, s2)) < 1e-5 && fabs(s.sigma2 - fmin(s1, s2)) < 1e-5);
        const double direction = s1 >= s2 ? theta : theta + PI / 2;
        assert_true(i % 13 == i % 7 || fabs(sin(s.theta - direction)) < 1e-5);
        assert_true(s.theta >= 0 && s.theta <= 3.1416f);
    }
    gscl_splat s = {.sigma1 = 5};
    assert_false(gscl_splat_set_covariance(&s, 1, 1, 1));
    assert_false(gscl_splat_set_covariance(&s, -1, 0, 1));
    assert_false(gscl_splat_set_covariance(&s, NAN, 0, 1));
    assert_false(gscl_splat_set_covariance(&s, INFINITY, 0, 1));
    assert_true(s.sigma1 == 5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_arrays_are_all_of_a_picture),
        cmocka_unit_test(test_covariances),
    };
    const struct CMUnitTest encoder_tests[] = {
        cmocka_unit_test(test_fields_of_files_are_packed_again),
        cmocka_unit_test(test_files_are_packed_to_their_bytes),
        cmocka_unit_test(test_changed_fields_of_files),
        cmocka_unit_test(test_finest_steps),
        cmocka_unit_test(test_targets),
        cmocka_unit_test(test_refining_moves_splats),
        cmocka_unit_test(test_strong_colours_are_divided),
        cmocka_unit_test(test_centres_outside_the_picture),
        cmocka_unit_test(test_changes_are_within_the_tolerance),
        cmocka_unit_test(test_order_of_alpha),
        cmocka_unit_test(test_bad_numbers_name_their_splat),
        cmocka_unit_test(test_bad_fields),
        cmocka_unit_test(test_bad_settings),
        cmocka_unit_test(test_extreme_numbers),
    };
    JOIN_TESTS(tests);
    if (has_encoder())
        JOIN_TESTS(encoder_tests);
    return run_joined_tests(open_context, close_context);
}
