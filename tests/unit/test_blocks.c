/* Blocks and bare files in the library's interface. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "one_context.h"
#include "synthetic_image.h"

static gscl_image image;

typedef struct file {
    uint8_t *bytes;
    size_t size;
} file;

static const uint8_t colour_space[] = {1, 13};
static const uint8_t profile[300] = "profile", exif[] = "II*", xmp[] = "<x:xmpmeta/>";
/* In an order that is not that of the file. */
static const gscl_block icc_block = {NULL, GSCL_BLOCK_ICC, profile, sizeof profile};
static const gscl_block xmp_block = {&icc_block, GSCL_BLOCK_XMP, xmp, sizeof xmp};
static const gscl_block space_block = {&xmp_block, GSCL_BLOCK_COLOUR_SPACE, colour_space, sizeof colour_space};
static const gscl_block all_blocks = {&space_block, GSCL_BLOCK_EXIF, exif, sizeof exif};
#define CONTENT (sizeof profile + sizeof xmp + sizeof colour_space + sizeof exif)

static int open_all(void **state) {
    image = synthetic_image(SYNTHETIC_SHAPES, 50, 40, 3, GSCL_SAMPLE_U8);
    return image.pixels ? open_context(state) : -1;
}

static int close_all(void **state) {
    synthetic_image_free(&image);
    return close_context(state);
}

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

static file encode(const gscl_encode_settings *settings, gscl_encode_report *report) {
    file f = {NULL, 0};
    assert_result(gscl_encode(context, &image, settings, &f.bytes, &f.size, report), GSCL_OK);
    return f;
}

static void assert_refused(const gscl_encode_settings *settings, gscl_result expected, const char *message) {
    file f = {NULL, 0};
    assert_result(gscl_encode(context, &image, settings, &f.bytes, &f.size, NULL), expected);
    assert_null(f.bytes);
    if (!strstr(gscl_context_message(context), message))
        fail_msg("the message is: %s", gscl_context_message(context));
}

/* ---- Blocks ---- */

static void assert_block(const file *f, gscl_block_type type, const void *expected, size_t expected_size) {
    const void *data = f;
    size_t size = 77;
    assert_result(gscl_find_block(f->bytes, f->size, type, &data, &size), GSCL_OK);
    assert_int_equal(size, expected_size);
    if (!expected) {
        assert_null(data);
        return;
    }
    assert_memory_equal(data, expected, size);
    assert_true((const uint8_t *)data > f->bytes && (const uint8_t *)data + size < f->bytes + f->size);
}

static void test_blocks_are_stored(void **state) {
    (void)state;
    gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, 5);
    const file plain = encode(&settings, NULL);
    settings.blocks = &all_blocks;
    const file full = encode(&settings, NULL);
    settings.blocks = &icc_block;
    const file one = encode(&settings, NULL);
    assert_block(&full, GSCL_BLOCK_COLOUR_SPACE, colour_space, sizeof colour_space);
    assert_block(&full, GSCL_BLOCK_ICC, profile, sizeof profile);
    assert_block(&full, GSCL_BLOCK_EXIF, exif, sizeof exif);
    assert_block(&full, GSCL_BLOCK_XMP, xmp, sizeof xmp);
    assert_block(&one, GSCL_BLOCK_ICC, profile, sizeof profile);
    for (int type = GSCL_BLOCK_COLOUR_SPACE; type <= GSCL_BLOCK_XMP; type++)
        assert_block(&plain, (gscl_block_type)type, NULL, 0);
    assert_block(&one, GSCL_BLOCK_EXIF, NULL, 0);
    assert_in_range(full.size, plain.size + CONTENT + 4 * 2, plain.size + CONTENT + 4 * 3 + 4);
    gscl_free(plain.bytes);
    gscl_free(full.bytes);
    gscl_free(one.bytes);
}

/* Blocks change neither splats nor pixels. */
static void test_blocks_leave_the_picture(void **state) {
    (void)state;
    gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, 9);
    gscl_image pixels[2] = {{0}, {0}};
    gscl_info info = {.struct_size = sizeof info};
    for (int i = 0; i < 2; i++) {
        settings.blocks = i ? &all_blocks : NULL;
        const file f = encode(&settings, NULL);
        assert_result(gscl_decode(context, f.bytes, f.size, NULL, &pixels[i]), GSCL_OK);
        assert_result(gscl_inspect(f.bytes, f.size, NULL, &info), GSCL_OK);
        assert_int_equal(info.bytes, f.size);
        gscl_free(f.bytes);
    }
    assert_string_equal(info.streams[1].name, "blocks");
    assert_memory_equal(pixels[0].pixels, pixels[1].pixels, 50 * 40 * 3);
    gscl_free(pixels[0].pixels);
    gscl_free(pixels[1].pixels);
}

static void test_budget_counts_blocks(void **state) {
    (void)state;
    gscl_encode_settings settings = quick(GSCL_TARGET_BYTES, (double)CONTENT + 150);
    gscl_encode_report report = {.struct_size = sizeof report};
    settings.blocks = &all_blocks;
    const file f = encode(&settings, &report);
    assert_int_equal(report.bytes, f.size);
    assert_in_range(f.size, CONTENT + 140, CONTENT + 150);
    assert_true(report.splats > 5);
    gscl_free(f.bytes);
    settings.target_value = CONTENT;
    assert_refused(&settings, GSCL_ERROR_BUDGET_TOO_SMALL, "blocks (profile, metadata) take");
}

static void test_bad_blocks(void **state) {
    (void)state;
    gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, 5);
    const gscl_block again = {&all_blocks, GSCL_BLOCK_ICC, profile, 5}, empty = {NULL, GSCL_BLOCK_XMP, xmp, 0},
                     missing = {NULL, GSCL_BLOCK_XMP, NULL, 5},
                     large = {NULL, GSCL_BLOCK_XMP, xmp, GSCL_MAX_BLOCK_SIZE + 1},
                     wide = {NULL, GSCL_BLOCK_COLOUR_SPACE, colour_space, 3},
                     other = {NULL, (gscl_block_type)4, xmp, 5};
    const struct {
        const gscl_block *block;
        const char *message;
    } cases[] = {{&again, "two blocks"}, {&empty, "0 bytes"}, {&missing, "5 bytes"},
                 {&large, "2097151"},    {&wide, "3 bytes"},  {&other, "unknown type"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        settings.blocks = cases[i].block;
        assert_refused(&settings, GSCL_ERROR_INVALID_ARGUMENT, cases[i].message);
    }
    settings.blocks = &icc_block;
    settings.bare = true;
    assert_refused(&settings, GSCL_ERROR_CONFLICT, "bare");
}

static void test_find_block_checks_the_file(void **state) {
    (void)state;
    gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, 5);
    const void *data;
    size_t size;
    settings.blocks = &all_blocks;
    const file f = encode(&settings, NULL);
    assert_int_equal(gscl_find_block(NULL, 9, GSCL_BLOCK_ICC, &data, &size), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_find_block(f.bytes, f.size, GSCL_BLOCK_ICC, NULL, &size), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_find_block(f.bytes, f.size, GSCL_BLOCK_ICC, &data, NULL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_find_block(f.bytes, f.size, (gscl_block_type)4, &data, &size), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(gscl_find_block(f.bytes, 3, GSCL_BLOCK_ICC, &data, &size), GSCL_ERROR_NOT_GSCL);
    assert_int_equal(gscl_find_block(f.bytes, 100, GSCL_BLOCK_ICC, &data, &size), GSCL_ERROR_TRUNCATED);
    f.bytes[f.size / 2] ^= 1;
    assert_int_equal(gscl_find_block(f.bytes, f.size, GSCL_BLOCK_ICC, &data, &size), GSCL_ERROR_DAMAGED);
    gscl_free(f.bytes);
}

/* ---- Bare files ---- */

static void check_bare(const file *whole, const file *bare) {
    gscl_read_settings reading;
    gscl_decode_settings decoding;
    gscl_info infos[2] = {{.struct_size = sizeof infos[0]}, {.struct_size = sizeof infos[1]}};
    gscl_image pixels[2] = {{0}, {0}};
    gscl_field field = {.struct_size = sizeof field};
    gscl_effect_use uses[GSCL_MAX_EFFECTS];
    size_t count;
    gscl_read_settings_default(&reading);
    gscl_decode_settings_default(&decoding);
    reading.bare = decoding.bare = true;
    assert_result(gscl_decode(context, whole->bytes, whole->size, NULL, &pixels[0]), GSCL_OK);
    assert_result(gscl_decode(context, bare->bytes, bare->size, &decoding, &pixels[1]), GSCL_OK);
    assert_memory_equal(pixels[0].pixels, pixels[1].pixels, 50 * 40 * 3);
    assert_result(gscl_inspect(whole->bytes, whole->size, NULL, &infos[0]), GSCL_OK);
    assert_result(gscl_inspect(bare->bytes, bare->size, &reading, &infos[1]), GSCL_OK);
    assert_true(infos[0].splats == infos[1].splats && infos[0].work == infos[1].work && infos[1].bytes == bare->size);
    assert_result(gscl_probe(bare->bytes, bare->size, &reading, &infos[1]), GSCL_OK);
    assert_result(gscl_read_field(bare->bytes, bare->size, &reading, &field), GSCL_OK);
    assert_int_equal(field.count, infos[0].splats);
    assert_result(gscl_inspect_effects(context, bare->bytes, bare->size, &reading, &image, uses, &count), GSCL_OK);
    /* The form is not guessed. */
    assert_int_equal(gscl_probe(bare->bytes, bare->size, NULL, &infos[1]), GSCL_ERROR_NOT_GSCL);
    assert_true(gscl_inspect(whole->bytes, whole->size, &reading, &infos[1]) != GSCL_OK);
    gscl_free(field.splats);
    gscl_free(pixels[0].pixels);
    gscl_free(pixels[1].pixels);
}

static void test_bare_files(void **state) {
    (void)state;
    gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, 12);
    for (int is_paper = 0; is_paper < 2; is_paper++) {
        settings.profile = is_paper ? GSCL_PROFILE_PAPER : GSCL_PROFILE_DEFAULT;
        settings.bare = false;
        const file whole = encode(&settings, NULL);
        settings.bare = true;
        const file bare = encode(&settings, NULL);
        assert_int_equal(whole.size, bare.size + 7);
        assert_memory_equal(whole.bytes + 5, bare.bytes, bare.size);
        check_bare(&whole, &bare);
        gscl_free(whole.bytes);
        gscl_free(bare.bytes);
    }
}

/* Targets of every kind count the file without a container. */
static void test_targets_of_bare_files(void **state) {
    (void)state;
    gscl_encode_settings settings = quick(GSCL_TARGET_BYTES, 100);
    gscl_encode_report report = {.struct_size = sizeof report};
    settings.bare = true;
    file f = encode(&settings, &report);
    assert_true(f.size <= 100 && f.size >= 92 && report.bytes == f.size);
    gscl_free(f.bytes);
    settings.target = GSCL_TARGET_PSNR;
    settings.target_value = 23;
    f = encode(&settings, &report);
    /* No upper limit: one splat changes the PSNR of these shapes by a decibel. */
    if (report.psnr < 23 || report.bytes != f.size)
        fail_msg("%g dB, %zu bytes, %llu in the report", report.psnr, f.size, (unsigned long long)report.bytes);
    gscl_free(f.bytes);
}

static void test_reading_settings_are_checked(void **state) {
    (void)state;
    const gscl_encode_settings settings = quick(GSCL_TARGET_SPLATS, 2);
    gscl_read_settings reading = {.struct_size = 0};
    gscl_info info = {.struct_size = sizeof info};
    gscl_field field = {.struct_size = sizeof field};
    const file f = encode(&settings, NULL);
    assert_int_equal(gscl_probe(f.bytes, f.size, &reading, &info), GSCL_ERROR_STRUCT_SIZE);
    assert_int_equal(gscl_inspect(f.bytes, f.size, &reading, &info), GSCL_ERROR_STRUCT_SIZE);
    reading.struct_size = sizeof reading + 8;
    assert_int_equal(gscl_read_field(f.bytes, f.size, &reading, &field), GSCL_ERROR_STRUCT_SIZE);
    gscl_free(f.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_blocks_are_stored),          cmocka_unit_test(test_blocks_leave_the_picture),
        cmocka_unit_test(test_budget_counts_blocks),       cmocka_unit_test(test_bad_blocks),
        cmocka_unit_test(test_find_block_checks_the_file), cmocka_unit_test(test_bare_files),
        cmocka_unit_test(test_targets_of_bare_files),      cmocka_unit_test(test_reading_settings_are_checked),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
