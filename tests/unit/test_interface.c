/* Compatibility of the public interface: structs of another size, versions, and limits of a decode.  A library
 * without an encoder skips those of encodes. */
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

#include "cl/constants.h"
#include "format/format.h"
#include "joined_tests.h"
#include "one_context.h"
#include "synthetic_image.h"
#include "synthetic_scene.h"
#include "wrapped_allocations.h"

#define POISON 0xA5

static void assert_result(gscl_result result, gscl_result expected) {
    if (result != expected)
        fail_msg("%s (%s); expected: %s", gscl_result_text(result), gscl_context_message(context),
                 gscl_result_text(expected));
}

static void assert_message_has(const char *text) {
    if (!strstr(gscl_context_message(context), text))
        fail_msg("\"%s\" lacks \"%s\"", gscl_context_message(context), text);
}

static void assert_message_has_number(uint64_t number) {
    char text[32];
    snprintf(text, sizeof text, "%llu", (unsigned long long)number);
    assert_message_has(text);
}

static void assert_poisoned(const void *sized, size_t from, size_t to) {
    for (size_t i = from; i < to; i++)
        assert_int_equal(((const unsigned char *)sized)[i], POISON);
}

/* ---- Allocations of the library (meson.build redirects its calls to these) ---- */

static size_t allocated_bytes; /* since a test set it to 0 */

void *__wrap_malloc(size_t size) {
    allocated_bytes += size;
    return __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
    allocated_bytes += count * size;
    return __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size) {
    allocated_bytes += size;
    return __real_realloc(memory, size);
}

/* ---- One file that all tests read ---- */

#define WIDTH 60
#define HEIGHT 40
#define SPLATS 15

static gscl_image source; /* for encodes */
static uint8_t *bytes;
static size_t size;

static int open_file(void **state) {
    if (open_context(state) != 0)
        return -1;
    source = synthetic_image(SYNTHETIC_SHAPES, WIDTH, HEIGHT, 3, GSCL_SAMPLE_U8);
    return source.pixels && synthetic_file(WIDTH, HEIGHT, SPLATS, &bytes, &size) ? 0 : -1;
}

static int close_file(void **state) {
    free(bytes);
    synthetic_image_free(&source);
    return close_context(state);
}

static gscl_info inspect(void) {
    gscl_info info = {.struct_size = sizeof info};
    assert_int_equal(gscl_inspect(bytes, size, NULL, &info), GSCL_OK);
    return info;
}

/* ---- Versions ---- */

static void test_versions_agree(void **state) {
    (void)state;
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", GSCL_VERSION_NUMBER / 1000000, GSCL_VERSION_NUMBER / 1000 % 1000,
             GSCL_VERSION_NUMBER % 1000);
    assert_string_equal(text, GSCL_VERSION);
    assert_string_equal(gscl_version(), GSCL_VERSION);
    assert_int_equal(gscl_version_number(), GSCL_VERSION_NUMBER);
}

/* ---- Sizes of structs that no version has ---- */

static void check_refused_sizes(gscl_result (*use)(void *sized), void *sized, size_t newest) {
    const size_t wrong[] = {0, 1, sizeof(size_t), newest + 1, SIZE_MAX};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        memcpy(sized, &wrong[i], sizeof wrong[i]);
        assert_result(use(sized), GSCL_ERROR_STRUCT_SIZE);
    }
    memcpy(sized, &newest, sizeof newest);
    assert_result(use(sized), GSCL_OK);
}

static gscl_result use_context_settings(void *settings) {
    gscl_context *other = NULL;
    const gscl_result result = gscl_context_create(&other, settings);
    gscl_context_free(&other);
    return result;
}

static gscl_result encode_with(const gscl_encode_settings *settings, gscl_encode_report *report) {
    gscl_encode_settings quick;
    gscl_encode_settings_default(&quick);
    quick.effort = 0;
    uint8_t *written = NULL;
    size_t written_size;
    const gscl_result result =
        gscl_encode(context, &source, settings ? settings : &quick, &written, &written_size, report);
    gscl_free(written);
    return result;
}

static gscl_result use_encode_settings(void *settings) {
    return encode_with(settings, NULL);
}

static gscl_result use_encode_report(void *report) {
    return encode_with(NULL, report);
}

static gscl_result use_decode_settings(void *settings) {
    gscl_image image = {0};
    const gscl_result result = gscl_decode(context, bytes, size, settings, &image);
    gscl_free(image.pixels);
    return result;
}

static gscl_result use_probe(void *info) {
    return gscl_probe(bytes, size, NULL, info);
}

static gscl_result use_inspect(void *info) {
    return gscl_inspect(bytes, size, NULL, info);
}

static gscl_result use_comparison(void *comparison) {
    return gscl_compare(&source, &source, comparison);
}

static void test_wrong_sizes_are_refused(void **state) {
    (void)state;
    gscl_context_settings c = {0};
    gscl_decode_settings d = {0};
    gscl_info info = {0};
    check_refused_sizes(use_context_settings, &c, sizeof c);
    check_refused_sizes(use_decode_settings, &d, sizeof d);
    check_refused_sizes(use_probe, &info, sizeof info);
    check_refused_sizes(use_inspect, &info, sizeof info);
}

static void test_wrong_sizes_are_refused_by_encodes(void **state) {
    (void)state;
    gscl_encode_settings e;
    gscl_encode_report report = {0};
    gscl_comparison comparison = {0};
    gscl_encode_settings_default(&e);
    e.effort = 0;
    check_refused_sizes(use_encode_settings, &e, sizeof e);
    check_refused_sizes(use_encode_report, &report, sizeof report);
    check_refused_sizes(use_comparison, &comparison, sizeof comparison);
}

static void test_message_on_a_missing_size(void **state) {
    (void)state;
    gscl_decode_settings zero = {0};
    assert_result(use_decode_settings(&zero), GSCL_ERROR_STRUCT_SIZE);
    assert_message_has("struct_size of gscl_decode_settings is 0");
    assert_message_has("sizeof");
    zero.struct_size = sizeof zero + 8;
    assert_result(use_decode_settings(&zero), GSCL_ERROR_STRUCT_SIZE);
    assert_message_has_number(sizeof zero + 8);
    assert_message_has_number(sizeof zero);
    assert_non_null(strstr(gscl_result_text(GSCL_ERROR_STRUCT_SIZE), "struct_size"));
}

/* ---- Programs that were compiled when structs ended earlier ---- */

#define OLD_CONTEXT offsetof(gscl_context_settings, log)
#define OLD_ENCODE offsetof(gscl_encode_settings, trace)
#define OLD_DECODE offsetof(gscl_decode_settings, max_pixels)
#define OLD_REPORT offsetof(gscl_encode_report, trace_count)
#define OLD_INFO offsetof(gscl_info, pixels)
#define OLD_COMPARISON offsetof(gscl_comparison, max_difference)

static void test_defaults_of_an_old_program(void **state) {
    (void)state;
    gscl_context_settings c;
    gscl_encode_settings e;
    gscl_decode_settings d;
    memset(&c, POISON, sizeof c);
    memset(&e, POISON, sizeof e);
    memset(&d, POISON, sizeof d);
    gscl_context_settings_init(&c, OLD_CONTEXT);
    gscl_encode_settings_init(&e, OLD_ENCODE);
    gscl_decode_settings_init(&d, OLD_DECODE);
    assert_true(c.struct_size == OLD_CONTEXT && e.struct_size == OLD_ENCODE && d.struct_size == OLD_DECODE);
    assert_true(!c.device && e.effort == GSCL_DEFAULT_EFFORT && e.seed == 1 && d.width == 0);
    assert_poisoned(&c, OLD_CONTEXT, sizeof c);
    assert_poisoned(&e, OLD_ENCODE, sizeof e);
    assert_poisoned(&d, OLD_DECODE, sizeof d);
}

/* ---- Presets ---- */

static void test_presets_set_target_and_effort_alone(void **state) {
    (void)state;
    int count = 0;
    for (; gscl_preset_name((gscl_preset)count); count++) {
        gscl_encode_settings s, same;
        gscl_encode_settings_default(&s);
        s.seed = 7;
        same = s;
        assert_result(gscl_encode_settings_preset(&s, (gscl_preset)count), GSCL_OK);
        assert_true(s.effort >= 0 && s.effort <= GSCL_MAX_EFFORT);
        same.target = s.target;
        same.target_value = s.target_value;
        same.effort = s.effort;
        assert_memory_equal(&s, &same, sizeof s);
    }
    assert_int_equal(count, GSCL_PRESET_GOOD + 1);
}

static void test_small_is_the_default(void **state) {
    (void)state;
    gscl_encode_settings s, defaults;
    gscl_encode_settings_default(&defaults);
    gscl_encode_settings_default(&s);
    s.effort = 0;
    assert_result(gscl_encode_settings_preset(&s, GSCL_PRESET_SMALL), GSCL_OK);
    assert_memory_equal(&s, &defaults, sizeof s);
}

static void test_presets_are_refused(void **state) {
    (void)state;
    gscl_encode_settings s = {.effort = 1};
    assert_result(gscl_encode_settings_preset(NULL, GSCL_PRESET_SMALL), GSCL_ERROR_INVALID_ARGUMENT);
    assert_result(gscl_encode_settings_preset(&s, GSCL_PRESET_SMALL), GSCL_ERROR_STRUCT_SIZE);
    gscl_encode_settings_default(&s);
    assert_result(gscl_encode_settings_preset(&s, (gscl_preset)(GSCL_PRESET_GOOD + 1)), GSCL_ERROR_INVALID_ARGUMENT);
    assert_result(gscl_encode_settings_preset(&s, (gscl_preset)-1), GSCL_ERROR_INVALID_ARGUMENT);
}

static void refuse_log(void *opaque, gscl_log_level level, const char *message) {
    fail_msg("%d %s %p", (int)level, message, opaque);
}

static bool refuse_progress(void *opaque, const gscl_progress *progress) {
    fail_msg("%g %p", progress->fraction, opaque);
    return true;
}

static void test_settings_of_an_old_program(void **state) {
    (void)state;
    gscl_context_settings c;
    gscl_context_settings_default(&c);
    c.log = refuse_log;
    c.struct_size = OLD_CONTEXT;
    assert_result(use_context_settings(&c), GSCL_OK);

    gscl_decode_settings d;
    gscl_decode_settings_default(&d);
    d.max_pixels = d.max_work = 1;
    assert_result(use_decode_settings(&d), GSCL_ERROR_LIMIT);
    d.struct_size = OLD_DECODE;
    assert_result(use_decode_settings(&d), GSCL_OK);
    gscl_decode_settings_default(&d);
    d.progress = refuse_progress;
    d.struct_size = offsetof(gscl_decode_settings, progress);
    assert_result(use_decode_settings(&d), GSCL_OK);
}

static void test_encode_of_an_old_program(void **state) {
    (void)state;
    gscl_encode_settings e;
    gscl_encode_report report = {.struct_size = sizeof report};
    gscl_encode_settings_default(&e);
    e.effort = 0;
    e.trace = true;
    assert_result(encode_with(&e, &report), GSCL_OK);
    assert_true(report.trace_count > 0);
    e.struct_size = OLD_ENCODE;
    assert_result(encode_with(&e, &report), GSCL_OK);
    assert_int_equal(report.trace_count, 0);
}

/* The automatic target has no value, not even one that a target would have. */
static void test_value_of_the_automatic_target_is_refused(void **state) {
    (void)state;
    const double values[] = {-1, NAN, INFINITY, 1, 1000};
    gscl_encode_report report = {.struct_size = sizeof report};
    gscl_encode_settings e;
    gscl_encode_settings_default(&e);
    e.effort = 0;
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        e.target_value = values[i];
        assert_result(encode_with(&e, &report), GSCL_ERROR_INVALID_ARGUMENT);
        assert_non_null(strstr(gscl_context_message(context), "has no target; choose one, or 0"));
    }
}

static void test_results_of_an_old_program(void **state) {
    (void)state;
    gscl_info info;
    for (int whole = 0; whole < 2; whole++) {
        memset(&info, POISON, sizeof info);
        info.struct_size = OLD_INFO;
        assert_result(whole ? use_inspect(&info) : use_probe(&info), GSCL_OK);
        assert_true(info.struct_size == OLD_INFO && info.width == WIDTH && info.bytes == size);
        assert_poisoned(&info, OLD_INFO, sizeof info);
    }
}

static void test_report_of_an_old_program(void **state) {
    (void)state;
    gscl_encode_report report;
    gscl_comparison comparison;
    memset(&report, POISON, sizeof report);
    memset(&comparison, POISON, sizeof comparison);
    report.struct_size = OLD_REPORT;
    assert_result(use_encode_report(&report), GSCL_OK);
    assert_true(report.struct_size == OLD_REPORT && report.bytes > 0 && report.stage_count > 0);
    assert_poisoned(&report, OLD_REPORT, sizeof report);
    comparison.struct_size = OLD_COMPARISON;
    assert_result(use_comparison(&comparison), GSCL_OK);
    assert_true(comparison.struct_size == OLD_COMPARISON && comparison.mse == 0);
    assert_poisoned(&comparison, OLD_COMPARISON, sizeof comparison);
}

/* ---- Limits of a decode ---- */

/* The header of a file with the largest image that the format allows, without a payload. */
static size_t put_huge_header(uint8_t *huge, size_t capacity) {
    gsf_header header;
    gsf_coder coder;
    const size_t start = gsf_container_start_size(NULL), end = gsf_container_end_size(NULL);
    assert_int_equal(gsf_read_header(bytes, size, false, &header), GSF_OK);
    header.width = header.height = GSCL_MAX_DIMENSION;
    gsf_coder_write_to(&coder, huge + start, capacity - start - end, NULL);
    gsf_code_fields(&coder, &header);
    gsf_range_encoder_finish(&coder.encoder);
    gsf_put_container_start(huge, NULL);
    gsf_put_container_end(huge, start + coder.encoder.size, NULL);
    return start + coder.encoder.size + end;
}

static void test_header_is_refused_without_allocating(void **state) {
    (void)state;
    uint8_t huge[64] = {0};
    const size_t huge_size = put_huge_header(huge, sizeof huge);
    gscl_info info = {.struct_size = sizeof info};
    gscl_image image = {0};
    gscl_decode_settings s;
    gscl_decode_settings_default(&s);
    assert_result(gscl_probe(huge, huge_size, NULL, &info), GSCL_OK);
    assert_true(info.pixels == (uint64_t)GSCL_MAX_DIMENSION * GSCL_MAX_DIMENSION);
    assert_true(info.work == info.pixels * info.splats);

    allocated_bytes = 0;
    s.max_pixels = 1000000;
    assert_result(gscl_decode(context, huge, huge_size, &s, &image), GSCL_ERROR_LIMIT);
    assert_message_has("max_pixels is 1000000");
    assert_message_has_number(info.pixels);
    s.max_pixels = 0;
    s.max_work = info.splats - 1;
    assert_result(gscl_decode(context, huge, huge_size, &s, &image), GSCL_ERROR_LIMIT);
    assert_message_has("max_work is 14");
    assert_message_has_number(info.splats);
    assert_int_equal(allocated_bytes, 0);
    assert_null(image.pixels);
    /* The header is within these limits, so that the missing payload is the error. */
    s.max_pixels = info.pixels;
    s.max_work = info.splats;
    const gscl_result result = gscl_decode(context, huge, huge_size, &s, &image);
    assert_true(result >= GSCL_ERROR_TRUNCATED && result <= GSCL_ERROR_CORRUPT);
}

static void test_pixels_are_those_returned(void **state) {
    (void)state;
    gscl_decode_settings s;
    gscl_decode_settings_default(&s);
    s.max_pixels = WIDTH * HEIGHT;
    assert_result(use_decode_settings(&s), GSCL_OK);
    s.max_pixels--;
    assert_result(use_decode_settings(&s), GSCL_ERROR_LIMIT);
    s.crop_width = WIDTH - 1;
    assert_result(use_decode_settings(&s), GSCL_OK);
    s.width = 2 * WIDTH;
    s.height = 2 * HEIGHT;
    s.crop_width = 0;
    assert_result(use_decode_settings(&s), GSCL_ERROR_LIMIT);
    assert_message_has_number(4 * WIDTH * HEIGHT);
}

static void test_work_of_a_file(void **state) {
    (void)state;
    const gscl_info info = inspect();
    gscl_info bound = {.struct_size = sizeof bound};
    assert_result(gscl_probe(bytes, size, NULL, &bound), GSCL_OK);
    assert_true(info.work >= info.splats && info.work <= bound.work);
    gscl_decode_settings s;
    gscl_decode_settings_default(&s);
    s.max_work = info.work;
    assert_result(use_decode_settings(&s), GSCL_OK);
    s.max_work = info.work - 1;
    assert_result(use_decode_settings(&s), GSCL_ERROR_LIMIT);
    assert_message_has_number(info.work);
    assert_message_has_number(info.work - 1);
}

static void test_work_is_refused_before_pixels_are_allocated(void **state) {
    (void)state;
    gscl_decode_settings s;
    gscl_decode_settings_default(&s);
    s.width = s.height = 8192;
    s.max_work = inspect().work;
    allocated_bytes = 0;
    assert_result(use_decode_settings(&s), GSCL_ERROR_LIMIT);
    assert_true(allocated_bytes > 0 && allocated_bytes < (size_t)8192 * 8192 / 16);
}

/* The same figure, computed from the splats that gscl_read_field returns. */
static void test_work_is_the_area_of_outlines(void **state) {
    (void)state;
    gscl_field field = {.struct_size = sizeof field};
    double area = 0;
    assert_result(gscl_read_field(bytes, size, NULL, &field), GSCL_OK);
    for (size_t i = 0; i < field.count; i++) {
        const gscl_splat *p = &field.splats[i];
        const double radius = sqrt(2 * GSCL_SUPPORT), c = cos(p->theta), n = sin(p->theta);
        const double half_width = radius * hypot(c * p->sigma1, n * p->sigma2);
        const double half_height = radius * hypot(n * p->sigma1, c * p->sigma2);
        const double width = fmin(p->x + half_width, WIDTH) - fmax(p->x - half_width, 0);
        const double height = fmin(p->y + half_height, HEIGHT) - fmax(p->y - half_height, 0);
        area += fmax(1, fmax(width, 0) * fmax(height, 0));
    }
    assert_true(fabs((double)inspect().work - area) < 1.01 * (double)field.count);
    gscl_free(field.splats);
}

static void test_work_follows_size_and_crop(void **state) {
    (void)state;
    const uint64_t work = inspect().work;
    gscl_decode_settings s;
    gscl_decode_settings_default(&s);
    s.width = 2 * WIDTH;
    s.height = 2 * HEIGHT;
    s.max_work = work * 7 / 2;
    assert_result(use_decode_settings(&s), GSCL_ERROR_LIMIT);
    s.max_work = work * 9 / 2;
    assert_result(use_decode_settings(&s), GSCL_OK);
    gscl_decode_settings_default(&s);
    s.crop_width = s.crop_height = 2;
    s.max_work = 4 * SPLATS;
    assert_result(use_decode_settings(&s), GSCL_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_versions_agree),
        cmocka_unit_test(test_wrong_sizes_are_refused),
        cmocka_unit_test(test_message_on_a_missing_size),
        cmocka_unit_test(test_defaults_of_an_old_program),
        cmocka_unit_test(test_presets_set_target_and_effort_alone),
        cmocka_unit_test(test_small_is_the_default),
        cmocka_unit_test(test_presets_are_refused),
        cmocka_unit_test(test_settings_of_an_old_program),
        cmocka_unit_test(test_results_of_an_old_program),
        cmocka_unit_test(test_header_is_refused_without_allocating),
        cmocka_unit_test(test_pixels_are_those_returned),
        cmocka_unit_test(test_work_of_a_file),
        cmocka_unit_test(test_work_is_refused_before_pixels_are_allocated),
        cmocka_unit_test(test_work_is_the_area_of_outlines),
        cmocka_unit_test(test_work_follows_size_and_crop),
    };
    const struct CMUnitTest encoder_tests[] = {
        cmocka_unit_test(test_wrong_sizes_are_refused_by_encodes),
        cmocka_unit_test(test_encode_of_an_old_program),
        cmocka_unit_test(test_value_of_the_automatic_target_is_refused),
        cmocka_unit_test(test_report_of_an_old_program),
    };
    JOIN_TESTS(tests);
    if (has_encoder())
        JOIN_TESTS(encoder_tests);
    return run_joined_tests(open_file, close_file);
}
