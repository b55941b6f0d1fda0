/* The public API: results, messages, ownership, determinism, budgets. */
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

#include "decode/coded_image.h"
#include "one_context.h"
#include "synthetic_image.h"

/* ---- Helpers ---- */

typedef struct {
    uint8_t *bytes;
    size_t size;
} file;

static gscl_encode_settings quick(gscl_target target, double value) {
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.target = target;
    settings.target_value = value;
    settings.effort = 0;
    return settings;
}

static void assert_result(gscl_result result, gscl_result expected) {
    if (result != expected)
        fail_msg("%s (%s); expected: %s", gscl_result_text(result), gscl_context_message(context),
                 gscl_result_text(expected));
}

static file encode_file(const gscl_image *image, const gscl_encode_settings *settings) {
    file f = {NULL, 0};
    assert_result(gscl_encode(context, image, settings, &f.bytes, &f.size, NULL), GSCL_OK);
    return f;
}

/* Encodes a synthetic image into some splats. */
static file encode_some(synthetic_image_kind kind, uint32_t width, uint32_t height, uint32_t channels, double splats) {
    gscl_image image = synthetic_image(kind, width, height, channels, GSCL_SAMPLE_U8);
    const gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, splats);
    const file f = encode_file(&image, &settings);
    synthetic_image_free(&image);
    return f;
}

static gscl_image decode_file(const file *f, const gscl_decode_settings *settings) {
    gscl_image image = {0};
    assert_result(gscl_decode(context, f->bytes, f->size, settings, &image), GSCL_OK);
    return image;
}

/* A failed encode leaves its out-parameters unchanged and sets a message. */
static void refuse_encode(const gscl_image *image, const gscl_encode_settings *settings, gscl_result expected) {
    file f = {NULL, 77};
    assert_result(gscl_encode(context, image, settings, &f.bytes, &f.size, NULL), expected);
    assert_null(f.bytes);
    assert_int_equal(f.size, 77);
    assert_true(gscl_context_message(context)[0] != '\0');
}

static gscl_result try_decode(const uint8_t *bytes, size_t size) {
    gscl_image image = {0};
    const gscl_result result = gscl_decode(context, bytes, size, NULL, &image);
    if (result != GSCL_OK) {
        assert_null(image.pixels);
        assert_true(gscl_context_message(context)[0] != '\0');
    }
    gscl_free(image.pixels);
    return result;
}

/* ---- Defaults, texts, devices ---- */

static void test_defaults(void **state) {
    (void)state;
    gscl_encode_settings e;
    gscl_decode_settings d;
    gscl_context_settings c;
    memset(&e, 0x55, sizeof e);
    memset(&d, 0x55, sizeof d);
    memset(&c, 0x55, sizeof c);
    gscl_encode_settings_default(&e);
    gscl_decode_settings_default(&d);
    gscl_context_settings_default(&c);
    assert_true(e.profile == GSCL_PROFILE_DEFAULT && e.blend == GSCL_BLEND_AUTO && e.loss == GSCL_LOSS_AUTO);
    assert_true(e.tune == GSCL_TUNE_AUTO);
    assert_true(e.target == GSCL_TARGET_AUTO);
    assert_true(e.effort == 5 && e.codebook_size == 0 && e.seed == 1 && !e.progress);
    assert_true(d.width == 0 && d.height == 0 && d.crop_x == 0 && d.crop_y == 0 && d.crop_width == 0);
    assert_true(d.crop_height == 0 && d.sample == GSCL_SAMPLE_AUTO && !d.premultiplied);
    assert_true(d.layout == GSCL_LAYOUT_AUTO && d.background[0] + d.background[1] + d.background[2] == 0);
    assert_true(!c.device && c.mapping == GSCL_MAPPING_AUTO && !c.log);
    gscl_free(NULL);
    gscl_context *none = NULL;
    gscl_context_free(&none);
}

static void test_texts(void **state) {
    (void)state;
    for (int i = -3; i < 60; i++)
        assert_true(gscl_result_text((gscl_result)i) && gscl_result_text((gscl_result)i)[0]);
    assert_string_equal(gscl_version(), GSCL_VERSION);
    assert_string_equal(gscl_effect_name(GSCL_EFFECT_CHROMA), "chroma");
    assert_null(gscl_effect_name((gscl_effect)3));
}

static gscl_result try_device(const char *device) {
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = device;
    gscl_context *other = NULL;
    const gscl_result result = gscl_context_create(&other, &settings);
    if (result != GSCL_OK) {
        assert_non_null(other);
        assert_true(gscl_context_message(other)[0] != '\0');
    }
    gscl_context_free(&other);
    assert_null(other);
    return result;
}

/* Calls on a context whose creation failed are refused. */
static void test_context_without_a_device(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 16, 16, 3, GSCL_SAMPLE_U8), decoded = {0};
    const file f = encode_some(SYNTHETIC_SHAPES, 16, 16, 3, 4);
    gscl_context_settings settings;
    gscl_context *none = NULL;
    uint8_t *bytes = NULL;
    size_t size = 0;
    gscl_context_settings_default(&settings);
    settings.device = "no such device";
    assert_int_equal(gscl_context_create(&none, &settings), GSCL_ERROR_UNKNOWN_DEVICE);
    assert_int_equal(gscl_encode(none, &image, NULL, &bytes, &size, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_non_null(strstr(gscl_context_message(none), "gscl_context_create failed"));
    assert_null(bytes);
    assert_int_equal(gscl_decode(none, f.bytes, f.size, NULL, &decoded), GSCL_ERROR_INVALID_ARGUMENT);
    assert_non_null(strstr(gscl_context_message(none), "gscl_context_create failed"));
    assert_null(decoded.pixels);
    gscl_context_free(&none);
    gscl_free(f.bytes);
    synthetic_image_free(&image);
}

#ifndef GSCL_WITH_OPENCL
/* No package of the machine would help. */
static void test_built_without_opencl(void **state) {
    (void)state;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = "0.0";
    gscl_context *none = NULL;
    assert_int_equal(gscl_context_create(&none, &settings), GSCL_ERROR_NO_PLATFORM);
    assert_non_null(strstr(gscl_context_message(none), "built without OpenCL"));
    assert_null(strstr(gscl_context_message(none), "install"));
    gscl_context_free(&none);
}
#endif

static void test_devices(void **state) {
    (void)state;
    gscl_device_info *devices = NULL;
    size_t defaults = 0;
    assert_int_equal(gscl_list_devices(&devices), GSCL_OK);
    const gscl_device_info *own = gscl_context_device(context);
    for (const gscl_device_info *device = devices; device; device = device->next) {
        defaults += device->is_default;
        assert_true(device->is_default == (device->why_default[0] != '\0'));
        if (device->is_default && !test_device())
            assert_string_equal(device->id, own->id);
    }
    assert_int_equal(defaults, 1);
    assert_int_equal(try_device(own->id), GSCL_OK);
    assert_int_equal(try_device("no such device"), GSCL_ERROR_UNKNOWN_DEVICE);
    /* Numbers are those of OpenCL devices: where there are none, that is the error. */
    const gscl_result no_number =
        strcmp(devices->id, GSCL_HOST_DEVICE) == 0 ? GSCL_ERROR_NO_PLATFORM : GSCL_ERROR_UNKNOWN_DEVICE;
    assert_int_equal(try_device("99.0"), no_number);
    assert_int_equal(try_device("0.99"), no_number);
    /* The name of a platform with several devices is ambiguous. */
    for (const gscl_device_info *device = devices; device->next; device = device->next) {
        if (!strcmp(device->platform_name, device->next->platform_name))
            assert_int_equal(try_device(device->platform_name), GSCL_ERROR_AMBIGUOUS_DEVICE);
    }
    gscl_free(devices);
    assert_int_equal(gscl_context_create(NULL, NULL), GSCL_ERROR_INVALID_ARGUMENT);
}

/* ---- Bad images and settings ---- */

static void test_bad_images(void **state) {
    (void)state;
    const gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, 10);
    float pixels[4 * 4 * 3] = {0.5f, 0.25f};
    const gscl_image good = {.width = 4, .height = 4, .channels = 3, .sample = GSCL_SAMPLE_F32, .pixels = pixels};
    gscl_image bad = good;
    bad.width = 0;
    refuse_encode(&bad, &settings, GSCL_ERROR_IMAGE_SIZE);
    bad = good;
    bad.height = 0;
    refuse_encode(&bad, &settings, GSCL_ERROR_IMAGE_SIZE);
    bad.height = GSCL_MAX_DIMENSION + 1;
    refuse_encode(&bad, &settings, GSCL_ERROR_IMAGE_SIZE);
    bad = good;
    bad.pixels = NULL;
    refuse_encode(&bad, &settings, GSCL_ERROR_INVALID_ARGUMENT);
    refuse_encode(NULL, &settings, GSCL_ERROR_INVALID_ARGUMENT);
    for (uint32_t channels = 0; channels <= 5; channels += 5) {
        bad = good;
        bad.channels = channels;
        refuse_encode(&bad, &settings, GSCL_ERROR_INVALID_ARGUMENT);
    }
    bad = good;
    bad.sample = GSCL_SAMPLE_AUTO;
    refuse_encode(&bad, &settings, GSCL_ERROR_INVALID_ARGUMENT);
    bad.sample = (gscl_sample)9;
    refuse_encode(&bad, &settings, GSCL_ERROR_INVALID_ARGUMENT);
    bad = good;
    bad.stride = 4 * 3 * sizeof(float) - 1;
    refuse_encode(&bad, &settings, GSCL_ERROR_INVALID_ARGUMENT);
    const float wrong[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        pixels[47] = wrong[i];
        refuse_encode(&good, &settings, GSCL_ERROR_IMAGE_NOT_FINITE);
    }
}

static void test_null_arguments(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 16, 16, 3, GSCL_SAMPLE_U8);
    const file f = encode_some(SYNTHETIC_SHAPES, 16, 16, 3, 4);
    uint8_t *bytes = NULL;
    size_t size = 0;
    gscl_info info = {.struct_size = sizeof info};
    gscl_field field = {.struct_size = sizeof field};
    assert_int_equal(gscl_encode(NULL, &image, NULL, &bytes, &size, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_encode(context, &image, NULL, NULL, &size, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_non_null(strstr(gscl_context_message(context), "no place for the bytes"));
    assert_int_equal(gscl_encode(context, &image, NULL, &bytes, NULL, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decode(NULL, f.bytes, f.size, NULL, &image), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decode(context, NULL, f.size, NULL, &image), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_decode(context, f.bytes, f.size, NULL, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_non_null(strstr(gscl_context_message(context), "no image to decode"));
    assert_int_equal(gscl_probe(NULL, 9, NULL, &info), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_probe(f.bytes, f.size, NULL, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_inspect(f.bytes, f.size, NULL, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_read_field(f.bytes, f.size, NULL, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_read_field(NULL, f.size, NULL, &field), GSCL_ERROR_INVALID_ARGUMENT);
    gscl_free(f.bytes);
    synthetic_image_free(&image);
}

static void test_bad_settings(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 16, 16, 3, GSCL_SAMPLE_U8);
    const double values[] = {-1.0, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        for (int target = GSCL_TARGET_BPP; target <= GSCL_TARGET_SPLATS; target++) {
            const gscl_encode_settings s = quick((gscl_target)target, values[i]);
            refuse_encode(&image, &s, GSCL_ERROR_INVALID_ARGUMENT);
        }
    }
    const gscl_encode_settings many = quick(GSCL_TARGET_SPLATS, GSCL_MAX_SPLATS + 1.0);
    refuse_encode(&image, &many, GSCL_ERROR_INVALID_ARGUMENT);
    gscl_encode_settings bad[9];
    for (int i = 0; i < 9; i++)
        bad[i] = quick(GSCL_TARGET_SPLATS, 4);
    bad[0].effort = -1;
    bad[1].effort = GSCL_MAX_EFFORT + 1;
    bad[2].profile = (gscl_profile)2;
    bad[3].blend = (gscl_blend)4;
    bad[4].loss = (gscl_loss)4;
    bad[5].target = (gscl_target)(GSCL_TARGET_RATE + 1);
    bad[6].profile = bad[7].profile = GSCL_PROFILE_PAPER;
    bad[6].codebook_size = 1;
    bad[7].codebook_size = 1025;
    bad[8].tune = (gscl_tune)4;
    for (int i = 0; i < 9; i++)
        refuse_encode(&image, &bad[i], GSCL_ERROR_INVALID_ARGUMENT);
    gscl_encode_settings conflict = quick(GSCL_TARGET_SPLATS, 4);
    conflict.codebook_size = 16;
    refuse_encode(&image, &conflict, GSCL_ERROR_CONFLICT);
    conflict = quick(GSCL_TARGET_SPLATS, 4);
    conflict.profile = GSCL_PROFILE_PAPER;
    conflict.blend = GSCL_BLEND_SUM;
    refuse_encode(&image, &conflict, GSCL_ERROR_CONFLICT);
    conflict = quick(GSCL_TARGET_SPLATS, 4);
    conflict.tune = GSCL_TUNE_SSIM;
    conflict.loss = GSCL_LOSS_L1;
    refuse_encode(&image, &conflict, GSCL_ERROR_CONFLICT);
    conflict.loss = GSCL_LOSS_AUTO;
    conflict.profile = GSCL_PROFILE_PAPER;
    refuse_encode(&image, &conflict, GSCL_ERROR_CONFLICT);
    synthetic_image_free(&image);
}

/* ---- Bad files ---- */

static void test_not_gscl(void **state) {
    (void)state;
    static const uint8_t png[] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
    const file f = encode_some(SYNTHETIC_SHAPES, 16, 16, 3, 4);
    assert_result(try_decode(png, sizeof png), GSCL_ERROR_NOT_GSCL);
    assert_result(try_decode(png, 0), GSCL_ERROR_NOT_GSCL);
    f.bytes[4] = 3;
    assert_result(try_decode(f.bytes, f.size), GSCL_ERROR_NEWER_VERSION);
    f.bytes[4] = 1;
    assert_result(try_decode(f.bytes, f.size), GSCL_ERROR_NOT_GSCL);
    gscl_free(f.bytes);
}

static void test_every_truncation(void **state) {
    (void)state;
    const file f = encode_some(SYNTHETIC_SHAPES, 40, 30, 3, 25);
    size_t damaged = 0;
    for (size_t size = 0; size < f.size; size++) {
        /* The copy has exactly that size, so that a sanitizer detects reads beyond it. */
        uint8_t *cut = malloc(size ? size : 1);
        assert_non_null(cut);
        memcpy(cut, f.bytes, size);
        const gscl_result result = try_decode(cut, size);
        /* A cut payload may decode to something shorter: then the result is GSCL_ERROR_DAMAGED. */
        damaged += result == GSCL_ERROR_DAMAGED;
        if (result != GSCL_ERROR_DAMAGED)
            assert_result(result, size < 4 ? GSCL_ERROR_NOT_GSCL : GSCL_ERROR_TRUNCATED);
        free(cut);
    }
    assert_true(damaged <= f.size / 10);
    gscl_free(f.bytes);
}

static void test_every_flipped_byte(void **state) {
    (void)state;
    const file f = encode_some(SYNTHETIC_SHAPES, 40, 30, 4, 20);
    for (size_t i = 0; i < f.size; i++) {
        for (int change = 1; change < 256; change += i < 12 ? 1 : 23) {
            f.bytes[i] ^= (uint8_t)change;
            const gscl_result result = try_decode(f.bytes, f.size);
            if (result < GSCL_ERROR_NOT_GSCL || result > GSCL_ERROR_DAMAGED)
                fail_msg("byte %zu changed by %d: %s", i, change, gscl_result_text(result));
            f.bytes[i] ^= (uint8_t)change;
        }
    }
    assert_result(try_decode(f.bytes, f.size), GSCL_OK);
    gscl_free(f.bytes);
}

/* ---- Budgets ---- */

/* The last number in the message. */
static size_t number_in_message(void) {
    const char *text = gscl_context_message(context);
    size_t last = 0;
    while (*text) {
        char *end;
        const unsigned long value = strtoul(text, &end, 10);
        if (end == text)
            end++;
        else
            last = value;
        text = end;
    }
    return last;
}

/* Every target takes the values of its range and refuses those beyond it. */
static void test_ranges_of_targets(void **state) {
    (void)state;
    static const struct {
        gscl_target target;
        double least, most;
        const char *range;
    } targets[] = {{GSCL_TARGET_BPP, 0, GSCL_MAX_TARGET_BPP, " bits per pixel is not in 0..100000000"},
                   {GSCL_TARGET_BYTES, 0, GSCL_MAX_TARGET_BYTES, " bytes is not in 0..4294967295"},
                   {GSCL_TARGET_PSNR, 0, GSCL_MAX_TARGET_PSNR, " dB is not in 0..200"},
                   {GSCL_TARGET_SPLATS, 0, GSCL_MAX_SPLATS, " splats is not in 0..1048576"},
                   {GSCL_TARGET_SSIMULACRA2, GSCL_MIN_SSIMULACRA2, 100, " of SSIMULACRA 2 is not in -100..100"}};
    gscl_image image = synthetic_image(SYNTHETIC_FLAT, 16, 16, 3, GSCL_SAMPLE_U8);
    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
        const double least = targets[i].least, most = targets[i].most;
        const double beyond[] = {least - 0.01, most + 0.01, -1e12, 1e12, NAN, INFINITY, -INFINITY};
        const bool has_bytes = targets[i].target == GSCL_TARGET_BPP || targets[i].target == GSCL_TARGET_BYTES;
        gscl_encode_settings settings = quick(targets[i].target, most);
        const file f = encode_file(&image, &settings);
        gscl_free(f.bytes);
        settings.target_value = least;
        if (has_bytes) /* no file has 0 */
            refuse_encode(&image, &settings, GSCL_ERROR_BUDGET_TOO_SMALL);
        for (size_t k = 0; k < sizeof beyond / sizeof *beyond; k++) {
            settings.target_value = beyond[k];
            refuse_encode(&image, &settings, GSCL_ERROR_INVALID_ARGUMENT);
            assert_non_null(strstr(gscl_context_message(context), targets[i].range));
        }
    }
    synthetic_image_free(&image);
}

/* More bytes than an image can use change nothing, neither the file nor the work. */
static void check_useless_bytes(uint32_t side, gscl_profile profile, int effort) {
    static const double budgets[] = {1e5, 1e7, GSCL_MAX_TARGET_BYTES};
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, side, side, 3, GSCL_SAMPLE_U8);
    gscl_encode_settings settings = quick(GSCL_TARGET_BYTES, budgets[0]);
    settings.profile = profile;
    settings.effort = effort;
    const file first = encode_file(&image, &settings);
    for (size_t i = 1; i < sizeof budgets / sizeof *budgets; i++) {
        settings.target_value = budgets[i];
        const file f = encode_file(&image, &settings);
        assert_int_equal(f.size, first.size);
        assert_memory_equal(f.bytes, first.bytes, first.size);
        gscl_free(f.bytes);
    }
    gscl_free(first.bytes);
    synthetic_image_free(&image);
}

static void test_bytes_beyond_those_of_use(void **state) {
    (void)state;
    check_useless_bytes(16, GSCL_PROFILE_DEFAULT, 3);
    check_useless_bytes(16, GSCL_PROFILE_PAPER, 3);
    check_useless_bytes(64, GSCL_PROFILE_DEFAULT, 1);
    check_useless_bytes(64, GSCL_PROFILE_PAPER, 0);
}

static void check_smallest_budget(synthetic_image_kind kind, uint32_t channels, gscl_sample sample) {
    gscl_image image = synthetic_image(kind, 30, 20, channels, sample);
    gscl_encode_settings settings = quick(GSCL_TARGET_BYTES, 1);
    refuse_encode(&image, &settings, GSCL_ERROR_BUDGET_TOO_SMALL);
    const size_t smallest = number_in_message();
    assert_in_range(smallest, 9, 22);
    settings.target_value = (double)smallest - 1.0;
    refuse_encode(&image, &settings, GSCL_ERROR_BUDGET_TOO_SMALL);
    settings.target_value = (double)smallest;
    const file f = encode_file(&image, &settings);
    assert_true(f.size <= smallest);
    assert_result(try_decode(f.bytes, f.size), GSCL_OK);
    gscl_free(f.bytes);
    synthetic_image_free(&image);
}

static void test_smallest_budget(void **state) {
    (void)state;
    for (uint32_t channels = 1; channels <= 4; channels++) {
        check_smallest_budget(SYNTHETIC_SHAPES, channels, GSCL_SAMPLE_U8);
        check_smallest_budget(SYNTHETIC_NOISE, channels, GSCL_SAMPLE_U16);
        check_smallest_budget(SYNTHETIC_FLAT, channels, GSCL_SAMPLE_U8);
    }
}

/* Sizes of the files for a budget: never above it. */
static size_t encode_within(const gscl_image *image, size_t budget) {
    const gscl_encode_settings settings = quick(GSCL_TARGET_BYTES, (double)budget);
    gscl_encode_report report = {.struct_size = sizeof report};
    file f = {NULL, 0};
    assert_result(gscl_encode(context, image, &settings, &f.bytes, &f.size, &report), GSCL_OK);
    assert_int_equal(report.bytes, f.size);
    if (f.size > budget)
        fail_msg("%zu bytes for a budget of %zu", f.size, budget);
    assert_result(try_decode(f.bytes, f.size), GSCL_OK);
    gscl_free(f.bytes);
    return f.size;
}

static void test_tiny_budgets(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 33, 29, 3, GSCL_SAMPLE_U8);
    for (size_t budget = 20; budget < 80; budget += 4)
        (void)encode_within(&image, budget);
    synthetic_image_free(&image);
    gscl_image icon = synthetic_image(SYNTHETIC_SHAPES, 64, 64, 3, GSCL_SAMPLE_U8);
    (void)encode_within(&icon, 48);
    synthetic_image_free(&icon);
}

static void test_budgets_are_used(void **state) {
    (void)state;
    static const size_t budgets[] = {150, 300, 777, 1500};
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 120, 100, 3, GSCL_SAMPLE_U8);
    for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
        const size_t size = encode_within(&image, budgets[i]);
        if ((double)size < 0.97 * (double)budgets[i])
            fail_msg("only %zu bytes of a budget of %zu", size, budgets[i]);
    }
    synthetic_image_free(&image);
}

static void test_bits_per_pixel(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 80, 70, 3, GSCL_SAMPLE_U8);
    const gscl_encode_settings settings = quick(GSCL_TARGET_BPP, 0.6);
    const file f = encode_file(&image, &settings);
    assert_in_range(f.size, 0.97 * 0.6 * 80 * 70 / 8, 0.6 * 80 * 70 / 8);
    gscl_free(f.bytes);
    synthetic_image_free(&image);
}

static void test_psnr(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 160, 90, 3, GSCL_SAMPLE_U8);
    gscl_encode_settings settings = quick(GSCL_TARGET_PSNR, 22.0);
    gscl_encode_report report = {.struct_size = sizeof report};
    file f = {NULL, 0};
    assert_result(gscl_encode(context, &image, &settings, &f.bytes, &f.size, &report), GSCL_OK);
    if (report.psnr < 22.0 || report.psnr > 22.3)
        fail_msg("the PSNR is %g dB, 22 to 22.3 dB expected", report.psnr);
    gscl_image decoded = decode_file(&f, NULL);
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    assert_int_equal(gscl_compare(&image, &decoded, &comparison), GSCL_OK);
    assert_true(fabs(comparison.psnr - report.psnr) < 1e-6);
    gscl_free(decoded.pixels);
    gscl_free(f.bytes);
    synthetic_image_free(&image);
    image = synthetic_image(SYNTHETIC_NOISE, 16, 16, 3, GSCL_SAMPLE_U8);
    settings.target_value = 90.0;
    refuse_encode(&image, &settings, GSCL_ERROR_TARGET_UNREACHABLE);
    synthetic_image_free(&image);
}

/* The score of the report is that of the decoded file, for images of all kinds. */
static void check_ssimulacra2(uint32_t channels, gscl_sample sample, double target) {
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 160, 90, channels, sample);
    const gscl_encode_settings settings = quick(GSCL_TARGET_SSIMULACRA2, target);
    gscl_encode_report report = {.struct_size = sizeof report};
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    file f = {NULL, 0};
    assert_result(gscl_encode(context, &image, &settings, &f.bytes, &f.size, &report), GSCL_OK);
    /* Of so small a picture files of neighbouring sizes differ by several points. */
    if (!(report.ssimulacra2 >= target && report.ssimulacra2 <= target + 8))
        fail_msg("the score is %g, %g to %g expected", report.ssimulacra2, target, target + 8);
    gscl_image decoded = decode_file(&f, NULL);
    assert_int_equal(gscl_compare(&image, &decoded, &comparison), GSCL_OK);
    if (sample != GSCL_SAMPLE_F32) /* which is decoded to 16 bits here */
        assert_true(fabs(comparison.ssimulacra2 - report.ssimulacra2) < 1e-6);
    assert_true(comparison.ssimulacra2 > target - 0.1);
    gscl_free(decoded.pixels);
    gscl_free(f.bytes);
    synthetic_image_free(&image);
}

static void test_ssimulacra2(void **state) {
    (void)state;
    for (uint32_t channels = 1; channels <= 4; channels++)
        check_ssimulacra2(channels, GSCL_SAMPLE_U8, 20);
    check_ssimulacra2(3, GSCL_SAMPLE_U16, 30);
    check_ssimulacra2(3, GSCL_SAMPLE_F32, -20);
}

static void test_refused_ssimulacra2(void **state) {
    (void)state;
    const double invalid[] = {NAN, INFINITY, -INFINITY, 100.5, GSCL_MIN_SSIMULACRA2 - 1};
    gscl_image image = synthetic_image(SYNTHETIC_NOISE, 16, 16, 3, GSCL_SAMPLE_U8);
    gscl_encode_settings settings = quick(GSCL_TARGET_SSIMULACRA2, 99.9);
    refuse_encode(&image, &settings, GSCL_ERROR_TARGET_UNREACHABLE);
    assert_non_null(strstr(gscl_context_message(context), "99.90 cannot be reached; the best found is "));
    for (size_t i = 0; i < sizeof invalid / sizeof *invalid; i++) {
        settings.target_value = invalid[i];
        refuse_encode(&image, &settings, GSCL_ERROR_INVALID_ARGUMENT);
    }
    synthetic_image_free(&image);
    image = synthetic_image(SYNTHETIC_FLAT, 7, 40, 3, GSCL_SAMPLE_U8);
    settings.target_value = 10;
    refuse_encode(&image, &settings, GSCL_ERROR_TARGET_UNREACHABLE);
    assert_non_null(strstr(gscl_context_message(context), "7x40"));
    synthetic_image_free(&image);
}

/* A quality stands for a score, or for a PSNR where an image is too small for one; the best file is the result where it cannot be
 * reached. */
static void test_quality(void **state) {
    (void)state;
    const struct {
        synthetic_image_kind kind;
        uint32_t width, height;
        double quality, least; /* least: score, or PSNR of small images */
    } cases[] = {{SYNTHETIC_TEXTURE, 160, 90, 40, 40}, {SYNTHETIC_TEXTURE, 160, 90, 21, 6},
                 {SYNTHETIC_TEXTURE, 160, 90, 0, -50}, {SYNTHETIC_NOISE, 16, 16, 100, 60},
                 {SYNTHETIC_TEXTURE, 7, 40, 20, 25},   {SYNTHETIC_FLAT, 7, 40, 100, 45}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        gscl_image image = synthetic_image(cases[i].kind, cases[i].width, cases[i].height, 3, GSCL_SAMPLE_U8);
        const gscl_encode_settings settings = quick(GSCL_TARGET_QUALITY, cases[i].quality);
        gscl_encode_report report = {.struct_size = sizeof report};
        file f = {NULL, 0};
        assert_result(gscl_encode(context, &image, &settings, &f.bytes, &f.size, &report), GSCL_OK);
        const double found = cases[i].width < 8 ? report.psnr : report.ssimulacra2;
        if (!(found >= cases[i].least) || (i < 3 && found > cases[i].least + 8))
            fail_msg("quality %g has %g, %g expected", cases[i].quality, found, cases[i].least);
        gscl_free(f.bytes);
        synthetic_image_free(&image);
    }
}

static void test_refused_quality(void **state) {
    (void)state;
    const double invalid[] = {NAN, INFINITY, -1, 100.5};
    gscl_image image = synthetic_image(SYNTHETIC_NOISE, 16, 16, 3, GSCL_SAMPLE_U8);
    gscl_encode_settings settings = quick(GSCL_TARGET_QUALITY, 0);
    for (size_t i = 0; i < sizeof invalid / sizeof *invalid; i++) {
        settings.target_value = invalid[i];
        refuse_encode(&image, &settings, GSCL_ERROR_INVALID_ARGUMENT);
    }
    synthetic_image_free(&image);
}

/* A flat image is equal to its background.  A score that is no target is not measured. */
static void test_ssimulacra2_of_flat_images(void **state) {
    (void)state;
    const gscl_target targets[] = {GSCL_TARGET_SSIMULACRA2, GSCL_TARGET_PSNR, GSCL_TARGET_AUTO};
    gscl_image image = synthetic_image(SYNTHETIC_FLAT, 30, 20, 3, GSCL_SAMPLE_U8);
    for (int i = 0; i < 3; i++) {
        const gscl_encode_settings settings = quick(targets[i], targets[i] == GSCL_TARGET_AUTO ? 0 : 100);
        gscl_encode_report report = {.struct_size = sizeof report};
        file f = {NULL, 0};
        assert_result(gscl_encode(context, &image, &settings, &f.bytes, &f.size, &report), GSCL_OK);
        assert_true(i == 0 ? report.ssimulacra2 == 100 : isnan(report.ssimulacra2));
        gscl_free(f.bytes);
    }
    synthetic_image_free(&image);
}

/* The default target suffices for an icon. */
static void test_default_target(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {2, 1}, {96, 64}, {192, 128}};
    for (int i = 0; i < 4; i++) {
        gscl_image image = synthetic_image(SYNTHETIC_SHAPES, sizes[i][0], sizes[i][1], 3, GSCL_SAMPLE_U8);
        const file f = encode_file(&image, NULL);
        assert_in_range(f.size, 1, i < 3 ? 256 : 384);
        gscl_free(f.bytes);
        synthetic_image_free(&image);
    }
}

/* ---- Backgrounds ---- */

/* Whether the file of an image leaves the background to the mean of its splats; otherwise its red or grey. */
static bool has_mean_background(const gscl_image *image, const gscl_encode_settings *settings, unsigned *red) {
    gscl_coded_image coded;
    const file f = encode_file(image, settings);
    assert_result(gscl_coded_image_read(&coded, f.bytes, f.size, false), GSCL_OK);
    const bool mean = coded.file.has_mean_background;
    *red = coded.file.background[0];
    gscl_coded_image_free(&coded);
    gscl_free(f.bytes);
    return mean;
}

static void check_background(synthetic_image_kind kind, uint32_t channels, double splats, gscl_blend blend,
                             bool expected) {
    gscl_image image = synthetic_image(kind, 60, 40, channels, GSCL_SAMPLE_U8);
    gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, splats);
    unsigned red;
    settings.blend = blend;
    assert_int_equal(has_mean_background(&image, &settings, &red), expected);
    synthetic_image_free(&image);
}

/* The blend normalized alone hides a background, where there are splats enough. */
static void test_background_of_textures(void **state) {
    (void)state;
    check_background(SYNTHETIC_TEXTURE, 3, 20, GSCL_BLEND_NORMALIZED, true);
    check_background(SYNTHETIC_TEXTURE, 4, 20, GSCL_BLEND_NORMALIZED, true);
    check_background(SYNTHETIC_TEXTURE, 1, 4, GSCL_BLEND_NORMALIZED, true);
    check_background(SYNTHETIC_TEXTURE, 3, 3, GSCL_BLEND_NORMALIZED, false);
    check_background(SYNTHETIC_TEXTURE, 3, 20, GSCL_BLEND_ALPHA, false);
    check_background(SYNTHETIC_TEXTURE, 3, 20, GSCL_BLEND_SUM, false);
    check_background(SYNTHETIC_FLAT, 3, 20, GSCL_BLEND_NORMALIZED, false);
}

/* A flat area keeps its exact colour. */
static void test_background_of_drawings(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_FLAT, 60, 40, 3, GSCL_SAMPLE_U8);
    const gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, 20);
    uint8_t *pixels = image.pixels;
    unsigned red;
    for (int i = 0; i < 60 * 40 * 3; i++)
        pixels[i] = i % (60 * 3) < 15 * 3 ? (uint8_t)(i * i * 31 >> 4) : 201;
    assert_false(has_mean_background(&image, &settings, &red));
    assert_in_range(red, 200, 202);
    synthetic_image_free(&image);
}

/* ---- Textures ---- */

/* A wave of 3 pixels in a round window of 30 stripes, more than the splats of a small file can represent one by one. */
static gscl_image striped_image(void) {
    gscl_image image = synthetic_image(SYNTHETIC_FLAT, 192, 144, 1, GSCL_SAMPLE_U8);
    uint8_t *pixels = image.pixels;
    for (int y = 0; y < 144; y++) {
        for (int x = 0; x < 192; x++) {
            const double window = exp(-((x - 96.0) * (x - 96.0) + (y - 72.0) * (y - 72.0)) / 2400.0);
            pixels[192 * y + x] = (uint8_t)(128.0 + 100.0 * window * cos(1.9 * x + 1.0 * y));
        }
    }
    return image;
}

/* The PSNR of a file of at most `bytes` bytes. */
static double psnr_of(const gscl_image *image, size_t bytes, int effort, uint64_t seed, uint32_t *effects) {
    gscl_encode_settings settings = quick(GSCL_TARGET_BYTES, (double)bytes);
    gscl_encode_report report = {.struct_size = sizeof report};
    gscl_info info = {.struct_size = sizeof info};
    file f = {NULL, 0};
    settings.effort = effort;
    settings.seed = seed;
    assert_result(gscl_encode(context, image, &settings, &f.bytes, &f.size, &report), GSCL_OK);
    assert_int_equal(gscl_probe(f.bytes, f.size, NULL, &info), GSCL_OK);
    assert_true(f.size <= bytes);
    *effects = info.effects;
    gscl_free(f.bytes);
    return report.psnr;
}

/* Stripes benefit from textures, but a fit of so few splats finds them from one seed in four or five.  The lowest effort does
 * not search for them. */
static void test_textures(void **state) {
    (void)state;
    uint32_t effects;
    gscl_image stripes = striped_image();
    double without = 0, with = 0;
    for (uint64_t seed = 1; seed <= 24 && with == 0; seed++) {
        without = fmax(without, psnr_of(&stripes, 300, 0, seed, &effects));
        assert_false(effects & GSCL_EFFECT_TEXTURE);
        const double found = psnr_of(&stripes, 300, 5, seed, &effects);
        if (effects & GSCL_EFFECT_TEXTURE)
            with = fmax(with, found);
    }
    if (!(with > without + 3.0))
        fail_msg("%.2f dB with textures, %.2f dB without", with, without);
    synthetic_image_free(&stripes);
}

/* Too few splats for the stripes may be worse than none. */
static void test_few_splats_are_no_worse_than_none(void **state) {
    (void)state;
    uint32_t effects;
    gscl_image stripes = striped_image();
    for (uint64_t seed = 1; seed <= 4; seed++) {
        const double flat = psnr_of(&stripes, 20, 0, seed, &effects), few = psnr_of(&stripes, 90, 5, seed, &effects);
        if (!(few > flat - 0.01))
            fail_msg("%.2f dB in 90 bytes, %.2f dB without splats", few, flat);
    }
    synthetic_image_free(&stripes);
}

/* ---- Flat and long images ---- */

static void test_flat_images(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {50, 40}, {16384, 2}};
    for (int i = 0; i < 24; i++) {
        const gscl_sample sample = i / 12 ? GSCL_SAMPLE_U16 : GSCL_SAMPLE_U8;
        gscl_image image =
            synthetic_image(SYNTHETIC_FLAT, sizes[i % 3][0], sizes[i % 3][1], 1 + (uint32_t)(i / 3 % 4), sample);
        const gscl_encode_settings settings = quick(GSCL_TARGET_BYTES, 24);
        const file f = encode_file(&image, &settings);
        assert_in_range(f.size, 1, 24);
        gscl_image decoded = decode_file(&f, NULL);
        assert_int_equal(decoded.channels, image.channels);
        assert_int_equal(decoded.sample, image.sample);
        /* Colours are stored premultiplied by alpha: where alpha is below 1 they may differ by a step. */
        const double step = image.channels % 2 ? 0.0 : 1.01 / (i / 12 ? 65535.0 : 255.0);
        for (size_t s = 0; s < synthetic_sample_count(&image); s++) {
            const bool is_alpha = s % image.channels == image.channels - 1;
            assert_true(fabs(synthetic_sample(&decoded, s) - synthetic_sample(&image, s)) <= (is_alpha ? 0.0 : step));
        }
        gscl_free(decoded.pixels);
        gscl_free(f.bytes);
        synthetic_image_free(&image);
    }
}

static void test_long_images(void **state) {
    (void)state;
    for (int tall = 0; tall < 2; tall++) {
        const uint32_t width = tall ? 1 : GSCL_MAX_DIMENSION, height = tall ? GSCL_MAX_DIMENSION : 1;
        const file f = encode_some(SYNTHETIC_GRADIENT, width, height, 3, 20);
        gscl_image image = synthetic_image(SYNTHETIC_GRADIENT, width, height, 3, GSCL_SAMPLE_U8),
                   decoded = decode_file(&f, NULL);
        gscl_comparison comparison = {.struct_size = sizeof comparison};
        assert_int_equal(gscl_compare(&image, &decoded, &comparison), GSCL_OK);
        if (!(comparison.psnr > 18.0))
            fail_msg("%ux%u: %g dB", width, height, comparison.psnr);
        gscl_free(decoded.pixels);
        gscl_free(f.bytes);
        synthetic_image_free(&image);
    }
}

/* ---- Progress, determinism ---- */

typedef struct {
    int calls, allowed;
    double last;
    bool has_ended;
} watch;

static bool on_progress(void *opaque, const gscl_progress *progress) {
    watch *w = opaque;
    assert_true(progress->fraction >= w->last && progress->fraction <= 1.0);
    assert_true(progress->elapsed_s >= 0.0 && progress->remaining_s >= 0.0);
    assert_false(w->has_ended); /* nothing remains after the call that says so */
    w->has_ended = progress->remaining_s == 0.0;
    assert_true(w->has_ended == (progress->fraction == 1.0));
    w->last = progress->fraction;
    return w->calls++ < w->allowed;
}

static void check_progress_and_cancel(int effort) {
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 64, 64, 3, GSCL_SAMPLE_U8);
    gscl_encode_settings settings = quick(GSCL_TARGET_BYTES, 300);
    settings.effort = effort;
    watch w = {0, 1000000, 0.0, false};
    settings.progress = on_progress;
    settings.progress_opaque = &w;
    file f = encode_file(&image, &settings);
    gscl_free(f.bytes);
    const int calls = w.calls;
    assert_true(calls > 1 && w.has_ended);
    for (int allowed = 0; allowed < calls; allowed += 1 + calls / 3) {
        w = (watch){0, allowed, 0.0, false};
        refuse_encode(&image, &settings, GSCL_ERROR_CANCELLED);
        assert_int_equal(w.calls, allowed + 1);
    }
    settings.progress = NULL;
    f = encode_file(&image, &settings);
    gscl_free(f.bytes);
    synthetic_image_free(&image);
}

static void test_progress_and_cancel(void **state) {
    (void)state;
    check_progress_and_cancel(0);
    check_progress_and_cancel(3); /* small files are searched */
}

static void watch_encode(synthetic_image_kind kind, gscl_encode_settings settings) {
    gscl_image image = synthetic_image(kind, 64, 64, 3, GSCL_SAMPLE_U8);
    watch w = {0, 1000000, 0.0, false};
    settings.progress = on_progress;
    settings.progress_opaque = &w;
    const file f = encode_file(&image, &settings);
    assert_true(w.has_ended);
    gscl_free(f.bytes);
    synthetic_image_free(&image);
}

/* Encodes that end in other ways than a single fit. */
static void test_end_of_progress(void **state) {
    (void)state;
    gscl_encode_settings settings = quick(GSCL_TARGET_PSNR, 25);
    watch_encode(SYNTHETIC_SHAPES, settings);
    watch_encode(SYNTHETIC_FLAT, settings);
    settings = quick(GSCL_TARGET_BYTES, 900);
    settings.progressive = true;
    watch_encode(SYNTHETIC_TEXTURE, settings);
    settings = quick(GSCL_TARGET_SPLATS, 60);
    settings.profile = GSCL_PROFILE_PAPER;
    watch_encode(SYNTHETIC_TEXTURE, settings);
    settings = quick(GSCL_TARGET_BYTES, 700); /* smooth: compared with a smaller file that is searched */
    settings.effort = 3;
    watch_encode(SYNTHETIC_GRADIENT, settings);
}

static void test_same_bytes_every_time(void **state) {
    (void)state;
    gscl_image image = synthetic_image(SYNTHETIC_TEXTURE, 70, 50, 3, GSCL_SAMPLE_U8);
    gscl_context *fresh = NULL, *shared = context;
    for (gscl_blend blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend++) {
        gscl_encode_settings settings = quick(GSCL_TARGET_BYTES, 400);
        settings.blend = blend;
        const file first = encode_file(&image, &settings);
        const file other = encode_some(SYNTHETIC_SHAPES, 40, 90, 3, 40);
        const file second = encode_file(&image, &settings);
        assert_true(open_on(&fresh, test_device(), GSCL_MAPPING_AUTO));
        context = fresh;
        const file third = encode_file(&image, &settings);
        context = shared;
        gscl_context_free(&fresh);
        assert_true(first.size == second.size && !memcmp(first.bytes, second.bytes, first.size));
        assert_true(first.size == third.size && !memcmp(first.bytes, third.bytes, first.size));
        gscl_free(first.bytes);
        gscl_free(other.bytes);
        gscl_free(second.bytes);
        gscl_free(third.bytes);
    }
    synthetic_image_free(&image);
}

/* Samples of several bytes may lie at odd addresses. */
static void check_odd_address(gscl_sample sample) {
    enum { GAP = 5, OFFSET = 1 };
    const gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, 8);
    gscl_image image = synthetic_image(SYNTHETIC_SHAPES, 33, 21, 3, sample), moved = image;
    const size_t row = image.width * image.channels * synthetic_sample_size(sample);
    uint8_t *memory = malloc(OFFSET + (row + GAP) * image.height);
    assert_non_null(memory);
    moved.pixels = memory + OFFSET;
    moved.stride = row + GAP;
    for (uint32_t y = 0; y < image.height; y++)
        memcpy((uint8_t *)moved.pixels + y * moved.stride, (uint8_t *)image.pixels + y * row, row);
    const file expected = encode_file(&image, &settings), found = encode_file(&moved, &settings);
    assert_int_equal(found.size, expected.size);
    assert_memory_equal(found.bytes, expected.bytes, expected.size);
    gscl_free(expected.bytes);
    gscl_free(found.bytes);
    free(memory);
    synthetic_image_free(&image);
}

static void test_images_at_odd_addresses(void **state) {
    (void)state;
    check_odd_address(GSCL_SAMPLE_U16);
    check_odd_address(GSCL_SAMPLE_F32);
}

/* ---- Decoding ---- */

static void test_decode_into_callers_memory(void **state) {
    (void)state;
    enum { STRIDE = 37 * 3 + 11 };
    const file f = encode_some(SYNTHETIC_SHAPES, 37, 21, 3, 12);
    gscl_image whole = decode_file(&f, NULL);
    uint8_t memory[STRIDE * 21];
    memset(memory, 0xA7, sizeof memory);
    gscl_image mine = {
        .width = 37, .height = 21, .channels = 3, .sample = GSCL_SAMPLE_U8, .stride = STRIDE, .pixels = memory};
    assert_result(gscl_decode(context, f.bytes, f.size, NULL, &mine), GSCL_OK);
    assert_true(mine.pixels == memory && mine.stride == STRIDE);
    for (int y = 0; y < 21; y++) {
        assert_memory_equal(memory + y * STRIDE, (uint8_t *)whole.pixels + y * 37 * 3, 37 * 3);
        for (int x = 37 * 3; x < STRIDE; x++)
            assert_int_equal(memory[y * STRIDE + x], 0xA7);
    }
    const gscl_image good = mine;
    mine.width = 36;
    assert_result(gscl_decode(context, f.bytes, f.size, NULL, &mine), GSCL_ERROR_INVALID_ARGUMENT);
    mine = good;
    mine.sample = GSCL_SAMPLE_U16;
    assert_result(gscl_decode(context, f.bytes, f.size, NULL, &mine), GSCL_ERROR_INVALID_ARGUMENT);
    mine = good;
    mine.channels = 4;
    assert_result(gscl_decode(context, f.bytes, f.size, NULL, &mine), GSCL_ERROR_INVALID_ARGUMENT);
    gscl_free(whole.pixels);
    gscl_free(f.bytes);
}

static void test_decode_into_rows_that_are_too_short(void **state) {
    (void)state;
    uint8_t memory[8 * 3 * 8];
    const file f = encode_some(SYNTHETIC_SHAPES, 8, 8, 3, 2);
    gscl_image mine = {
        .width = 8, .height = 8, .channels = 3, .sample = GSCL_SAMPLE_U8, .stride = 8 * 3 - 1, .pixels = memory};
    assert_result(gscl_decode(context, f.bytes, f.size, NULL, &mine), GSCL_ERROR_INVALID_ARGUMENT);
    gscl_free(f.bytes);
}

/* Every crop equals that part of the whole. */
static void check_crops(const file *f, gscl_decode_settings settings) {
    static const uint32_t crops[][4] = {{0, 0, 1, 1}, {16, 16, 16, 16}, {5, 9, 30, 20}, {47, 0, 3, 40}, {49, 39, 1, 1}};
    gscl_image whole = decode_file(f, &settings);
    for (size_t i = 0; i < sizeof crops / sizeof *crops; i++) {
        const uint32_t *c = crops[i];
        settings.crop_x = c[0];
        settings.crop_y = c[1];
        settings.crop_width = c[2];
        settings.crop_height = c[3];
        gscl_image part = decode_file(f, &settings);
        assert_int_equal(part.width, c[2]);
        assert_int_equal(part.height, c[3]);
        for (uint32_t y = 0; y < c[3]; y++) {
            const uint8_t *row = (uint8_t *)whole.pixels + ((c[1] + y) * whole.width + c[0]) * 3;
            for (uint32_t x = 0; x < c[2] * 3; x++) /* coordinates relative to another frame are rounded differently */
                assert_in_range(((uint8_t *)part.pixels)[y * c[2] * 3 + x] + 1, row[x], row[x] + 2);
        }
        gscl_free(part.pixels);
    }
    gscl_free(whole.pixels);
}

static void test_crops(void **state) {
    (void)state;
    const file f = encode_some(SYNTHETIC_TEXTURE, 50, 40, 3, 60);
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    check_crops(&f, settings);
    settings.width = 111;
    settings.height = 63;
    check_crops(&f, settings);
    gscl_decode_settings_default(&settings);
    settings.crop_x = 40;
    settings.crop_width = 11;
    gscl_image image = {0};
    assert_result(gscl_decode(context, f.bytes, f.size, &settings, &image), GSCL_ERROR_INVALID_ARGUMENT);
    settings.crop_x = UINT32_MAX;
    settings.crop_width = 2;
    assert_result(gscl_decode(context, f.bytes, f.size, &settings, &image), GSCL_ERROR_INVALID_ARGUMENT);
    gscl_free(f.bytes);
}

static double mean_of(const gscl_image *image) {
    double sum = 0.0;
    for (size_t i = 0; i < synthetic_sample_count(image); i++)
        sum += synthetic_sample(image, i);
    return sum / (double)synthetic_sample_count(image);
}

static void test_sizes(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {25, 20}, {100, 80}, {50, 40}, {7, 200}, {16384, 1}};
    const file f = encode_some(SYNTHETIC_GRADIENT, 50, 40, 3, 20);
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    gscl_image whole = decode_file(&f, NULL), image = {0};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        settings.width = sizes[i][0];
        settings.height = sizes[i][1];
        gscl_image scaled = decode_file(&f, &settings);
        assert_int_equal(scaled.width, sizes[i][0]);
        assert_int_equal(scaled.height, sizes[i][1]);
        assert_true(fabs(mean_of(&scaled) - mean_of(&whole)) < 0.05);
        gscl_free(scaled.pixels);
    }
    settings.height = 0;
    assert_result(gscl_decode(context, f.bytes, f.size, &settings, &image), GSCL_ERROR_INVALID_ARGUMENT);
    settings.width = settings.height = GSCL_MAX_DIMENSION + 1;
    assert_result(gscl_decode(context, f.bytes, f.size, &settings, &image), GSCL_ERROR_IMAGE_SIZE);
    gscl_free(whole.pixels);
    gscl_free(f.bytes);
}

static void test_sample_types(void **state) {
    (void)state;
    static const gscl_sample samples[] = {GSCL_SAMPLE_U8, GSCL_SAMPLE_U16, GSCL_SAMPLE_F32};
    const file f = encode_some(SYNTHETIC_SHAPES, 33, 22, 4, 20);
    for (int premultiplied = 0; premultiplied < 2; premultiplied++) {
        gscl_image images[3];
        for (int i = 0; i < 3; i++) {
            gscl_decode_settings settings;
            gscl_decode_settings_default(&settings);
            settings.sample = samples[i];
            settings.premultiplied = premultiplied;
            images[i] = decode_file(&f, &settings);
            assert_true(images[i].sample == samples[i] && images[i].premultiplied == premultiplied);
        }
        for (size_t i = 0; i < synthetic_sample_count(&images[0]); i++) {
            const double exact = synthetic_sample(&images[2], i);
            assert_true(exact >= 0.0 && exact <= 1.0);
            assert_true(fabs(synthetic_sample(&images[0], i) - exact) <= 0.501 / 255.0);
            assert_true(fabs(synthetic_sample(&images[1], i) - exact) <= 0.51 / 65535.0);
            if (premultiplied)
                assert_true(exact <= synthetic_sample(&images[2], i / 4 * 4 + 3));
        }
        for (int i = 0; i < 3; i++)
            gscl_free(images[i].pixels);
    }
    gscl_free(f.bytes);
}

/* ---- Inspecting files ---- */

static void check_info(const file *f, uint32_t channels, uint32_t splats) {
    gscl_info probe = {.struct_size = sizeof probe}, inspect = {.struct_size = sizeof inspect};
    gscl_field field = {.struct_size = sizeof field};
    assert_int_equal(gscl_probe(f->bytes, f->size, NULL, &probe), GSCL_OK);
    assert_int_equal(gscl_inspect(f->bytes, f->size, NULL, &inspect), GSCL_OK);
    assert_int_equal(gscl_read_field(f->bytes, f->size, NULL, &field), GSCL_OK);
    assert_true(probe.format_version == 2 && inspect.format_version == 2);
    assert_true(probe.width == 41 && probe.height == 26 && inspect.width == 41 && inspect.height == 26);
    assert_true(probe.channels == channels && inspect.channels == channels);
    assert_true(probe.sample == inspect.sample && probe.blend == inspect.blend && probe.profile == inspect.profile);
    assert_true(probe.effects == inspect.effects && probe.bytes == f->size && inspect.bytes == f->size);
    assert_true(probe.splats == field.count && inspect.splats == field.count && field.count <= splats);
    assert_true(!(probe.effects & GSCL_EFFECT_CHROMA) == (channels < 3));
    assert_true(!(probe.effects & GSCL_EFFECT_ALPHA_CHANNEL) == (channels % 2 == 1));
    assert_int_equal(probe.stream_count, 0);
    double bits = 0.0;
    for (size_t i = 0; i < inspect.stream_count; i++) {
        assert_true(inspect.streams[i].name && inspect.streams[i].bits > 0.0);
        bits += inspect.streams[i].bits;
    }
    assert_true(fabs(bits - 8.0 * (double)f->size) < 1e-6);
    for (size_t i = 0; i < field.count; i++) {
        const gscl_splat *list = field.splats;
        assert_true(list[i].sigma1 > 0.0f && list[i].sigma2 > 0.0f && list[i].opacity > 0.0f &&
                    list[i].opacity <= 1.0f);
        assert_true(list[i].theta >= 0.0f && list[i].theta < 3.1416f);
        if (channels < 3)
            assert_true(list[i].colour[0] == list[i].colour[1] && list[i].colour[0] == list[i].colour[2]);
        if (channels % 2 == 1)
            assert_true(list[i].colour[3] == 1.0f);
    }
    gscl_free(field.splats);
}

static void test_looking_into_files(void **state) {
    (void)state;
    for (uint32_t channels = 1; channels <= 4; channels++) {
        for (uint32_t splats = 0; splats <= 30; splats += 15) {
            const file f = encode_some(SYNTHETIC_SHAPES, 41, 26, channels, splats);
            if (splats > 0)
                check_info(&f, channels, splats);
            assert_result(try_decode(f.bytes, f.size), GSCL_OK);
            gscl_free(f.bytes);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_texts),
#ifndef GSCL_WITH_OPENCL
        cmocka_unit_test(test_built_without_opencl),
#endif
        cmocka_unit_test(test_devices),
        cmocka_unit_test(test_context_without_a_device),
        cmocka_unit_test(test_bad_images),
        cmocka_unit_test(test_null_arguments),
        cmocka_unit_test(test_bad_settings),
        cmocka_unit_test(test_not_gscl),
        cmocka_unit_test(test_every_truncation),
        cmocka_unit_test(test_every_flipped_byte),
        cmocka_unit_test(test_ranges_of_targets),
        cmocka_unit_test(test_bytes_beyond_those_of_use),
        cmocka_unit_test(test_smallest_budget),
        cmocka_unit_test(test_tiny_budgets),
        cmocka_unit_test(test_budgets_are_used),
        cmocka_unit_test(test_bits_per_pixel),
        cmocka_unit_test(test_psnr),
        cmocka_unit_test(test_ssimulacra2),
        cmocka_unit_test(test_refused_ssimulacra2),
        cmocka_unit_test(test_quality),
        cmocka_unit_test(test_refused_quality),
        cmocka_unit_test(test_ssimulacra2_of_flat_images),
        cmocka_unit_test(test_default_target),
        cmocka_unit_test(test_background_of_textures),
        cmocka_unit_test(test_background_of_drawings),
        cmocka_unit_test(test_textures),
        cmocka_unit_test(test_few_splats_are_no_worse_than_none),
        cmocka_unit_test(test_flat_images),
        cmocka_unit_test(test_long_images),
        cmocka_unit_test(test_progress_and_cancel),
        cmocka_unit_test(test_end_of_progress),
        cmocka_unit_test(test_same_bytes_every_time),
        cmocka_unit_test(test_images_at_odd_addresses),
        cmocka_unit_test(test_decode_into_callers_memory),
        cmocka_unit_test(test_decode_into_rows_that_are_too_short),
        cmocka_unit_test(test_crops),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_sample_types),
        cmocka_unit_test(test_looking_into_files),
    };
    return cmocka_run_group_tests(tests, open_context, close_context);
}
