/* Programs are kept from one context to the next.  PoCL takes the place of an implementation that keeps none: it gets
 * another name, and its binaries are replaced by numbers of sources. */
#define _XOPEN_SOURCE 700
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>
#include <unistd.h>

#include "devices.h"
#include "opencl/library.h"

#define WIDTH 24
#define HEIGHT 16
#define MAX_FILES 24
#define MAX_PROGRAMS 256

/* The texts of a program, which the library keeps for the whole process. */
typedef struct source {
    cl_program program; /* the last one of these texts */
    cl_uint count;
    const char *texts[MAX_FILES];
    size_t lengths[MAX_FILES];
} source;

static source sources[MAX_PROGRAMS];
static unsigned source_count;

/* Of the current test. */
static bool is_pocl;       /* the platform has its own name */
static bool refuse_binary; /* clCreateProgramWithBinary fails */
static const char *driver; /* the version of the platform; NULL: its own */
static unsigned from_sources, from_binaries;
static int begun, ended; /* phases of building */

static char top[] = "/tmp/gscl-cache-XXXXXX";
static char folder[64];
static uint8_t *file;
static size_t file_size;

/* The functions of the library. */
static gscl_cl_functions real;

static cl_int CL_API_CALL get_platform_info(cl_platform_id platform, cl_platform_info parameter, size_t size,
                                            void *value, size_t *needed) {
    const char *text = parameter == CL_PLATFORM_NAME && !is_pocl ? "Forgetful" : NULL;
    if (parameter == CL_PLATFORM_VERSION)
        text = driver;
    if (!text)
        return real.clGetPlatformInfo(platform, parameter, size, value, needed);
    if (needed)
        *needed = strlen(text) + 1;
    if (value && size < strlen(text) + 1)
        return CL_INVALID_VALUE;
    if (value)
        memcpy(value, text, strlen(text) + 1);
    return CL_SUCCESS;
}

static cl_program CL_API_CALL create_with_source(cl_context context, cl_uint count, const char **texts,
                                                 const size_t *lengths, cl_int *error) {
    assert_true(source_count < MAX_PROGRAMS && count <= MAX_FILES);
    source *s = &sources[source_count++];
    s->program = real.clCreateProgramWithSource(context, count, texts, lengths, error);
    s->count = count;
    memcpy(s->texts, texts, count * sizeof *texts);
    memcpy(s->lengths, lengths, count * sizeof *lengths);
    from_sources++;
    return s->program;
}

static cl_program CL_API_CALL create_with_binary(cl_context context, cl_uint count, const cl_device_id *devices,
                                                 const size_t *lengths, const unsigned char **binaries, cl_int *status,
                                                 cl_int *error) {
    unsigned number = MAX_PROGRAMS;
    (void)devices;
    assert_int_equal(count, 1);
    assert_int_equal(lengths[0], sizeof number);
    memcpy(&number, binaries[0], sizeof number);
    assert_true(number < source_count);
    *status = *error = refuse_binary ? CL_INVALID_BINARY : CL_SUCCESS;
    if (refuse_binary)
        return NULL;
    source *s = &sources[number];
    from_binaries++;
    return s->program = real.clCreateProgramWithSource(context, s->count, s->texts, s->lengths, error);
}

static cl_int CL_API_CALL get_program_info(cl_program program, cl_program_info parameter, size_t size, void *value,
                                           size_t *needed) {
    unsigned number = source_count;
    (void)size;
    (void)needed;
    assert_false(is_pocl); /* PoCL would build slow variants */
    while (number > 0 && sources[--number].program != program) {
    }
    if (parameter == CL_PROGRAM_BINARY_SIZES)
        memcpy(value, &(size_t){sizeof number}, sizeof(size_t));
    else if (parameter == CL_PROGRAM_BINARIES)
        memcpy(*(unsigned char **)value, &number, sizeof number);
    else
        fail_msg("parameter %u", (unsigned)parameter);
    return CL_SUCCESS;
}

static void replace_functions(void) {
    if (gscl_opencl_library())
        return; /* there are no devices */
    real = gscl_cl;
    gscl_cl.clGetPlatformInfo = get_platform_info;
    gscl_cl.clCreateProgramWithSource = create_with_source;
    gscl_cl.clCreateProgramWithBinary = create_with_binary;
    gscl_cl.clGetProgramInfo = get_program_info;
}

static void count_build(void *opaque, bool begins) {
    assert_ptr_equal(opaque, folder);
    assert_int_equal(begun, ended + !begins);
    begins ? begun++ : ended++;
}

static gscl_context *open_context(const char *cache, gscl_mapping mapping) {
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    assert_null(settings.cache_folder);
    settings.device = first_opencl_device();
    settings.cache_folder = cache;
    settings.mapping = mapping;
    settings.build = count_build;
    settings.build_opaque = folder;
    assert_int_equal(gscl_context_create(&context, &settings), GSCL_OK);
    from_sources = from_binaries = 0;
    begun = ended = 0;
    return context;
}

/* Decodes in a context of its own and returns the hash of the pixels; counts start anew. */
static uint32_t decode(const char *cache, gscl_mapping mapping) {
    gscl_image image = {0};
    gscl_context *context = open_context(cache, mapping);
    assert_int_equal(gscl_decode(context, file, file_size, NULL, &image), GSCL_OK);
    uint32_t hash = 5381;
    for (size_t i = 0; i < 3 * WIDTH * HEIGHT; i++)
        hash = hash * 33 + ((const uint8_t *)image.pixels)[i];
    gscl_free(image.pixels);
    gscl_context_free(&context);
    return hash;
}

static int make_file(void **state) {
    (void)state;
    static uint8_t pixels[3 * WIDTH * HEIGHT];
    for (size_t i = 0; i < sizeof pixels; i++)
        pixels[i] = (uint8_t)(i * i / 7);
    const gscl_image image = {WIDTH, HEIGHT, 3, GSCL_SAMPLE_U8, 0, false, pixels, GSCL_LAYOUT_RGB};
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.effort = 0;
    is_pocl = true;
    gscl_context *context = open_context(NULL, GSCL_MAPPING_AUTO);
    const gscl_result result = gscl_encode(context, &image, &settings, &file, &file_size, NULL);
    gscl_context_free(&context);
    if (!mkdtemp(top))
        return -1;
    snprintf(folder, sizeof folder, "%s/kernels", top);
    return result;
}

static int remove_cache(void **state) {
    (void)state;
    char command[64];
    is_pocl = refuse_binary = false;
    driver = NULL;
    snprintf(command, sizeof command, "rm -rf %s/*", top);
    return system(command);
}

static int remove_top(void **state) {
    gscl_free(file);
    return remove_cache(state) != 0 || rmdir(top) != 0;
}

static bool has_folder(void) {
    return access(folder, F_OK) == 0;
}

static void test_second_context_builds_nothing(void **state) {
    (void)state;
    const uint32_t pixels = decode(folder, GSCL_MAPPING_AUTO);
    assert_true(from_sources > 0 && from_binaries == 0);
    const unsigned programs = from_sources;
    assert_true(begun >= (int)programs && ended == begun); /* more where launches build, too */
    assert_int_equal(decode(folder, GSCL_MAPPING_AUTO), pixels);
    assert_int_equal(from_sources, 0);
    assert_int_equal(from_binaries, programs);
    assert_int_equal(begun, 0);
}

static void test_without_a_folder_nothing_is_kept(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        decode(i == 0 ? NULL : "", GSCL_MAPPING_AUTO);
        assert_true(from_sources > 0 && from_binaries == 0);
    }
    assert_false(has_folder());
}

static void test_pocl_is_left_to_its_own_cache(void **state) {
    (void)state;
    is_pocl = true;
    decode(folder, GSCL_MAPPING_AUTO);
    decode(folder, GSCL_MAPPING_AUTO);
    assert_true(from_sources > 0 && from_binaries == 0);
    assert_false(has_folder());
}

static void test_other_options_and_drivers_are_other_programs(void **state) {
    (void)state;
    decode(folder, GSCL_MAPPING_CPU);
    decode(folder, GSCL_MAPPING_GPU);
    assert_true(from_sources > 0 && from_binaries == 0);
    driver = "Forgetful 2.0";
    decode(folder, GSCL_MAPPING_GPU);
    assert_true(from_sources > 0 && from_binaries == 0);
    decode(folder, GSCL_MAPPING_GPU);
    assert_true(from_sources == 0 && from_binaries > 0);
    driver = "Forgetful 2.1";
    decode(folder, GSCL_MAPPING_GPU);
    assert_true(from_sources > 0 && from_binaries == 0);
}

static void test_refused_binaries_are_built_anew(void **state) {
    (void)state;
    const uint32_t pixels = decode(folder, GSCL_MAPPING_AUTO);
    refuse_binary = true;
    assert_int_equal(decode(folder, GSCL_MAPPING_AUTO), pixels);
    assert_true(from_sources > 0 && from_binaries == 0);
    refuse_binary = false;
    decode(folder, GSCL_MAPPING_AUTO);
    assert_true(from_sources == 0 && from_binaries > 0);
}

static void test_unusable_folder_costs_time_only(void **state) {
    (void)state;
    const uint32_t pixels = decode(NULL, GSCL_MAPPING_AUTO);
    FILE *stream = fopen(folder, "w");
    assert_non_null(stream);
    fclose(stream);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(decode(folder, GSCL_MAPPING_AUTO), pixels);
        assert_true(from_sources > 0 && from_binaries == 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_second_context_builds_nothing, remove_cache),
        cmocka_unit_test_setup(test_without_a_folder_nothing_is_kept, remove_cache),
        cmocka_unit_test_setup(test_pocl_is_left_to_its_own_cache, remove_cache),
        cmocka_unit_test_setup(test_other_options_and_drivers_are_other_programs, remove_cache),
        cmocka_unit_test_setup(test_refused_binaries_are_built_anew, remove_cache),
        cmocka_unit_test_setup(test_unusable_folder_costs_time_only, remove_cache),
    };
    replace_functions();
    return cmocka_run_group_tests(tests, make_file, remove_top);
}
