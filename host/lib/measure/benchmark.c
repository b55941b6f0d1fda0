/* The speed of the device and of the kernels of drawing and fitting. */
#include <gscl/measure.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/blend.h"
#include "decode/ellipse.h"
#include "fit/fit.h"
#include "fit/random.h"
#include "host/system/clock.h"
#include "measure/tunables.h"
#include "runtime/mapping.h"
#include "runtime/struct_size.h"
#include "runtime/timing.h"
#include "runtime/vectors.h"

#define MAX_SERIES 12
#define MAX_REPETITIONS 1000
#define MULTIPLY_ADD_FLOP (2.0 * GSCL_BENCHMARK_CHAINS * GSCL_BENCHMARK_LENGTH) /* of each lane (cl/benchmark.cl) */

/* Samples of one kernel, or of a whole run, in seconds. */
typedef struct series {
    const char *name;
    size_t count;
    double samples[MAX_REPETITIONS];
} series;

typedef struct bench {
    gscl_context *context;
    gscl_benchmark_settings settings;
    gscl_measurement_callback callback;
    void *opaque;
    gscl_measurement about; /* fields that the next measurements share */
    int rounds;             /* of what is measured, in one run; samples are means of them */
    size_t count;
    series series[MAX_SERIES];
} bench;

typedef gscl_result bench_run(bench *b, void *opaque);

static void add_sample(bench *b, const char *name, double seconds) {
    size_t i = 0;
    while (i < b->count && strcmp(b->series[i].name, name) != 0)
        i++;
    if (i == MAX_SERIES)
        return;
    if (i == b->count)
        b->series[b->count++] = (series){.name = name};
    b->series[i].samples[b->series[i].count++] = seconds;
}

/* Runs `run` repeatedly and collects samples of the whole run, as `name`, and of each kernel. */
static gscl_result take_samples(bench *b, const char *name, bench_run *run, void *opaque) {
    b->count = 0;
    const uint32_t warm_up = gscl_measure_tunables.warm_up_runs;
    for (uint32_t i = 0; i < warm_up + b->settings.repetitions; i++) {
        gscl_context_reset_timings(b->context);
        double start = gscl_now();
        gscl_stage(b->context, GSCL_STAGE_MEASURE);
        GSCL_TRY(run(b, opaque));
        gscl_stage(b->context, GSCL_STAGE_NONE);
        if (i < warm_up)
            continue;
        add_sample(b, name, (gscl_now() - start) / b->rounds);
        for (const gscl_timing *row = gscl_context_timings(b->context); row; row = row->next)
            if (row->is_kernel && row->count > 0)
                add_sample(b, row->name, row->seconds / b->rounds);
    }
    return GSCL_OK;
}

/* Reports the samples of `name` to the caller. */
static void report_samples(bench *b, const char *name, double work, double flop) {
    for (size_t i = 0; i < b->count; i++) {
        series *s = &b->series[i];
        if (strcmp(s->name, name) != 0)
            continue;
        gscl_sort_samples(s->samples, s->count);
        gscl_measurement m = b->about;
        m.name = s->name;
        m.work = work;
        m.flop = flop;
        m.median_s = s->samples[s->count / 2];
        m.fastest_s = s->samples[0];
        m.slowest_s = s->samples[s->count - 1];
        b->callback(b->opaque, &m);
    }
}

/* ---- Peak rates of the device ---- */

static gscl_result run_multiply_add(bench *b, void *opaque) {
    const gscl_buffer *sums = opaque;
    const gscl_kernel_options options = {.colours = 1};
    gscl_kernel *kernel;
    float factor = 0.999f;
    GSCL_TRY(gscl_kernel_find(b->context, GSCL_PROGRAM_BENCHMARK, &options, "multiply_add", &kernel));
    return GSCL_LAUNCH(b->context, kernel, gscl_measure_tunables.multiply_add_items / GSCL_BENCHMARK_GROUP,
                       GSCL_BENCHMARK_GROUP, GSCL_ARG(factor), GSCL_ARG_BUFFER(*sums));
}

static gscl_result run_copy(bench *b, void *opaque) {
    const gscl_buffer *buffers = opaque;
    const gscl_kernel_options options = {.colours = 1};
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(b->context, GSCL_PROGRAM_BENCHMARK, &options, "copy", &kernel));
    size_t items = gscl_measure_tunables.copy_bytes / sizeof(float) / (size_t)gscl_mapping_lanes(b->context);
    return GSCL_LAUNCH(b->context, kernel, items / GSCL_BENCHMARK_GROUP, GSCL_BENCHMARK_GROUP,
                       GSCL_ARG_BUFFER(buffers[0]), GSCL_ARG_BUFFER(buffers[1]));
}

static gscl_result measure_device(bench *b, gscl_buffer *buffers) {
    double flop = MULTIPLY_ADD_FLOP * gscl_measure_tunables.multiply_add_items * gscl_mapping_lanes(b->context);
    for (int i = 0; i < 2; i++) {
        GSCL_TRY(gscl_buffer_reserve(b->context, &buffers[i], gscl_measure_tunables.copy_bytes));
        GSCL_TRY(gscl_buffer_zero(b->context, &buffers[i], 0, gscl_measure_tunables.copy_bytes));
    }
    b->about.unit = "flop";
    GSCL_TRY(take_samples(b, "whole", run_multiply_add, &buffers[0]));
    report_samples(b, "multiply_add", flop, flop);
    b->about.unit = "byte";
    GSCL_TRY(take_samples(b, "whole", run_copy, buffers));
    report_samples(b, "copy", 2.0 * gscl_measure_tunables.copy_bytes, 0);
    return GSCL_OK;
}

/* ---- Kernels of drawing and fitting ---- */

/* Roughly normal, of variance 1. */
static float random_normal(uint64_t *random) {
    float sum = 0;
    for (int i = 0; i < 12; i++)
        sum += gscl_random_unit(random);
    return sum - 6;
}

/* Splats with sizes and shapes like those of fitted splats: many small ones, some large, most of them elongated. */
static void make_scene(const gscl_benchmark_settings *s, float *params) {
    uint64_t random = 1;
    float spacing = sqrtf((float)s->width * (float)s->height / (float)s->splats);
    memset(params, 0, (size_t)s->splats * GSCL_PARAMS * sizeof *params);
    for (uint32_t i = 0; i < s->splats; i++, params += GSCL_PARAMS) {
        float size = logf(0.27f * spacing) + 0.8f * random_normal(&random);
        float stretch = fminf(0.9f * fabsf(random_normal(&random)), 2.0f); /* half of ln aspect */
        params[GSCL_X] = gscl_random_unit(&random) * (float)s->width;
        params[GSCL_Y] = gscl_random_unit(&random) * (float)s->height;
        params[GSCL_LOG_S1] = fmaxf(size + stretch, logf(0.5f));
        params[GSCL_LOG_S2] = fmaxf(size - stretch, logf(0.5f));
        params[GSCL_THETA] = 3.14159265f * gscl_random_unit(&random);
        for (int k = 0; k < 3; k++)
            params[GSCL_COLOUR + k] = gscl_random_unit(&random);
    }
}

/* Pixels inside the outlines of splats: the evaluations that any renderer needs. */
static double pixels_inside(const gscl_benchmark_settings *s, const float *params) {
    double inside = 0;
    for (uint32_t i = 0; i < s->splats; i++, params += GSCL_PARAMS) {
        double c = cos(params[GSCL_THETA]), n = sin(params[GSCL_THETA]), reach = sqrt(2.0 * GSCL_SUPPORT);
        double s1 = exp(params[GSCL_LOG_S1]), s2 = exp(params[GSCL_LOG_S2]);
        double half =
            gscl_ellipse_half_size(params[GSCL_LOG_S1], params[GSCL_LOG_S2], params[GSCL_THETA], 0, reach).height;
        double x = params[GSCL_X], y = params[GSCL_Y], to = fmin(y + half, s->height);
        for (int row = (int)fmax(ceil(y - half - 0.5), 0); row + 0.5 < to; row++) {
            /* the chord of the ellipse at this row */
            double dy = row + 0.5 - y, a = c * c / (s1 * s1) + n * n / (s2 * s2),
                   b = c * n * (1 / (s1 * s1) - 1 / (s2 * s2)) * dy,
                   d = (n * n / (s1 * s1) + c * c / (s2 * s2)) * dy * dy - reach * reach, root = b * b - a * d;
            if (root <= 0)
                continue;
            double left = fmax(ceil(x - (b + sqrt(root)) / a - 0.5), 0),
                   right = fmin(floor(x - (b - sqrt(root)) / a - 0.5), s->width - 1.0);
            inside += fmax(right - left + 1, 0);
        }
    }
    return inside;
}

/* Evaluations of the kernels: whole rows of tiles for each entry of a list. */
static gscl_result count_evaluations(const gscl_renderer *r, double *evaluations) {
    size_t tiles = gscl_renderer_tiles(r);
    gscl_int2 *ranges = malloc(tiles * sizeof *ranges);
    uint32_t *entries = malloc(r->entries.size);
    gscl_result result = ranges && entries ? GSCL_OK : gscl_fail_memory(r->context);
    if (result == GSCL_OK)
        result = gscl_buffer_read(r->context, &r->tile_ranges, 0, ranges, tiles * sizeof *ranges);
    if (result == GSCL_OK)
        result = gscl_buffer_read(r->context, &r->entries, 0, entries, r->entries.size);
    *evaluations = 0;
    for (size_t tile = 0; tile < tiles && result == GSCL_OK; tile++)
        for (int32_t i = ranges[tile].s[0]; i < ranges[tile].s[1]; i++)
            *evaluations += GSCL_TILE * (GSCL_ENTRY_LAST_ROW(entries[i]) - GSCL_ENTRY_FIRST_ROW(entries[i]) + 1.0);
    free(ranges);
    free(entries);
    return result;
}

static gscl_result run_draw(bench *b, void *opaque) {
    (void)b;
    return gscl_renderer_draw(opaque);
}

/* As many steps as keep the lists of the tiles, so that each run bins once. */
static gscl_result run_fit_steps(bench *b, void *opaque) {
    for (int i = 0; i < b->rounds; i++)
        GSCL_TRY(gscl_fit_step(opaque, 0, 1)); /* with rate 0 the splats do not move */
    return GSCL_OK;
}

static gscl_result measure_scene(bench *b, gscl_fit *fit, const float *params) {
    double evaluations;
    GSCL_TRY(gscl_fit_append(fit, params, b->settings.splats));
    GSCL_TRY(gscl_renderer_bin(&fit->renderer, true));
    GSCL_TRY(count_evaluations(&fit->renderer, &evaluations));
    b->about.unit = "evaluation";
    b->about.needed = pixels_inside(&b->settings, params);
    GSCL_TRY(take_samples(b, "whole", run_draw, &fit->renderer));
    report_samples(b, "raster_forward", evaluations, gscl_measure_tunables.forward_flop * evaluations);
    b->rounds = gscl_fit_bin_interval(fit);
    GSCL_TRY(take_samples(b, "fit step", run_fit_steps, fit));
    b->rounds = 1;
    static const char *const parts[] = {"bin", "fit_tiles", "step_splats"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        report_samples(b, parts[i], evaluations, 0);
    report_samples(b, "fit step", evaluations, gscl_measure_tunables.step_flop * evaluations);
    return GSCL_OK;
}

static gscl_result measure_blend(bench *b, gscl_blend blend, const float *params, const float *planes) {
    const gscl_kernel_options options = {.blend = gscl_blend_to_kernels(blend),
                                         .colours = 3,
                                         .opacity = blend == GSCL_BLEND_ALPHA,
                                         .loss = GSCL_LOSS_KIND_L2};
    gscl_fit fit;
    b->about.blend = blend;
    gscl_result result = gscl_fit_create(&fit, b->context, &options, b->settings.width, b->settings.height, 0, planes);
    if (result == GSCL_OK)
        result = measure_scene(b, &fit, params);
    gscl_fit_free(&fit);
    return result;
}

static gscl_result measure_kernels(bench *b) {
    const gscl_benchmark_settings *s = &b->settings;
    size_t samples = (size_t)s->width * s->height * 3;
    float *params = malloc((size_t)s->splats * GSCL_PARAMS * sizeof *params),
          *planes = malloc(samples * sizeof *planes);
    gscl_result result = params && planes ? GSCL_OK : gscl_fail_memory(b->context);
    if (result == GSCL_OK) {
        make_scene(s, params);
        for (size_t i = 0; i < samples; i++)
            planes[i] = 0.5f;
        b->about.splats = s->splats;
    }
    for (int blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM && result == GSCL_OK; blend++)
        result = measure_blend(b, (gscl_blend)blend, params, planes);
    free(params);
    free(planes);
    return result;
}

/* ---- Entry points ---- */

static gscl_result bench_create(gscl_context *context, const gscl_benchmark_settings *settings,
                                gscl_measurement_callback callback, void *opaque, bench **b) {
    if (!context || !callback)
        return GSCL_ERROR_INVALID_ARGUMENT;
    GSCL_TRY(gscl_require_encoder(context, "a benchmark"));
    gscl_benchmark_settings s;
    gscl_benchmark_settings_default(&s);
    GSCL_TRY(GSCL_STRUCT_READ(context, gscl_benchmark_settings, repetitions, settings, &s));
    if (!context->timings)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "a benchmark needs a context with timing");
    if (s.width == 0 || s.height == 0 || s.width > GSCL_MAX_DIMENSION || s.height > GSCL_MAX_DIMENSION)
        return gscl_fail(context, GSCL_ERROR_IMAGE_SIZE, "%s", gscl_result_text(GSCL_ERROR_IMAGE_SIZE));
    if (s.splats == 0 || s.splats > GSCL_MAX_SPLATS || s.repetitions == 0 || s.repetitions > MAX_REPETITIONS)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "%u splats or %u repetitions are out of range", s.splats,
                         s.repetitions);
    *b = calloc(1, sizeof **b);
    if (!*b)
        return gscl_fail_memory(context);
    **b = (bench){.context = context, .settings = s, .callback = callback, .opaque = opaque, .rounds = 1};
    return GSCL_OK;
}

gscl_result gscl_benchmark_device(gscl_context *context, const gscl_benchmark_settings *settings,
                                  gscl_measurement_callback callback, void *opaque) {
    bench *b;
    gscl_buffer buffers[2] = {{0}};
    gscl_forget_message(context);
    GSCL_TRY(bench_create(context, settings, callback, opaque, &b));
    gscl_result result = measure_device(b, buffers);
    for (int i = 0; i < 2; i++)
        gscl_buffer_free(&buffers[i]);
    free(b);
    return gscl_complete_message(context, result);
}

gscl_result gscl_benchmark_kernels(gscl_context *context, const gscl_benchmark_settings *settings,
                                   gscl_measurement_callback callback, void *opaque) {
    bench *b;
    gscl_forget_message(context);
    GSCL_TRY(bench_create(context, settings, callback, opaque, &b));
    gscl_result result = measure_kernels(b);
    free(b);
    return gscl_complete_message(context, result);
}
