/* The device "host" with kernels for the processor: every processor and every number of threads gives the files that golden.txt
 * has the hashes of (golden_cases.h). */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <pthread.h>
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
#include "devices.h"
#include "golden_cases.h"
#include "native/launch.h"
#include "native/machine.h"
#include "native/processor.h"
#include "runtime/launch.h"

#define LENGTH(a) (sizeof(a) / sizeof *(a))
#define MAX_THREADS 3
/* Between files of processors with and without a fused multiply-add, at most: of all cases on average, and of one, whose PSNR
 * differs by 2 dB from one seed to another where splats are few. */
#define MEAN_DB 1.0
#define SINGLE_DB 6.0

/* ---- Encodes --------------------------------------------------------------------------------------- */

static gscl_context *open_host(int threads) {
    gscl_context *context;
    if (golden_open(&context, threads) != GSCL_OK)
        fail_msg("%s", gscl_context_message(context));
    return context;
}

static golden_file encode(gscl_context *context, const golden_case *c) {
    golden_file file;
    if (golden_encode(context, c, &file) != GSCL_OK)
        fail_msg("%s: %s", c->name, gscl_context_message(context));
    return file;
}

/* In a context of its own. */
static golden_file encode_with(const golden_case *c, int threads) {
    gscl_context *context = open_host(threads);
    const golden_file e = encode(context, c);
    gscl_context_free(&context);
    return e;
}

/* ---- golden.txt ------------------------------------------------------------------------------------ */

typedef struct golden {
    uint64_t hash;
    double psnr;
} golden;

static golden *goldens; /* of each case */

/* Reads the line of each case, in their order. */
static int read_goldens(void **state) {
    (void)state;
    FILE *file = fopen(GSCL_GOLDEN, "r");
    if (!file)
        return -1;
    goldens = calloc(golden_case_count, sizeof *goldens);
    bool good = goldens;
    for (size_t i = 0; i < golden_case_count && good; i++) {
        char name[32];
        good = fscanf(file, "%31s %16" SCNx64 " %lf", name, &goldens[i].hash, &goldens[i].psnr) == 3 &&
               strcmp(name, golden_cases[i].name) == 0;
    }
    fclose(file);
    gscl_native_all_threads = true;
    return good ? 0 : -1;
}

static int free_goldens(void **state) {
    (void)state;
    free(goldens);
    return 0;
}

static void check_golden(size_t i, const golden_file *e, const char *how, int threads) {
    if (golden_hash(e) != goldens[i].hash)
        fail_msg(
            "%s, %s, %d threads: hash %016" PRIx64 " of %zu bytes, %.2f dB; golden.txt has %016" PRIx64 ", %.2f dB",
            golden_cases[i].name, how, threads, golden_hash(e), e->size, e->psnr, goldens[i].hash, goldens[i].psnr);
}

static void check_case(size_t i, const char *how, int threads) {
    const golden_file e = encode_with(&golden_cases[i], threads);
    check_golden(i, &e, how, threads);
    gscl_free(e.bytes);
}

/* ---- Files ----------------------------------------------------------------------------------------- */

/* Whether the kernels of a processor give the bytes of golden.txt: not beside code that computes floats with more bits. */
static bool is_golden(const char *processor) {
    return FLT_EVAL_METHOD != 2 && (strcmp(processor, "x86_64_v4") == 0 || strcmp(processor, "x86_64_v3") == 0 ||
                                    strcmp(processor, "aarch64") == 0);
}

/* Those that take a second and more, and with ThreadSanitizer a minute (GOLDEN_SMALL in the environment). */
static bool is_large(const golden_case *c) {
    return c->width * c->height > 65536;
}

/* Each case has another number of threads on the next processor. */
static void test_every_processor_gives_the_same_files(void **state) {
    (void)state;
    for (size_t p = 0; p < gscl_native_processor_count; p++) {
        const char *name = gscl_native_processors[p].name;
        if (!is_golden(name) || !gscl_native_processor_force(name))
            continue;
        for (size_t i = 0; i < golden_case_count; i++)
            if (!is_large(&golden_cases[i]) || !getenv("GOLDEN_SMALL"))
                check_case(i, name, 1 + (int)((i + p) % MAX_THREADS));
        print_message("# %s: %zu files\n", name, golden_case_count);
    }
    assert_true(gscl_native_processor_force(NULL));
}

/* What a file shows, against the image. */
static double decoded_psnr(gscl_context *context, const golden_case *c, const golden_file *e) {
    gscl_decode_settings settings;
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    gscl_image image = golden_picture(c), decoded = {0};
    gscl_decode_settings_default(&settings);
    settings.bare = c->bare;
    settings.sample = image.sample;
    if (gscl_decode(context, e->bytes, e->size, &settings, &decoded) != GSCL_OK)
        fail_msg("%s: %s", c->name, gscl_context_message(context));
    if (decoded.channels == image.channels)
        assert_int_equal(gscl_compare(&image, &decoded, &comparison), GSCL_OK);
    else
        comparison.psnr = e->psnr; /* without chroma */
    gscl_free(decoded.pixels);
    free(image.pixels);
    return comparison.psnr;
}

/* The PSNR of a file less that in golden.txt. */
static double gain_of(size_t i, const char *processor, int threads) {
    gscl_context *context = open_host(threads);
    const golden_file e = encode(context, &golden_cases[i]);
    const double psnr = decoded_psnr(context, &golden_cases[i], &e);
    gscl_free(e.bytes);
    gscl_context_free(&context);
    const double gain = isinf(goldens[i].psnr) && isinf(psnr) ? 0 : psnr - goldens[i].psnr;
    if (!(fabs(gain) <= SINGLE_DB))
        fail_msg("%s, %s: %.2f dB; golden.txt has %.2f dB", golden_cases[i].name, processor, psnr, goldens[i].psnr);
    return gain;
}

/* Kernels that round products give other files, which are as good. */
static void test_other_processors_give_files_as_good(void **state) {
    (void)state;
    for (size_t p = 0; p < gscl_native_processor_count; p++) {
        const char *name = gscl_native_processors[p].name;
        double sum = 0;
        if (is_golden(name) || !gscl_native_processor_force(name))
            continue;
        for (size_t i = 0; i < golden_case_count; i++)
            sum += gain_of(i, name, 1 + (int)(i % MAX_THREADS));
        print_message("# %s: %zu files, %+.2f dB\n", name, golden_case_count, sum / (double)golden_case_count);
        assert_true(fabs(sum / (double)golden_case_count) <= MEAN_DB);
    }
    assert_true(gscl_native_processor_force(NULL));
}

/* Whether the files of the processor that is chosen are those of golden.txt. */
static bool chosen_is_golden(void) {
    return is_golden(gscl_native_processor_choose()->name);
}

/* Cases with much work of different kinds. */
static const char *const chosen_names[] = {"rgb", "default-target", "paper", "tune-ssim", "tune-visual"};

static const golden_case *case_named(const char *name) {
    const golden_case *c = golden_case_named(name);
    assert_non_null(c);
    return c;
}

/* Of one processor; also where launches use as few threads as they are worth. */
static void test_threads_change_nothing(void **state) {
    (void)state;
    for (size_t k = 0; k < LENGTH(chosen_names); k++) {
        const golden_case *c = case_named(chosen_names[k]);
        const golden_file expected = encode_with(c, 1);
        for (int threads = 2; threads <= MAX_THREADS + 1; threads++) {
            gscl_native_all_threads = threads <= MAX_THREADS;
            const golden_file e = encode_with(c, threads);
            gscl_native_all_threads = true;
            if (e.size != expected.size || memcmp(e.bytes, expected.bytes, e.size) != 0)
                fail_msg("%s: %d threads give another file", c->name, threads);
            gscl_free(e.bytes);
        }
        gscl_free(expected.bytes);
    }
}

static void test_general_programs_give_the_same_files(void **state) {
    (void)state;
    for (size_t i = 0; i < golden_case_count; i++) {
        if (is_large(&golden_cases[i]))
            continue;
        gscl_native_general = true;
        const golden_file e = encode_with(&golden_cases[i], 2);
        gscl_native_general = false;
        if (chosen_is_golden()) {
            check_golden(i, &e, "general programs", 2);
        } else {
            const golden_file expected = encode_with(&golden_cases[i], 2);
            assert_int_equal(e.size, expected.size);
            assert_memory_equal(e.bytes, expected.bytes, e.size);
            gscl_free(expected.bytes);
        }
        gscl_free(e.bytes);
    }
}

/* One context has made other files before. */
static void test_earlier_files_change_nothing(void **state) {
    (void)state;
    gscl_context *context = open_host(2);
    for (int round = 0; round < 2; round++)
        for (size_t k = LENGTH(chosen_names); k-- > 0;) {
            const golden_case *c = case_named(chosen_names[k]);
            const golden_file e = encode(context, c);
            const golden_file expected = encode_with(c, 1);
            assert_int_equal(e.size, expected.size);
            assert_memory_equal(e.bytes, expected.bytes, e.size);
            gscl_free(e.bytes);
            gscl_free(expected.bytes);
        }
    gscl_context_free(&context);
}

/* ---- Two contexts at the same time ------------------------------------------------------------------ */

typedef struct job {
    const golden_case *of;
    golden_file made;
    gscl_result result;
} job;

/* Without assertions, which belong to the first thread. */
static void *run_job(void *opaque) {
    job *j = opaque;
    gscl_context *context;
    j->result = golden_open(&context, 2);
    for (int round = 0; round < 3 && j->result == GSCL_OK; round++) {
        gscl_free(j->made.bytes);
        j->result = golden_encode(context, j->of, &j->made);
    }
    gscl_context_free(&context);
    return NULL;
}

/* With general programs, whose options differ. */
static void test_two_contexts_at_once(void **state) {
    (void)state;
    job jobs[] = {{.of = case_named("blend-sum")}, {.of = case_named("paper")}};
    pthread_t threads[LENGTH(jobs)];
    gscl_native_general = true;
    for (size_t i = 0; i < LENGTH(jobs); i++)
        assert_int_equal(pthread_create(&threads[i], NULL, run_job, &jobs[i]), 0);
    for (size_t i = 0; i < LENGTH(jobs); i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    gscl_native_general = false;
    for (size_t i = 0; i < LENGTH(jobs); i++) {
        const golden_file expected = encode_with(jobs[i].of, 1);
        assert_int_equal(jobs[i].result, GSCL_OK);
        assert_int_equal(jobs[i].made.size, expected.size);
        assert_memory_equal(jobs[i].made.bytes, expected.bytes, expected.size);
        gscl_free(jobs[i].made.bytes);
        gscl_free(expected.bytes);
    }
}

/* ---- Kernels --------------------------------------------------------------------------------------- */

/* The kernels of each kind that gscl_kernel_find is asked for. */
static const char *const kernel_names[GSCL_PROGRAM_KINDS][GSCL_NATIVE_MAX_KERNELS] = {
    [GSCL_PROGRAM_RENDER] = {"project", "raster_forward", "raster_samples"},
    [GSCL_PROGRAM_BIN] = {"begin_lists", "bin", "count_links"},
    [GSCL_PROGRAM_FIT] = {"fit_tiles", "step_splats"},
    [GSCL_PROGRAM_GRADIENTS] = {"gather_gradients", "adam_step"},
    [GSCL_PROGRAM_SCALAR_RDO] = {"rdo_begin", "rdo_visit"},
    [GSCL_PROGRAM_CODEBOOK] = {"word_rdo", "book_quantise", "book_apply", "book_step", "position_step"},
    [GSCL_PROGRAM_SSIM] = {"ssim_blur_rows", "ssim_blur_columns", "ssim_derivative", "ssim_window_derivatives",
                           "ssim_evaluate_windows", "ssim_weights", "ssim_contrast_gains"},
    [GSCL_PROGRAM_VISUAL] = {"visual_luminance", "visual_luminance_half", "visual_halve_strip", "visual_luma_row",
                             "visual_statistics_row", "visual_terms_row", "visual_shares", "visual_maps_row",
                             "visual_by_luminance_strip", "visual_derivative", "visual_model"},
    [GSCL_PROGRAM_IMAGE] = {"halve", "weigh_columns", "add_columns", "place_splats", "box_rows", "box_columns",
                            "edge_strength", "seed_density", "sum_loss", "squared_error", "sum_groups", "sum_plane",
                            "sum_squared_error", "control_fit", "level_residual", "add_enlarged", "raise_contrast"},
    [GSCL_PROGRAM_BENCHMARK] = {"multiply_add", "copy"},
};

static void check_kind(const gscl_native_processor *processor, gscl_program_kind kind,
                       const gscl_kernel_options *options) {
    for (const char *const *name = kernel_names[kind]; *name; name++) {
        const gscl_native_kernel *kernel = gscl_native_find(processor, kind, options, *name);
        if (!kernel || !kernel->function || kernel->argument_count == 0)
            fail_msg("%s lacks %s of kind %d, colours %d, alpha %d", processor->name, *name, (int)kind,
                     options->colours, options->alpha_channel);
    }
}

/* For one set of channels all other options that an encode may have. */
static void check_options(const gscl_native_processor *processor, gscl_kernel_options options) {
    for (int variant = 0; variant < 3 * 2 * 2 * 3 * 3 * 3; variant++) {
        options.blend = variant % 3;
        options.opacity = variant / 3 % 2;
        options.texture = variant / 6 % 2;
        options.shape = variant / 12 % 3;
        options.loss = variant / 36 % 3;
        options.weighted = variant / 108;
        for (int kind = 0; kind < GSCL_PROGRAM_BENCHMARK; kind++)
            check_kind(processor, (gscl_program_kind)kind, &options);
    }
}

static void test_every_kernel_is_found(void **state) {
    (void)state;
    for (size_t p = 0; p < gscl_native_processor_count; p++)
        for (int general = 0; general < 2; general++) {
            gscl_native_general = general;
            for (int channels = 1; channels <= 4; channels++)
                check_options(&gscl_native_processors[p], (gscl_kernel_options){.colours = channels < 3 ? 1 : 3,
                                                                                .alpha_channel = channels % 2 == 0});
            check_kind(&gscl_native_processors[p], GSCL_PROGRAM_BENCHMARK, &(gscl_kernel_options){.colours = 1});
            check_kind(&gscl_native_processors[p], GSCL_PROGRAM_IMAGE, &(gscl_kernel_options){0});
        }
    gscl_native_general = false;
}

/* Those in the table are in kernel_names: that has all. */
static void test_every_kernel_is_asked_for(void **state) {
    (void)state;
    const gscl_native_processor *processor = gscl_native_processor_choose();
    for (size_t i = 0; i < processor->program_count; i++)
        for (const gscl_native_kernel *kernel = processor->programs[i].kernels; kernel->name; kernel++) {
            const char *const *name = kernel_names[processor->programs[i].kind];
            while (*name && strcmp(*name, kernel->name) != 0)
                name++;
            if (!*name)
                fail_msg("%s of kind %d", kernel->name, (int)processor->programs[i].kind);
        }
}

/* ---- Settings and refusals --------------------------------------------------------------------------- */

static void test_number_of_threads(void **state) {
    (void)state;
    const int all = gscl_native_thread_count();
    assert_in_range(all, 1, GSCL_MAX_THREADS);
    const int asked[] = {0, 1, 7, GSCL_MAX_THREADS};
    for (size_t i = 0; i < LENGTH(asked); i++) {
        gscl_context *context = open_host(asked[i]);
        assert_int_equal(gscl_context_device(context)->compute_units, asked[i] ? asked[i] : all);
        gscl_context_free(&context);
    }
    const int wrong[] = {-1, GSCL_MAX_THREADS + 1, INT32_MIN, INT32_MAX};
    for (size_t i = 0; i < LENGTH(wrong); i++) {
        gscl_context *context;
        gscl_context_settings settings;
        gscl_context_settings_default(&settings);
        settings.threads = wrong[i];
        assert_int_equal(gscl_context_create(&context, &settings), GSCL_ERROR_INVALID_ARGUMENT);
        assert_non_null(strstr(gscl_context_message(context), "threads"));
        gscl_context_free(&context);
    }
}

static void test_gpu_mapping_is_refused(void **state) {
    (void)state;
    gscl_context *context;
    assert_false(open_on(&context, GSCL_HOST_DEVICE, GSCL_MAPPING_GPU));
    assert_non_null(strstr(gscl_context_message(context), "have the CPU mapping"));
    gscl_context_free(&context);
    assert_true(open_on(&context, GSCL_HOST_DEVICE, GSCL_MAPPING_CPU));
    gscl_context_free(&context);
    assert_false(open_on(&context, "hos", GSCL_MAPPING_AUTO));
    gscl_context_free(&context);
}

static void test_the_device_is_listed_last(void **state) {
    (void)state;
    gscl_device_info *devices;
    assert_int_equal(gscl_list_devices(&devices), GSCL_OK);
    const gscl_device_info *last = devices;
    while (last->next)
        last = last->next;
    assert_string_equal(last->id, GSCL_HOST_DEVICE);
    assert_true(strstr(last->device_name, gscl_native_processor_choose()->name) && last->memory_bytes > 0);
    gscl_free(devices);
}

static void count_measurement(void *opaque, const gscl_measurement *measurement) {
    assert_true(measurement->fastest_s > 0);
    ++*(int *)opaque;
}

static void test_benchmarks(void **state) {
    (void)state;
    gscl_context *context;
    gscl_context_settings settings;
    gscl_benchmark_settings few;
    int measurements = 0;
    gscl_context_settings_default(&settings);
    settings.device = GSCL_HOST_DEVICE;
    settings.timing = true;
    assert_int_equal(gscl_context_create(&context, &settings), GSCL_OK);
    gscl_benchmark_settings_default(&few);
    few.width = few.height = 64;
    few.splats = 50;
    few.repetitions = 1;
    if (gscl_benchmark_device(context, &few, count_measurement, &measurements) != GSCL_OK)
        fail_msg("%s", gscl_context_message(context));
    assert_int_equal(measurements, 2);
    assert_int_equal(gscl_benchmark_kernels(context, &few, count_measurement, &measurements), GSCL_OK);
    assert_true(measurements > 2);
    gscl_context_free(&context);
}

static void ignore_accuracy(void *opaque, const gscl_accuracy *accuracy) {
    (void)opaque, (void)accuracy;
}

static void ignore_gradient(void *opaque, const gscl_gradient_accuracy *accuracy) {
    (void)opaque, (void)accuracy;
}

/* Of kernels that are not compiled. */
static void test_other_precision_is_refused(void **state) {
    (void)state;
    const golden_case *c = case_named("rgb");
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = GSCL_HOST_DEVICE;
    settings.timing = true;
    assert_int_equal(gscl_context_create(&context, &settings), GSCL_OK);
    const golden_file e = encode(context, c);
    gscl_image image = golden_picture(c);
    assert_int_equal(gscl_measure_accuracy(context, &image, e.bytes, e.size, NULL, ignore_accuracy, NULL),
                     GSCL_ERROR_KERNEL_BUILD);
    assert_non_null(strstr(gscl_context_message(context), "need an OpenCL device"));
    assert_int_equal(gscl_measure_gradients(context, &image, e.bytes, e.size, NULL, ignore_gradient, NULL),
                     GSCL_ERROR_KERNEL_BUILD);
    free(image.pixels);
    gscl_free(e.bytes);
    gscl_context_free(&context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_processor_gives_the_same_files),
        cmocka_unit_test(test_other_processors_give_files_as_good),
        cmocka_unit_test(test_threads_change_nothing),
        cmocka_unit_test(test_general_programs_give_the_same_files),
        cmocka_unit_test(test_earlier_files_change_nothing),
        cmocka_unit_test(test_two_contexts_at_once),
        cmocka_unit_test(test_every_kernel_is_found),
        cmocka_unit_test(test_every_kernel_is_asked_for),
        cmocka_unit_test(test_number_of_threads),
        cmocka_unit_test(test_gpu_mapping_is_refused),
        cmocka_unit_test(test_the_device_is_listed_last),
        cmocka_unit_test(test_benchmarks),
        cmocka_unit_test(test_other_precision_is_refused),
    };
    return cmocka_run_group_tests(tests, read_goldens, free_goldens);
}
