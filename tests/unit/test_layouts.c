/* The channels, their order and the order of rows that callers choose, in decodes and in encodes: swizzled samples are
 * those of the stored layout, mixed ones follow the formula of gscl.h, and rows from the bottom up are those of the
 * flipped image. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "every_decoder.h"
#include "joined_tests.h"
#include "synthetic_image.h"
#include "synthetic_scene.h"

/* Larger images than 65536 pixels are drawn by kernels, where the device "host" has them. */
enum { KINDS = 12, WIDTH = 200, HEIGHT = 45, SPLATS = 120, LARGE_WIDTH = 701, LARGE_HEIGHT = 99, GAP = 7 };
#define POISON 0xA7

static const float background[3] = {0.75f, 0.5f, 0.125f};
/* Places of red, green, blue and alpha in a pixel of each layout; -1: none.  Grey is in the place of red. */
static const int places[][4] = {
    [GSCL_LAYOUT_GREY] = {0, -1, -1, -1}, [GSCL_LAYOUT_GREY_ALPHA] = {0, -1, -1, 1}, [GSCL_LAYOUT_RGB] = {0, 1, 2, -1},
    [GSCL_LAYOUT_RGBA] = {0, 1, 2, 3},    [GSCL_LAYOUT_BGR] = {2, 1, 0, -1},         [GSCL_LAYOUT_BGRA] = {2, 1, 0, 3}};
static const uint32_t channels_of[] = {0, 1, 2, 3, 4, 3, 4};

typedef struct file {
    uint8_t *bytes;
    size_t size;
} file;

/* A file of a random kind; twelve numbers have all blends and layouts. */
static file file_of(int number) {
    const synthetic_kind kind = {WIDTH, HEIGHT, SPLATS, number % 2 ? GSF_CODING_CODEBOOK : GSF_CODING_SCALAR, false};
    file f = {NULL, 0};
    synthetic_random_state = 97 + (uint32_t)number;
    assert_int_equal(synthetic_file_of_kind(&kind, number, &f.bytes, &f.size), GSF_OK);
    return f;
}

static gscl_decode_settings settings_of(gscl_layout layout, gscl_sample sample, bool is_large) {
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.layout = layout;
    settings.sample = sample;
    memcpy(settings.background, background, sizeof background);
    settings.width = is_large ? LARGE_WIDTH : 0;
    settings.height = is_large ? LARGE_HEIGHT : 0;
    return settings;
}

static gscl_image decode(int which, const file *f, const gscl_decode_settings *settings) {
    gscl_image image = {0};
    if (gscl_decode(contexts[which], f->bytes, f->size, settings, &image) != GSCL_OK)
        fail_msg("%s: %s", decoder_names[which], gscl_context_message(contexts[which]));
    return image;
}

static size_t pixel_count(const gscl_image *image) {
    return (size_t)image->width * image->height;
}

/* ---- Swizzles ---- */

/* Whether the layout has all that is stored in one of `channels`. */
static bool keeps(gscl_layout layout, uint32_t channels) {
    return channels_of[layout] >= channels && !(channels == 2 && channels_of[layout] == 3);
}

/* Every sample of `image` is that of `stored`, which has the usual order; alpha that is not stored is 1. */
static void check_swizzle(const gscl_image *stored, const gscl_image *image) {
    const size_t size = synthetic_sample_size(stored->sample);
    const uint8_t *from = stored->pixels, *to = image->pixels;
    const int *out = places[image->layout], *in = places[stored->channels];
    for (size_t i = 0; i < pixel_count(stored); i++, from += stored->channels * size, to += image->channels * size)
        for (int k = 0; k < 4; k++) {
            const int place = in[k] < 0 && k < 3 ? in[0] : in[k];
            if (out[k] < 0)
                continue;
            if (place >= 0)
                assert_memory_equal(to + (size_t)out[k] * size, from + (size_t)place * size, size);
            else
                assert_true(synthetic_sample(image, i * image->channels + (size_t)out[k]) == 1.0);
        }
}

static void check_swizzles(int which, const file *f, gscl_sample sample, bool premultiplied, bool is_large) {
    gscl_decode_settings settings = settings_of(GSCL_LAYOUT_AUTO, sample, is_large);
    settings.premultiplied = premultiplied;
    gscl_image stored = decode(which, f, &settings);
    assert_int_equal(stored.layout, GSCL_LAYOUT_AUTO);
    for (gscl_layout layout = GSCL_LAYOUT_GREY; layout <= GSCL_LAYOUT_BGRA; layout++) {
        if (!keeps(layout, stored.channels))
            continue;
        settings.layout = layout;
        gscl_image image = decode(which, f, &settings);
        assert_true(image.channels == channels_of[layout] && image.layout == layout && image.sample == stored.sample);
        assert_true(image.premultiplied == premultiplied && image.stride == 0);
        check_swizzle(&stored, &image);
        gscl_free(image.pixels);
    }
    gscl_free(stored.pixels);
}

static void test_swizzles(void **state) {
    (void)state;
    for (int number = 0; number < KINDS; number++) {
        const file f = file_of(number);
        for (int which = 0; which < decoder_count; which++)
            for (gscl_sample sample = GSCL_SAMPLE_U8; sample <= GSCL_SAMPLE_F32; sample++) {
                check_swizzles(which, &f, sample, number % 2, false);
                check_swizzles(which, &f, sample, number % 2, true);
            }
        free(f.bytes);
    }
}

/* ---- Mixed samples ---- */

/* What the formula of gscl.h makes of a pixel of premultiplied RGBA: the samples of `layout`, straight or not. */
static void mix(const float rgba[4], gscl_layout layout, bool premultiplied, double samples[4]) {
    const int *out = places[layout];
    const bool has_alpha = out[3] >= 0;
    double rgb[3];
    for (int k = 0; k < 3; k++)
        rgb[k] = (double)rgba[k] + (has_alpha ? 0 : (1 - (double)rgba[3]) * (double)background[k]);
    const double grey = (rgb[0] + 2 * rgb[1] + rgb[2]) / 4, alpha = (double)rgba[3];
    const double divisor = !has_alpha || premultiplied ? 1 : alpha > 0 ? alpha : INFINITY;
    for (int k = 0; k < 3; k++)
        if (out[k] >= 0)
            samples[out[k]] = (out[1] < 0 ? grey : rgb[k]) / divisor;
    if (has_alpha)
        samples[out[3]] = alpha;
}

/* Samples are those of the formula, rounded once. */
static void check_mixed(const gscl_image *rgba, const gscl_image *image) {
    const double steps = image->sample == GSCL_SAMPLE_U8 ? 255 : image->sample == GSCL_SAMPLE_U16 ? 65535 : 0;
    const double allowed = (steps > 0 ? 0.5 / steps : 0) + 2e-6;
    for (size_t i = 0; i < pixel_count(image); i++) {
        double expected[4];
        mix((const float *)rgba->pixels + 4 * i, image->layout, image->premultiplied, expected);
        for (uint32_t k = 0; k < image->channels; k++) {
            const double found = synthetic_sample(image, i * image->channels + k);
            if (!(fabs(found - expected[k]) <= allowed))
                fail_msg("pixel %zu, channel %u of layout %d: %g; expected %g", i, k, (int)image->layout, found,
                         expected[k]);
        }
    }
}

static void check_all_layouts(int which, const file *f, bool premultiplied, bool is_large) {
    gscl_decode_settings settings = settings_of(GSCL_LAYOUT_RGBA, GSCL_SAMPLE_F32, is_large);
    settings.premultiplied = true;
    gscl_image rgba = decode(which, f, &settings);
    settings.premultiplied = premultiplied;
    for (settings.layout = GSCL_LAYOUT_GREY; settings.layout <= GSCL_LAYOUT_BGRA; settings.layout++)
        for (settings.sample = GSCL_SAMPLE_U8; settings.sample <= GSCL_SAMPLE_F32; settings.sample++) {
            gscl_image image = decode(which, f, &settings);
            check_mixed(&rgba, &image);
            gscl_free(image.pixels);
        }
    gscl_free(rgba.pixels);
}

static void test_mixed_samples(void **state) {
    (void)state;
    for (int number = 0; number < KINDS; number++) {
        const file f = file_of(number);
        for (int which = 0; which < decoder_count; which++) {
            check_all_layouts(which, &f, number % 8 < 4, false);
            check_all_layouts(which, &f, number % 8 < 4, true);
        }
        free(f.bytes);
    }
}

static void test_crops(void **state) {
    (void)state;
    for (int number = 0; number < 4; number++) {
        const file f = file_of(number);
        gscl_decode_settings settings = settings_of(GSCL_LAYOUT_BGR, GSCL_SAMPLE_U8, false);
        gscl_image whole = decode(HOST, &f, &settings);
        settings.crop_x = 61;
        settings.crop_y = 13;
        settings.crop_width = 130;
        settings.crop_height = 20;
        gscl_image part = decode(HOST, &f, &settings);
        for (uint32_t y = 0; y < part.height; y++)
            assert_memory_equal((uint8_t *)part.pixels + (size_t)y * part.width * 3,
                                (uint8_t *)whole.pixels + ((size_t)(y + 13) * WIDTH + 61) * 3, part.width * 3);
        gscl_free(whole.pixels);
        gscl_free(part.pixels);
        free(f.bytes);
    }
}

/* A decoder of pieces has the settings of a decode. */
static void test_decoder(void **state) {
    (void)state;
    const file f = file_of(3);
    const gscl_decode_settings settings = settings_of(GSCL_LAYOUT_BGR, GSCL_SAMPLE_U8, false);
    gscl_decoder *decoder = NULL;
    gscl_image expected = decode(HOST, &f, &settings), drawn = {0};
    assert_int_equal(gscl_decoder_create(&decoder, &settings), GSCL_OK);
    assert_int_equal(gscl_decoder_add_bytes(decoder, f.bytes, f.size), GSCL_OK);
    assert_int_equal(gscl_decoder_draw(decoder, contexts[HOST], &drawn), GSCL_OK);
    assert_true(drawn.layout == GSCL_LAYOUT_BGR && drawn.channels == 3);
    assert_memory_equal(drawn.pixels, expected.pixels, synthetic_sample_count(&expected));
    gscl_decoder_free(&decoder);
    gscl_free(expected.pixels);
    gscl_free(drawn.pixels);
    free(f.bytes);
}

/* ---- Rows from the bottom up ---- */

static void check_bottom_up(int which, const file *f, const gscl_decode_settings *settings) {
    gscl_image packed = decode(which, f, settings), image = packed;
    const size_t row = packed.width * packed.channels * synthetic_sample_size(packed.sample), stride = row + GAP;
    uint8_t *memory = malloc(stride * packed.height);
    assert_non_null(memory);
    memset(memory, POISON, stride * packed.height);
    image.stride = -(ptrdiff_t)stride;
    image.pixels = memory + stride * (packed.height - 1);
    image.layout = GSCL_LAYOUT_AUTO; /* whatever it is before */
    if (gscl_decode(contexts[which], f->bytes, f->size, settings, &image) != GSCL_OK)
        fail_msg("%s: %s", decoder_names[which], gscl_context_message(contexts[which]));
    assert_true(image.stride == -(ptrdiff_t)stride && image.layout == settings->layout);
    for (uint32_t y = 0; y < packed.height; y++) {
        const uint8_t *at = memory + stride * (packed.height - 1 - y);
        assert_memory_equal(at, (uint8_t *)packed.pixels + y * row, row);
        for (size_t i = row; i < stride; i++)
            assert_int_equal(at[i], POISON);
    }
    free(memory);
    gscl_free(packed.pixels);
}

static void test_bottom_up_rows(void **state) {
    (void)state;
    for (int number = 0; number < KINDS; number += 3) {
        const file f = file_of(number);
        for (int which = 0; which < decoder_count; which++)
            for (gscl_layout layout = GSCL_LAYOUT_AUTO; layout <= GSCL_LAYOUT_BGRA; layout++)
                for (int is_large = 0; is_large < 2; is_large++) {
                    const gscl_decode_settings settings = settings_of(layout, GSCL_SAMPLE_U8, is_large);
                    check_bottom_up(which, &f, &settings);
                }
        free(f.bytes);
    }
}

/* ---- Encoding ---- */

static void reorder(const gscl_image *from, gscl_layout layout, uint8_t *to) {
    const uint8_t *in = from->pixels;
    for (size_t i = 0; i < pixel_count(from); i++, in += from->channels, to += from->channels)
        for (int k = 0; k < 4; k++)
            if (places[layout][k] >= 0)
                to[places[layout][k]] = in[places[from->channels][k]];
}

static file encode(const gscl_image *image) {
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.effort = 0;
    settings.target = GSCL_TARGET_SPLATS;
    settings.target_value = 20;
    file f = {NULL, 0};
    if (gscl_encode(contexts[HOST], image, &settings, &f.bytes, &f.size, NULL) != GSCL_OK)
        fail_msg("%s", gscl_context_message(contexts[HOST]));
    return f;
}

static void check_same_file(const gscl_image *image, const gscl_image *other) {
    const file expected = encode(image), found = encode(other);
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    assert_int_equal(found.size, expected.size);
    assert_memory_equal(found.bytes, expected.bytes, expected.size);
    assert_int_equal(gscl_compare(image, other, &comparison), GSCL_OK);
    assert_true(comparison.mse == 0.0);
    gscl_free(expected.bytes);
    gscl_free(found.bytes);
}

static void check_encode_of(uint32_t channels, gscl_layout layout) {
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 40, 31, channels, GSCL_SAMPLE_U8), other = image;
    uint8_t memory[4 * 40 * 31];
    reorder(&image, layout, memory);
    other.pixels = memory;
    other.layout = layout;
    check_same_file(&image, &other);
    other.pixels = image.pixels; /* the order counts */
    const file right = encode(&image), wrong = encode(&other);
    assert_false(right.size == wrong.size && memcmp(right.bytes, wrong.bytes, right.size) == 0);
    gscl_free(right.bytes);
    gscl_free(wrong.bytes);
    synthetic_image_free(&image);
}

static void test_encode_layouts(void **state) {
    (void)state;
    check_encode_of(3, GSCL_LAYOUT_BGR);
    check_encode_of(4, GSCL_LAYOUT_BGRA);
}

static void test_encode_bottom_up(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 40, 31, 3, GSCL_SAMPLE_U8), flipped = image;
    const size_t row = 40 * 3, stride = row + GAP;
    uint8_t memory[(40 * 3 + GAP) * 31];
    for (size_t y = 0; y < 31; y++)
        memcpy(memory + (30 - y) * stride, (uint8_t *)image.pixels + y * row, row);
    flipped.pixels = memory + 30 * stride;
    flipped.stride = -(ptrdiff_t)stride;
    check_same_file(&image, &flipped);
    synthetic_image_free(&image);
}

/* ---- Refusals ---- */

static void refuse_decode(const file *f, const gscl_decode_settings *settings, gscl_image image, const char *why) {
    const void *pixels = image.pixels;
    gscl_decoder *decoder = NULL;
    assert_int_equal(gscl_decode(contexts[HOST], f->bytes, f->size, settings, &image), GSCL_ERROR_INVALID_ARGUMENT);
    assert_non_null(strstr(gscl_context_message(contexts[HOST]), why));
    assert_true(image.pixels == pixels);
    if (pixels)
        return;
    size_t memory;
    assert_int_equal(gscl_rows_memory(f->bytes, f->size, settings, 0, NULL, &memory), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decoder_create(&decoder, settings), GSCL_ERROR_INVALID_ARGUMENT);
    assert_null(decoder);
}

static void test_refused_decodes(void **state) {
    (void)state;
    static uint8_t memory[WIDTH * HEIGHT * 4];
    static const float bad[] = {-0.001f, 1.001f, NAN, INFINITY};
    const file f = file_of(2);
    const gscl_image none = {0};
    gscl_decode_settings settings = settings_of((gscl_layout)7, GSCL_SAMPLE_U8, false);
    refuse_decode(&f, &settings, none, "unknown layout 7; there are 0 to 6");
    for (int k = 0; k < 3; k++)
        for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
            settings = settings_of(GSCL_LAYOUT_RGB, GSCL_SAMPLE_U8, false);
            settings.background[k] = bad[i];
            refuse_decode(&f, &settings, none, "no colour of 0..1");
        }
    settings = settings_of(GSCL_LAYOUT_BGRA, GSCL_SAMPLE_U8, false);
    gscl_image mine = none;
    mine.width = WIDTH;
    mine.height = HEIGHT;
    mine.sample = GSCL_SAMPLE_U8;
    mine.pixels = memory + sizeof memory / 2;
    mine.channels = 3;
    refuse_decode(&f, &settings, mine, "with 3 channels, the decode gives 200x45 with 4");
    mine.channels = 4;
    mine.stride = -(WIDTH * 4 - 1);
    refuse_decode(&f, &settings, mine, "the stride of -799 bytes is shorter than a row of 800");
    free(f.bytes);
}

static void test_refused_images(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 8, 8, 3, GSCL_SAMPLE_U8), bad = image;
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    uint8_t *bytes = NULL;
    size_t size;
    static const gscl_layout layouts[] = {GSCL_LAYOUT_GREY, GSCL_LAYOUT_RGBA, GSCL_LAYOUT_BGRA, (gscl_layout)7};
    for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
        bad.layout = layouts[i];
        assert_int_equal(gscl_encode(contexts[HOST], &bad, NULL, &bytes, &size, NULL), GSCL_ERROR_INVALID_ARGUMENT);
        assert_non_null(strstr(gscl_context_message(contexts[HOST]), "of the image is none of 3 channels"));
        assert_int_equal(gscl_compare(&image, &bad, &comparison), GSCL_ERROR_INVALID_ARGUMENT);
    }
    bad = image;
    bad.stride = -23;
    assert_int_equal(gscl_encode(contexts[HOST], &bad, NULL, &bytes, &size, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_non_null(strstr(gscl_context_message(contexts[HOST]), "-23 bytes is shorter than a row, which has 24"));
    assert_int_equal(gscl_compare(&image, &bad, &comparison), GSCL_ERROR_INVALID_ARGUMENT);
    assert_null(bytes);
    synthetic_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_swizzles),       cmocka_unit_test(test_mixed_samples),
                                       cmocka_unit_test(test_crops),          cmocka_unit_test(test_decoder),
                                       cmocka_unit_test(test_bottom_up_rows), cmocka_unit_test(test_refused_decodes)};
    const struct CMUnitTest encoder_tests[] = {cmocka_unit_test(test_encode_layouts),
                                               cmocka_unit_test(test_encode_bottom_up),
                                               cmocka_unit_test(test_refused_images)};
    JOIN_TESTS(tests);
    if (has_native())
        JOIN_TESTS(encoder_tests);
    return run_joined_tests(open_contexts, close_contexts);
}
