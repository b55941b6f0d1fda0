/* Programs that another thread builds ahead of their use (opencl/prefetch.h): they are taken, kept, left out or dropped as
 * the case is, and one that cannot be built fails where it is needed. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "cl/constants.h"
#include "devices.h"
#include "opencl/opencl_device.h"
#include "opencl/prefetch.h"
#include "opencl/program.h"
#include "runtime/launch.h"

#define LENGTH(a) (sizeof(a) / sizeof *(a))

static const gscl_program_request image_request = {.kind = GSCL_PROGRAM_IMAGE},
                                  bin_request = {.kind = GSCL_PROGRAM_BIN};
static const gscl_quirks aside = {.own_builtins = true, .own_cache = true, .builds_aside = true},
                         not_aside = {.own_builtins = true, .own_cache = true};

/* Messages that say how a program was built. */
typedef struct log_counts {
    int built, aside;
} log_counts;

static void count_builds(void *opaque, gscl_log_level level, const char *text) {
    log_counts *counts = opaque;
    (void)level;
    counts->built += strncmp(text, "built a program in", 18) == 0;
    counts->aside += strncmp(text, "in another thread: built a program in", 37) == 0;
}

static gscl_context *open_with(const gscl_quirks *quirks, log_counts *counts) {
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = first_opencl_device();
    settings.log = count_builds;
    settings.log_opaque = counts;
    *counts = (log_counts){0, 0};
    assert_int_equal(gscl_context_create(&context, &settings), GSCL_OK);
    gscl_opencl(context)->quirks = quirks;
    return context;
}

/* A context that was asked for the two programs, in this order. */
static gscl_context *open_asking_for_image_and_bin(log_counts *counts) {
    gscl_context *context = open_with(&aside, counts);
    const gscl_program_request requests[] = {image_request, bin_request};
    gscl_prefetch(context, requests, LENGTH(requests));
    return context;
}

static void need(gscl_context *context, const gscl_program_request *request, const char *kernel_name) {
    gscl_kernel *kernel;
    assert_int_equal(gscl_kernel_find(context, request->kind, &request->options, kernel_name, &kernel), GSCL_OK);
    assert_non_null(kernel);
}

static size_t count_programs(const gscl_context *context) {
    size_t count = 0;
    for (const struct gscl_program *p = gscl_opencl(context)->programs; p; p = p->next)
        count++;
    return count;
}

static void test_programs_are_taken(void **state) {
    (void)state;
    log_counts counts;
    gscl_context *context = open_asking_for_image_and_bin(&counts);
    need(context, &bin_request, "bin");
    need(context, &image_request, "sum_squared_error");
    need(context, &image_request, "halve");
    assert_int_equal(counts.aside, 2);
    assert_int_equal(counts.built, 0);
    assert_int_equal(count_programs(context), 2);
    gscl_context_free(&context);
}

/* The context keeps those that were built and not needed. */
static void test_programs_are_kept(void **state) {
    (void)state;
    log_counts counts;
    gscl_context *context = open_asking_for_image_and_bin(&counts);
    need(context, &bin_request, "bin"); /* the last one: both are built */
    gscl_prefetch_end(context);
    assert_null(gscl_opencl(context)->prefetch);
    assert_int_equal(count_programs(context), 2);
    need(context, &image_request, "sum_squared_error");
    assert_int_equal(counts.built, 0);
    gscl_context_free(&context);
}

static void test_programs_that_are_there_are_left_out(void **state) {
    (void)state;
    log_counts counts;
    gscl_context *context = open_with(&aside, &counts);
    need(context, &image_request, "sum_squared_error");
    gscl_prefetch(context, &image_request, 1);
    assert_null(gscl_opencl(context)->prefetch);
    for (int i = 0; i < 2; i++)
        gscl_prefetch(context, &bin_request, 1);
    need(context, &bin_request, "bin");
    gscl_prefetch_end(context);
    assert_int_equal(count_programs(context), 2);
    gscl_context_free(&context);
}

/* What is beyond the largest number is built when it is needed. */
static void test_many_requests(void **state) {
    (void)state;
    log_counts counts;
    gscl_context *context = open_with(&aside, &counts);
    gscl_program_request requests[GSCL_MAX_PREFETCHED + 1];
    for (int i = 0; i < (int)LENGTH(requests); i++)
        requests[i] = (gscl_program_request){GSCL_PROGRAM_RENDER, {.colours = 1, .blend = i / 3, .shape = i % 3}};
    gscl_prefetch(context, requests, LENGTH(requests));
    need(context, &requests[LENGTH(requests) - 1], "project");
    assert_int_equal(counts.built, 1);
    need(context, &requests[LENGTH(requests) - 2], "project");
    assert_int_equal(counts.aside, 1);
    gscl_context_free(&context);
}

/* The context is freed while a program is being built, and others wait. */
static void test_requests_are_dropped(void **state) {
    (void)state;
    log_counts counts;
    gscl_context *context = open_asking_for_image_and_bin(&counts);
    gscl_context_free(&context);
    assert_null(context);
}

/* It is built again, with the message of the compiler. */
static void test_a_program_that_cannot_be_built(void **state) {
    (void)state;
    const gscl_program_request bad = {GSCL_PROGRAM_RENDER,
                                      {.colours = 3, .blend = GSCL_ALPHA, .early_stop = (double)INFINITY}};
    for (int is_aside = 0; is_aside < 2; is_aside++) {
        log_counts counts;
        gscl_kernel *kernel;
        gscl_context *context = open_with(is_aside ? &aside : &not_aside, &counts);
        gscl_prefetch(context, &bad, 1);
        assert_true((gscl_opencl(context)->prefetch != NULL) == (is_aside != 0));
        assert_int_equal(gscl_kernel_find(context, bad.kind, &bad.options, "raster_forward", &kernel),
                         GSCL_ERROR_KERNEL_BUILD);
        assert_non_null(strstr(gscl_context_message(context), "could not build the kernels"));
        gscl_prefetch_end(context);
        assert_int_equal(count_programs(context), 0);
        gscl_context_free(&context);
    }
}

static void test_other_implementations_build_when_needed(void **state) {
    (void)state;
    log_counts counts;
    gscl_context *context = open_with(&not_aside, &counts);
    gscl_prefetch(context, &image_request, 1);
    assert_null(gscl_opencl(context)->prefetch);
    need(context, &image_request, "sum_squared_error");
    assert_int_equal(counts.built, 1);
    gscl_context_free(&context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_programs_are_taken),
        cmocka_unit_test(test_programs_are_kept),
        cmocka_unit_test(test_programs_that_are_there_are_left_out),
        cmocka_unit_test(test_many_requests),
        cmocka_unit_test(test_requests_are_dropped),
        cmocka_unit_test(test_a_program_that_cannot_be_built),
        cmocka_unit_test(test_other_implementations_build_when_needed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
