/* The table of quirks, and the kernels that other implementations and devices than PoCL's get: here PoCL runs them, under the
 * name of each implementation (tests/devices runs them on the implementations themselves). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "devices.h"
#include "fake_opencl.h"
#include "runtime/kernel_options.h"
#include "runtime/mapping.h"
#include "opencl/quirks.h"
#include "synthetic_image.h"

#define WIDTH 40 /* pixels: neither a multiple of a tile nor of a pixel vector */
#define HEIGHT 22
#define SPLATS 16

typedef struct {
    uint8_t *bytes;
    size_t size;
} file;

static gscl_context *open_opencl(gscl_mapping mapping) {
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = first_opencl_device();
    settings.mapping = mapping;
    assert_int_equal(gscl_context_create(&context, &settings), GSCL_OK);
    return context;
}

static gscl_context *open_as(const char *platform_name, gscl_mapping mapping) {
    fake = (fake_opencl){.platform_name = platform_name};
    gscl_context *context = open_opencl(mapping);
    fake = (fake_opencl){0};
    return context;
}

static file encode_with(gscl_context *context, const gscl_image *image) {
    gscl_encode_settings settings;
    file f = {NULL, 0};
    gscl_encode_settings_default(&settings);
    settings.target = GSCL_TARGET_SPLATS;
    settings.target_value = SPLATS;
    settings.effort = 0;
    const gscl_result result = gscl_encode(context, image, &settings, &f.bytes, &f.size, NULL);
    if (result != GSCL_OK)
        fail_msg("%s", gscl_context_message(context));
    return f;
}

static gscl_image decode_with(gscl_context *context, const file *f) {
    gscl_image image = {0};
    if (gscl_decode(context, f->bytes, f->size, NULL, &image) != GSCL_OK)
        fail_msg("%s", gscl_context_message(context));
    return image;
}

static double mean_square(const gscl_image *a, const gscl_image *b) {
    const size_t count = synthetic_sample_count(a);
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const double d = synthetic_sample(a, i) - synthetic_sample(b, i);
        sum += d * d / (double)count;
    }
    return sum;
}

static void assert_same_picture(const gscl_image *a, const gscl_image *b) {
    assert_int_equal(synthetic_sample_count(a), synthetic_sample_count(b));
    for (size_t i = 0; i < synthetic_sample_count(a); i++)
        assert_in_range(abs(((const uint8_t *)a->pixels)[i] - ((const uint8_t *)b->pixels)[i]), 0, 1);
}

/* Decodes what PoCL encodes to the same pixels, and encodes as well. */
static void check_as(const char *platform_name, gscl_mapping mapping) {
    gscl_context *plain = open_as(NULL, GSCL_MAPPING_CPU), *other = open_as(platform_name, mapping);
    gscl_image source = synthetic_image(SYNTHETIC_SHAPES, WIDTH, HEIGHT, 3, GSCL_SAMPLE_U8);
    const file by_plain = encode_with(plain, &source), by_other = encode_with(other, &source);
    gscl_image plain_picture = decode_with(plain, &by_plain), again = decode_with(other, &by_plain);
    gscl_image other_picture = decode_with(plain, &by_other);
    assert_same_picture(&plain_picture, &again);
    assert_true(mean_square(&other_picture, &source) < 1.2 * mean_square(&plain_picture, &source));
    gscl_free(plain_picture.pixels);
    gscl_free(again.pixels);
    gscl_free(other_picture.pixels);
    gscl_free(by_plain.bytes);
    gscl_free(by_other.bytes);
    synthetic_image_free(&source);
    gscl_context_free(&plain);
    gscl_context_free(&other);
}

static void test_rusticl_cpu_mapping(void **state) {
    (void)state;
    check_as("rusticl", GSCL_MAPPING_CPU);
}

static void test_rusticl_gpu_mapping(void **state) {
    (void)state;
    check_as("rusticl", GSCL_MAPPING_GPU);
}

static void test_intel_cpu_mapping(void **state) {
    (void)state;
    check_as("Intel(R) OpenCL", GSCL_MAPPING_CPU);
}

static void test_lanes_follow_the_platform(void **state) {
    (void)state;
    gscl_context *mesa = open_as("rusticl", GSCL_MAPPING_GPU), *unknown = open_as("Somebody's", GSCL_MAPPING_CPU);
    assert_int_equal(gscl_mapping_lanes(mesa), 1);
    assert_int_equal(gscl_splat_lanes(mesa, GSCL_PROGRAM_FIT), 1);
    assert_int_equal(gscl_mapping_lanes(unknown), 16);
    assert_int_equal(gscl_splat_lanes(unknown, GSCL_PROGRAM_FIT), GSCL_MAX_SPLAT_LANES);
    gscl_context_free(&mesa);
    gscl_context_free(&unknown);
}

static void test_mesa_has_no_single_work_items(void **state) {
    (void)state;
    gscl_context *forced = open_as("rusticl", GSCL_MAPPING_CPU), *chosen = open_as("rusticl", GSCL_MAPPING_AUTO);
    gscl_context *unknown = open_as("Somebody's", GSCL_MAPPING_AUTO);
    assert_true(gscl_rdo_group_size(forced) > 1);
    assert_true(gscl_sum_group_size(forced) > 1);
    assert_true(chosen->gpu_mapping);
    assert_false(unknown->gpu_mapping);
    assert_int_equal(gscl_rdo_group_size(unknown), 1);
    gscl_context_free(&forced);
    gscl_context_free(&chosen);
    gscl_context_free(&unknown);
}

/* On a device of smaller groups the lists of bands are made by smaller groups, and are the same. */
static void test_files_do_not_depend_on_the_largest_group(void **state) {
    (void)state;
    gscl_context *contexts[2];
    file files[2];
    gscl_image source = synthetic_image(SYNTHETIC_SHAPES, WIDTH, HEIGHT, 3, GSCL_SAMPLE_U8);
    for (size_t i = 0; i < 2; i++) {
        fake = (fake_opencl){.largest_group = i == 0 ? 4096 : 64};
        contexts[i] = open_opencl(GSCL_MAPPING_GPU);
        fake = (fake_opencl){0};
        assert_int_equal(gscl_band_group_size(contexts[i]), i == 0 ? 256 : 64);
        files[i] = encode_with(contexts[i], &source);
    }
    assert_int_equal(files[0].size, files[1].size);
    assert_memory_equal(files[0].bytes, files[1].bytes, files[0].size);
    for (size_t i = 0; i < 2; i++) {
        gscl_free(files[i].bytes);
        gscl_context_free(&contexts[i]);
    }
    synthetic_image_free(&source);
}

static void test_versions_are_told_apart(void **state) {
    (void)state;
    const char *const pocl = "Portable Computing Language";
    assert_true(gscl_quirks_find(pocl, "OpenCL 3.0 PoCL 3.1  Linux")->own_builtins);
    assert_false(gscl_quirks_find(pocl, "OpenCL 3.0 PoCL 4.0  Linux")->own_builtins);
    assert_true(gscl_quirks_find(pocl, "OpenCL 3.0 PoCL 4.0  Linux")->own_cache);
    assert_false(gscl_quirks_find("Intel(R) OpenCL", "OpenCL 3.0 LINUX")->own_cache);
    assert_true(gscl_quirks_find("rusticl", "OpenCL 3.0 ")->software_fma);
    assert_false(gscl_quirks_find("Somebody's", "PoCL 3.1")->own_builtins);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_versions_are_told_apart),
        cmocka_unit_test(test_lanes_follow_the_platform),
        cmocka_unit_test(test_rusticl_cpu_mapping),
        cmocka_unit_test(test_rusticl_gpu_mapping),
        cmocka_unit_test(test_intel_cpu_mapping),
        cmocka_unit_test(test_mesa_has_no_single_work_items),
        cmocka_unit_test(test_files_do_not_depend_on_the_largest_group),
    };
    fake_opencl_install();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
