#include "measure/subject.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/blend.h"
#include "image/image.h"
#include "measure/tunables.h"
#include "runtime/struct_size.h"
#include "runtime/timing.h"

#define MAX_COUNT 1000 /* repetitions, and splats */

static gscl_result check_settings(gscl_context *context, const gscl_accuracy_settings *s) {
    if (!context->timings)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "measuring accuracy needs a context with timing");
    if (s->repetitions == 0 || s->repetitions > MAX_COUNT || s->splats == 0 || s->splats > MAX_COUNT)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "%u repetitions or %u splats are out of range 1..%d",
                         s->repetitions, s->splats, MAX_COUNT);
    return GSCL_OK;
}

static gscl_result subject_load(gscl_subject *s, const gscl_image *image) {
    const gsf_header *header = &s->coded.file.header;
    size_t pixels = (size_t)header->width * header->height;
    s->options = gscl_coded_image_options(header);
    s->width = header->width;
    s->height = header->height;
    s->count = header->splat_count;
    if (image->width != s->width || image->height != s->height || image->channels != gscl_coded_image_channels(header))
        return gscl_fail(s->context, GSCL_ERROR_INVALID_ARGUMENT,
                         "the image is %ux%u with %u channels, the file is %ux%u with %u", image->width, image->height,
                         image->channels, s->width, s->height, gscl_coded_image_channels(header));
    if (s->count == 0)
        return gscl_fail(s->context, GSCL_ERROR_INVALID_ARGUMENT, "the file has no splats to measure");
    s->params = malloc(s->count * GSCL_PARAMS * sizeof *s->params);
    s->target = malloc(pixels * gsf_channel_count(header) * sizeof *s->target);
    if (!s->params || !s->target)
        return gscl_fail_memory(s->context);
    gscl_coded_image_params(&s->coded, s->params, s->background);
    gscl_image_to_planes(image, s->options.colours, s->options.alpha_channel, 0, s->target);
    return GSCL_OK;
}

gscl_result gscl_subject_open(gscl_subject *s, gscl_context *context, const gscl_image *image, const uint8_t *bytes,
                              size_t size, const gscl_accuracy_settings *settings) {
    gscl_content content;
    memset(s, 0, sizeof *s);
    if (!context || !image || !bytes)
        return GSCL_ERROR_INVALID_ARGUMENT;
    s->context = context;
    GSCL_TRY(gscl_require_encoder(context, "measuring accuracy"));
    gscl_accuracy_settings_default(&s->settings);
    GSCL_TRY(GSCL_STRUCT_READ(context, gscl_accuracy_settings, splats, settings, &s->settings));
    GSCL_TRY(check_settings(context, &s->settings));
    GSCL_TRY(gscl_image_examine(context, image, &content));
    gscl_result result = gscl_coded_image_read(&s->coded, bytes, size, false);
    return result == GSCL_OK ? subject_load(s, image) : gscl_coded_image_fail(context, result, bytes, size);
}

void gscl_subject_close(gscl_subject *s) {
    if (s->context)
        gscl_stage(s->context, GSCL_STAGE_NONE);
    gscl_coded_image_free(&s->coded);
    free(s->params);
    free(s->target);
}

gscl_blend gscl_subject_blend(const gscl_subject *s) {
    return gscl_blend_from_kernels(s->options.blend);
}

const char *gscl_exponential_name(int exponential) {
    static const char *const names[] = {[GSCL_EXPONENTIAL_POLYNOMIAL] = "polynomial",
                                        [GSCL_EXPONENTIAL_EXACT] = "exp2",
                                        [GSCL_EXPONENTIAL_NATIVE] = "native_exp2"};
    return names[exponential];
}

static gscl_result time_once(const gscl_subject *s, gscl_subject_run *run, void *opaque, size_t which,
                             double *seconds) {
    gscl_context_reset_timings(s->context);
    gscl_stage(s->context, GSCL_STAGE_MEASURE);
    GSCL_TRY(run(opaque, which));
    gscl_stage(s->context, GSCL_STAGE_NONE);
    *seconds = gscl_kernel_seconds(s->context);
    return GSCL_OK;
}

gscl_result gscl_subject_time(const gscl_subject *s, gscl_subject_run *run, void *opaque, size_t count,
                              double *seconds) {
    const size_t repetitions = s->settings.repetitions, warm_up = gscl_measure_tunables.warm_up_runs;
    double uncounted, *samples = malloc(count * repetitions * sizeof *samples);
    gscl_result result = samples ? GSCL_OK : gscl_fail_memory(s->context);
    for (size_t i = 0; i < warm_up + repetitions; i++)
        for (size_t k = 0; k < count && result == GSCL_OK; k++)
            result = time_once(s, run, opaque, k, i < warm_up ? &uncounted : &samples[k * repetitions + i - warm_up]);
    for (size_t k = 0; k < count && result == GSCL_OK; k++) {
        gscl_sort_samples(samples + k * repetitions, repetitions);
        seconds[k] = samples[k * repetitions + repetitions / 2];
    }
    free(samples);
    return result;
}

size_t gscl_subject_samples(const gscl_subject *s) {
    return (size_t)s->width * s->height * (size_t)(s->options.colours + s->options.alpha_channel);
}

static double clamped(double sample) {
    return fmin(fmax(sample, 0), 1);
}

void gscl_subject_compare(const gscl_subject *s, const double *rendering, const double *exact, gscl_accuracy *a) {
    size_t samples = gscl_subject_samples(s);
    double sum = 0, squares = 0;
    a->largest_error = 0;
    for (size_t i = 0; i < samples; i++) {
        double error = 255 * fabs(clamped(rendering[i]) - clamped(exact[i])),
               difference = clamped(rendering[i]) - s->target[i];
        a->largest_error = fmax(a->largest_error, error);
        sum += error;
        squares += difference * difference;
    }
    a->mean_error = sum / (double)samples;
    a->psnr = -10 * log10(squares / (double)samples);
}
