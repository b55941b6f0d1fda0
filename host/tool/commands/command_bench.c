/* gscl bench: peak rates of the device, rates of the kernels, and the time of each stage of an encode and a decode. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "cli/device_choice.h"
#include "cli/device_list.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/options.h"
#include "commands/bench_codec.h"
#include "commands/command.h"
#include "image/image_file.h"
#include "image/synthetic_image.h"

#define WIDTH 768 /* pixels, of the scenes and of the synthetic image */
#define HEIGHT 512

typedef struct bench_options {
    device_choice choice;
    uint64_t repetitions, encodes, effort;
    int tune; /* gscl_tune */
    bool as_json;
    const char *image_name; /* NULL: the synthetic image */
} bench_options;

/* The output of all measurements. */
typedef struct bench_output {
    json_writer json;
    bool as_json;
    double peak; /* flop per second of multiply-adds; 0: not yet measured */
} bench_output;

/* Splats of each scene that the kernels are measured on. */
static const uint32_t scenes[] = {500, 2500};
#define SCENE_COUNT (sizeof scenes / sizeof *scenes)

static void print_measurement(const bench_output *output, const gscl_measurement *m) {
    const char *blend = m->blend == GSCL_BLEND_AUTO ? "" : blend_words[m->blend];
    printf("%-17s%-11s", m->name, blend);
    printf("%7u", m->splats);
    printf("%10.3f ms  %8.3f - %-8.3f", 1e3 * m->median_s, 1e3 * m->fastest_s, 1e3 * m->slowest_s);
    printf("%8.2f G%s/s", 1e-9 * m->work / m->median_s, m->unit);
    if (m->flop > 0 && output->peak > 0)
        printf("%6.1f %% of peak", 100 * m->flop / m->median_s / output->peak);
    printf("\n");
}

static void write_measurement(bench_output *output, const gscl_measurement *m) {
    json_writer *json = &output->json;
    json_open_object(json, NULL);
    json_string(json, "name", m->name);
    if (m->blend != GSCL_BLEND_AUTO)
        json_string(json, "blend", blend_words[m->blend]);
    if (m->splats)
        json_integer(json, "splats", m->splats);
    json_real(json, "median_s", m->median_s);
    json_real(json, "fastest_s", m->fastest_s);
    json_real(json, "slowest_s", m->slowest_s);
    json_string(json, "unit", m->unit);
    json_real(json, "work", m->work);
    json_real(json, "work_per_s", m->work / m->median_s);
    if (m->needed > 0)
        json_real(json, "work_per_needed", m->work / m->needed);
    if (m->flop > 0)
        json_real(json, "share_of_peak", m->flop / m->median_s / output->peak);
    json_close_object(json);
}

static void report_measurement(void *opaque, const gscl_measurement *m) {
    bench_output *output = opaque;
    if (strcmp(m->name, "multiply_add") == 0)
        output->peak = m->work / m->median_s;
    if (output->as_json)
        write_measurement(output, m);
    else
        print_measurement(output, m);
}

static gscl_result measure_kernels(gscl_context *context, const bench_options *bench, bench_output *output) {
    gscl_benchmark_settings settings;
    gscl_benchmark_settings_default(&settings);
    settings.width = WIDTH;
    settings.height = HEIGHT;
    settings.repetitions = (uint32_t)bench->repetitions;
    gscl_result result = gscl_benchmark_device(context, &settings, report_measurement, output);
    for (size_t i = 0; i < SCENE_COUNT && result == GSCL_OK; i++) {
        settings.splats = scenes[i];
        result = gscl_benchmark_kernels(context, &settings, report_measurement, output);
    }
    return result;
}

/* The kernels of one mapping of a device, in a context of their own.  Returns the exit code. */
static int bench_mapping(const bench_options *bench, const char *device, gscl_mapping mapping, bench_output *output) {
    device_choice choice = bench->choice;
    gscl_context *context;
    choice.device = device;
    choice.mapping = mapping;
    const int status = open_device(&choice, &context);
    if (status != EXIT_SUCCESS)
        return status;
    if (output->as_json) {
        json_open_object(&output->json, NULL);
        json_string(&output->json, "mapping", mapping_words[mapping]);
        json_open_array(&output->json, "measurements");
    } else {
        printf("\n%s mapping, %dx%d\n%-17s%-11s%7s%13s  %19s%15s\n", mapping_words[mapping], WIDTH, HEIGHT, "", "blend",
               "splats", "median", "fastest - slowest", "rate");
    }
    const gscl_result result = measure_kernels(context, bench, output);
    if (output->as_json) {
        json_close_array(&output->json);
        json_close_object(&output->json);
    }
    const int failed = result == GSCL_OK ? EXIT_SUCCESS : report_result(context, "bench", result);
    gscl_context_free(&context);
    return failed;
}

static int bench_kernels(const bench_options *bench, const char *device, bench_output *output) {
    int status = EXIT_SUCCESS;
    const int last = is_host_device(device) ? GSCL_MAPPING_CPU : GSCL_MAPPING_GPU;
    if (output->as_json)
        json_open_array(&output->json, "kernels");
    for (int mapping = GSCL_MAPPING_CPU; mapping <= last && status == EXIT_SUCCESS; mapping++)
        if (bench->choice.mapping == GSCL_MAPPING_AUTO || bench->choice.mapping == mapping)
            status = bench_mapping(bench, device, (gscl_mapping)mapping, output);
    if (output->as_json)
        json_close_array(&output->json);
    return status;
}

static int bench_image(const bench_options *bench, const gscl_image *image, gscl_context *context,
                       bench_output *output) {
    const bench_codec codec = {.context = context,
                               .image = image,
                               .encodes = (unsigned)bench->encodes,
                               .decodes = (unsigned)bench->repetitions,
                               .effort = (int)bench->effort,
                               .tune = (gscl_tune)bench->tune,
                               .json = output->as_json ? &output->json : NULL};
    const gscl_result result = bench_codec_run(&codec);
    return result == GSCL_OK ? EXIT_SUCCESS
                             : report_result(context, bench->image_name ? bench->image_name : "bench", result);
}

static void print_device(const gscl_context *context, bench_output *output) {
    const gscl_device_info *device = gscl_context_device(context);
    if (!output->as_json) {
        printf("%s: %s, %s, %u %s\n", device->id, device->device_name, device->device_version, device->compute_units,
               is_host_device(device->id) ? "threads" : "compute units");
        return;
    }
    json_string(&output->json, "device", device->device_name);
    json_string(&output->json, "version", device->device_version);
    json_integer(&output->json, "compute_units", device->compute_units);
}

static int run_bench(const bench_options *bench, const gscl_image *image) {
    gscl_context *context;
    bench_output output = {.as_json = bench->as_json};
    int status = open_device(&bench->choice, &context);
    if (status != EXIT_SUCCESS)
        return status;
    json_start(&output.json, stdout);
    if (output.as_json)
        json_open_object(&output.json, NULL);
    print_device(context, &output);
    status = bench_kernels(bench, gscl_context_device(context)->id, &output);
    if (status == EXIT_SUCCESS)
        status = bench_image(bench, image, context, &output);
    if (output.as_json)
        json_close_object(&output.json);
    gscl_context_free(&context);
    return status;
}

static option_outcome parse_bench(bench_options *bench, int argc, char **argv) {
    const option_spec options[] = {
        {.name = "repetitions",
         .kind = OPTION_INTEGER,
         .value = &bench->repetitions,
         .argument = "N",
         .min_integer = 1,
         .max_integer = 1000,
         .help = "measured runs of each kernel and of the decoder (default 20)"},
        {.name = "encodes",
         .kind = OPTION_INTEGER,
         .value = &bench->encodes,
         .argument = "N",
         .min_integer = 1,
         .max_integer = 100,
         .help = "measured runs of the encoder at each rate (default 3)"},
        {.name = "effort",
         .kind = OPTION_INTEGER,
         .value = &bench->effort,
         .argument = "N",
         .max_integer = GSCL_MAX_EFFORT,
         .help = "of the encoder (default 5)"},
        {.name = "tune",
         .kind = OPTION_WORD,
         .value = &bench->tune,
         .words = tune_words,
         .argument = "T",
         .help = "of the encoder (default auto)"},
        DEVICE_OPTIONS(bench->choice),
        {.name = "json", .kind = OPTION_FLAG, .value = &bench->as_json, .help = "write JSON"},
    };
    const option_command command = {
        .name = "bench",
        .usage = "[IMAGE] [options]",
        .about = "Measures this machine: peak rates of the device, rates of the kernels in each mapping, and the time "
                 "of each\n"
                 "stage of an encode and a decode of IMAGE (default: a synthetic image of 768x512 pixels).",
        .options = options,
        .option_count = sizeof options / sizeof *options,
        .max_operands = 1,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome == OPTIONS_RUN && first < argc)
        bench->image_name = argv[first];
    return outcome;
}

int command_bench(int argc, char **argv) {
    bench_options bench = {.choice.timing = true, .repetitions = 20, .encodes = 3, .effort = GSCL_DEFAULT_EFFORT};
    const option_outcome outcome = parse_bench(&bench, argc, argv);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    gscl_image image;
    if (bench.image_name && !image_read(bench.image_name, &image))
        return EXIT_FAILURE;
    if (!bench.image_name && !synthetic_image_make(&image, WIDTH, HEIGHT)) {
        report_error("bench", "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        return EXIT_FAILURE;
    }
    const int status = run_bench(&bench, &image);
    free(image.pixels);
    return status;
}
