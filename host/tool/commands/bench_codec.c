#include "commands/bench_codec.h"

#include <gscl/measure.h>
#include <stdlib.h>

#include "cli/stopwatch.h"

static const double rates[] = {0.042, 0.183}; /* bits per pixel */
#define RATE_COUNT (sizeof rates / sizeof *rates)

/* Kernels that were launched, and calls that waited for the device, in a run. */
typedef struct device_calls {
    double launches, waits;
} device_calls;

static device_calls count_calls(const bench_codec *codec, unsigned runs) {
    device_calls calls = {0, 0};
    for (const gscl_timing *row = gscl_context_timings(codec->context); row; row = row->next) {
        calls.launches += row->is_kernel ? (double)row->count / runs : 0;
        calls.waits += (double)row->waits / runs;
    }
    return calls;
}

static void print_rows(const bench_codec *codec, bool kernels, unsigned runs, double whole) {
    for (const gscl_timing *row = gscl_context_timings(codec->context); row; row = row->next) {
        if (row->is_kernel != kernels || row->count == 0)
            continue;
        const double seconds = row->seconds / runs;
        printf("    %-26s%7.0f x%12.3f ms%7.1f %%", row->name, (double)row->count / runs, 1e3 * seconds,
               100 * seconds / whole);
        if (!kernels)
            printf("%10.3f ms outside kernels%6.0f waits", 1e3 * (seconds - row->kernel_seconds / runs),
                   (double)row->waits / runs);
        else
            printf("%10.0f ms first launches%10.0f work-items, at least%8.0f", 1e3 * row->build_seconds,
                   (double)row->items / (double)row->count, (double)row->fewest_items);
        printf("\n");
    }
}

static void print_text(const bench_codec *codec, const char *operation, double bpp, unsigned runs, spread s) {
    const device_calls calls = count_calls(codec, runs);
    printf("\n%s, %ux%u, %.3f bits per pixel: %.4f s (%.4f - %.4f), %.0f launches, %.0f waits\n  stages\n", operation,
           codec->image->width, codec->image->height, bpp, s.median, s.fastest, s.slowest, calls.launches, calls.waits);
    print_rows(codec, false, runs, s.median);
    printf("  kernels\n");
    print_rows(codec, true, runs, s.median);
}

static void write_rows(const bench_codec *codec, bool kernels, unsigned runs) {
    json_open_array(codec->json, kernels ? "kernels" : "stages");
    for (const gscl_timing *row = gscl_context_timings(codec->context); row; row = row->next) {
        if (row->is_kernel != kernels || row->count == 0)
            continue;
        json_open_object(codec->json, NULL);
        json_string(codec->json, "name", row->name);
        json_real(codec->json, "count", (double)row->count / runs);
        json_real(codec->json, "seconds", row->seconds / runs);
        if (kernels) {
            json_real(codec->json, "build_seconds", row->build_seconds);
            json_real(codec->json, "mean_items", (double)row->items / (double)row->count);
            json_integer(codec->json, "fewest_items", row->fewest_items);
        } else {
            json_real(codec->json, "kernel_seconds", row->kernel_seconds / runs);
            json_real(codec->json, "waits", (double)row->waits / runs);
        }
        json_close_object(codec->json);
    }
    json_close_array(codec->json);
}

static void write_json(const bench_codec *codec, const char *operation, double bpp, unsigned runs, spread s) {
    const device_calls calls = count_calls(codec, runs);
    json_open_object(codec->json, NULL);
    json_string(codec->json, "operation", operation);
    json_integer(codec->json, "width", codec->image->width);
    json_integer(codec->json, "height", codec->image->height);
    json_real(codec->json, "bpp", bpp);
    json_real(codec->json, "median_s", s.median);
    json_real(codec->json, "fastest_s", s.fastest);
    json_real(codec->json, "slowest_s", s.slowest);
    json_real(codec->json, "launches", calls.launches);
    json_real(codec->json, "waits", calls.waits);
    write_rows(codec, false, runs);
    write_rows(codec, true, runs);
    json_close_object(codec->json);
}

/* Timings are means over the runs, whose sums the context keeps. */
static void report_runs(const bench_codec *codec, const char *operation, double bpp, double *seconds, unsigned runs) {
    const spread s = spread_of(seconds, runs);
    if (codec->json)
        write_json(codec, operation, bpp, runs, s);
    else
        print_text(codec, operation, bpp, runs, s);
}

/* Leaves the file of the last run in *bytes. */
static gscl_result bench_encode(const bench_codec *codec, double bpp, double *seconds, uint8_t **bytes, size_t *size) {
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.target = GSCL_TARGET_BPP;
    settings.target_value = bpp;
    settings.effort = codec->effort;
    settings.tune = codec->tune;
    for (unsigned i = 0; i <= codec->encodes; i++) {
        uint8_t *written;
        if (i <= 1)
            gscl_context_reset_timings(codec->context); /* the first run warms up */
        const double start = stopwatch_now();
        const gscl_result result = gscl_encode(codec->context, codec->image, &settings, &written, size, NULL);
        if (result != GSCL_OK)
            return result;
        if (i > 0)
            seconds[i - 1] = stopwatch_now() - start;
        gscl_free(*bytes);
        *bytes = written;
    }
    report_runs(codec, "encode", bpp, seconds, codec->encodes);
    return GSCL_OK;
}

static gscl_result bench_decode(const bench_codec *codec, double bpp, double *seconds, const uint8_t *bytes,
                                size_t size) {
    gscl_image image = {0};
    gscl_result result = GSCL_OK;
    for (unsigned i = 0; i <= codec->decodes && result == GSCL_OK; i++) {
        if (i <= 1)
            gscl_context_reset_timings(codec->context);
        const double start = stopwatch_now();
        result = gscl_decode(codec->context, bytes, size, NULL, &image);
        if (i > 0)
            seconds[i - 1] = stopwatch_now() - start;
    }
    gscl_free(image.pixels);
    if (result == GSCL_OK)
        report_runs(codec, "decode", bpp, seconds, codec->decodes);
    return result;
}

static gscl_result bench_rate(const bench_codec *codec, double bpp, double *seconds) {
    uint8_t *bytes = NULL;
    size_t size = 0;
    gscl_result result = bench_encode(codec, bpp, seconds, &bytes, &size);
    if (result == GSCL_OK)
        result = bench_decode(codec, bpp, seconds, bytes, size);
    gscl_free(bytes);
    return result;
}

gscl_result bench_codec_run(const bench_codec *codec) {
    double *seconds = malloc((codec->encodes + codec->decodes) * sizeof *seconds);
    gscl_result result = seconds ? GSCL_OK : GSCL_ERROR_OUT_OF_MEMORY;
    if (codec->json)
        json_open_array(codec->json, "codec");
    for (size_t i = 0; i < RATE_COUNT && result == GSCL_OK; i++)
        result = bench_rate(codec, rates[i], seconds);
    if (codec->json)
        json_close_array(codec->json);
    free(seconds);
    return result;
}
