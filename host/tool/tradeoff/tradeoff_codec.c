/* The part of 'gscl tradeoff' that encodes and decodes: every effort at one size, and many sizes at one effort. */
#include <stdio.h>
#include <stdlib.h>

#include "cli/progress.h"
#include "cli/rate.h"
#include "cli/stopwatch.h"
#include "tradeoff/tradeoff.h"

#define ENCODE_SECONDS 2.0 /* time for repeated encodes of one file */
#define MAX_ENCODES 3      /* maximum number of encodes of one file */
#define DECODES 10

static const double rate_factors[TRADEOFF_RATES] = {0.25, 0.5, 1, 2, 4, 8}; /* of the fixed size */

typedef struct codec {
    const tradeoff_plan *plan;
    tradeoff_results *results;
    gscl_context *context;
} codec;

static gscl_result encode_once(const codec *c, const gscl_encode_settings *settings, const char *label, uint8_t **bytes,
                               size_t *size, gscl_encode_report *report) {
    gscl_encode_settings s = *settings;
    progress_line line;
    progress_start(&line, label, false);
    s.progress = progress_update;
    s.progress_opaque = &line;
    const gscl_result result = gscl_encode(c->context, c->plan->image, &s, bytes, size, report);
    progress_finish(&line);
    return result;
}

/* Encodes repeatedly and keeps the report of the fastest run. */
static gscl_result encode_repeatedly(const codec *c, const gscl_encode_settings *settings, const char *label,
                                     uint8_t **bytes, size_t *size, gscl_encode_report *fastest) {
    double spent = 0;
    *bytes = NULL;
    *size = 0;
    for (int i = 0; i < MAX_ENCODES && spent < ENCODE_SECONDS; i++) {
        gscl_encode_report report = {.struct_size = sizeof report};
        uint8_t *written;
        const gscl_result result = encode_once(c, settings, label, &written, size, &report);
        if (result != GSCL_OK)
            return result;
        gscl_free(*bytes);
        *bytes = written;
        if (i == 0 || report.seconds < fastest->seconds)
            *fastest = report;
        spent += c->plan->quick ? ENCODE_SECONDS : report.seconds;
    }
    return GSCL_OK;
}

static gscl_result decode_repeatedly(const codec *c, const uint8_t *bytes, size_t size, tradeoff_encode *e) {
    double seconds[DECODES];
    gscl_image decoded = {0};
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.sample = c->plan->image->sample;
    gscl_result result = gscl_decode(c->context, bytes, size, &settings, &decoded); /* warms up */
    for (int i = 0; i < DECODES && result == GSCL_OK; i++) {
        const double start = stopwatch_now();
        result = gscl_decode(c->context, bytes, size, &settings, &decoded);
        seconds[i] = stopwatch_now() - start;
    }
    if (result == GSCL_OK)
        result = gscl_compare(c->plan->image, &decoded, &comparison);
    gscl_free(decoded.pixels);
    if (result != GSCL_OK)
        return result;
    e->decode_s = spread_of(seconds, DECODES).fastest;
    e->psnr = comparison.psnr;
    e->ms_ssim = comparison.ms_ssim;
    return GSCL_OK;
}

static gscl_encode_settings settings_for(int effort, double bytes) {
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.target = GSCL_TARGET_BYTES;
    settings.target_value = bytes;
    settings.effort = effort;
    settings.trace = true;
    return settings;
}

/* Leaves the file in *bytes. */
static gscl_result measure_encode(const codec *c, int effort, double budget, tradeoff_encode *e, uint8_t **bytes,
                                  size_t *size) {
    const gscl_encode_settings settings = settings_for(effort, budget);
    char label[64];
    snprintf(label, sizeof label, "effort %d, %.0f bytes", effort, budget);
    gscl_result result = encode_repeatedly(c, &settings, label, bytes, size, &e->report);
    if (result != GSCL_OK)
        return result;
    e->effort = effort;
    e->bpp = bits_per_pixel(*size, c->plan->image->width, c->plan->image->height);
    e->encode_s = e->report.seconds;
    return decode_repeatedly(c, *bytes, *size, e);
}

/* ---- Efforts and rates ---- */

static bool is_measured(const tradeoff_plan *plan, int effort) {
    return !plan->quick || effort <= 1 || effort == (int)plan->effort;
}

/* Keeps the file of the fixed effort for the accuracy measurements. */
static gscl_result measure_efforts(codec *c) {
    tradeoff_results *r = c->results;
    for (int effort = 0; effort <= GSCL_MAX_EFFORT; effort++) {
        uint8_t *bytes = NULL;
        size_t size;
        if (!is_measured(c->plan, effort))
            continue;
        const gscl_result result =
            measure_encode(c, effort, (double)c->plan->bytes, &r->efforts[r->effort_count], &bytes, &size);
        if (result == GSCL_OK && effort == (int)c->plan->effort) {
            r->files[GSCL_BLEND_NORMALIZED - 1] = bytes;
            r->sizes[GSCL_BLEND_NORMALIZED - 1] = size;
        } else {
            gscl_free(bytes);
        }
        if (result != GSCL_OK)
            return result;
        r->effort_count++;
    }
    return GSCL_OK;
}

static const tradeoff_encode *at_fixed_effort(const codec *c) {
    const tradeoff_results *r = c->results;
    size_t i = 0;
    while (i + 1 < r->effort_count && r->efforts[i].effort != (int)c->plan->effort)
        i++;
    return &r->efforts[i];
}

/* Skips rates that are too low for the image. */
static gscl_result measure_rates(codec *c) {
    tradeoff_results *r = c->results;
    for (size_t i = 0; i < TRADEOFF_RATES; i++) {
        uint8_t *bytes = NULL;
        size_t size;
        if (rate_factors[i] == 1) {
            r->rates[r->rate_count++] = *at_fixed_effort(c);
            continue;
        }
        if (c->plan->quick && (rate_factors[i] < 0.5 || rate_factors[i] > 2))
            continue;
        const gscl_result result = measure_encode(c, (int)c->plan->effort, rate_factors[i] * (double)c->plan->bytes,
                                                  &r->rates[r->rate_count], &bytes, &size);
        gscl_free(bytes);
        if (result == GSCL_OK)
            r->rate_count++;
        else if (result != GSCL_ERROR_BUDGET_TOO_SMALL)
            return result;
    }
    return GSCL_OK;
}

/* Encodes the files of the other blends for the accuracy measurements. */
static gscl_result encode_blends(codec *c) {
    for (int blend = GSCL_BLEND_ALPHA; blend <= GSCL_BLEND_SUM; blend++) {
        gscl_encode_settings settings = settings_for((int)c->plan->effort, (double)c->plan->bytes);
        settings.blend = (gscl_blend)blend;
        settings.trace = false;
        const gscl_result result = encode_once(c, &settings, blend_words[blend], &c->results->files[blend - 1],
                                               &c->results->sizes[blend - 1], NULL);
        if (result != GSCL_OK)
            return result;
    }
    return GSCL_OK;
}

/* Compiles the kernels by one encode that is not measured. */
static gscl_result warm_up(const codec *c) {
    const gscl_encode_settings settings = settings_for(1, (double)c->plan->bytes);
    uint8_t *bytes;
    size_t size;
    const gscl_result result = encode_once(c, &settings, "warming up", &bytes, &size, NULL);
    if (result == GSCL_OK)
        gscl_free(bytes);
    return result;
}

int tradeoff_measure_codec(const tradeoff_plan *plan, tradeoff_results *results) {
    codec c = {.plan = plan, .results = results};
    device_choice choice = plan->choice;
    choice.timing = false; /* timing slows the encode down */
    const int status = open_device(&choice, &c.context);
    if (status != EXIT_SUCCESS)
        return status;
    results->device = *gscl_context_device(c.context);
    gscl_result result = warm_up(&c);
    if (result == GSCL_OK)
        result = measure_efforts(&c);
    if (result == GSCL_OK)
        result = measure_rates(&c);
    if (result == GSCL_OK)
        result = encode_blends(&c);
    const int failed = result == GSCL_OK ? EXIT_SUCCESS : report_result(c.context, plan->image_name, result);
    gscl_context_free(&c.context);
    return failed;
}
