/* What the renderer's exactness costs: each choice that trades it for speed, beside the exact picture. */
#include "accuracy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "constants.h"
#include "image.h"
#include "timing.h"

#define WARM_UP 3
#define MOST 1000 /* repetitions, and splats */

static const gscl_accuracy_settings defaults = {.repetitions = 20, .splats = 48};

void gscl_accuracy_settings_default(gscl_accuracy_settings *settings) {
    if (settings)
        *settings = defaults;
}

/* ---- The subject ---- */

static gscl_result check_settings(gscl_context *context, const gscl_accuracy_settings *s) {
    if (!context->timings)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "measuring accuracy needs a context with timing");
    if (s->repetitions == 0 || s->repetitions > MOST || s->splats == 0 || s->splats > MOST)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "%u repetitions or %u splats are out of range 1..%d",
                         s->repetitions, s->splats, MOST);
    return GSCL_OK;
}

static gscl_result load(gscl_subject *s, const gscl_image *image) {
    const gsf_header *header = &s->picture.file.header;
    size_t pixels = (size_t)header->width * header->height;
    s->options = gscl_picture_options(header);
    s->width = header->width;
    s->height = header->height;
    s->count = header->splat_count;
    if (image->width != s->width || image->height != s->height || image->channels != gscl_picture_channels(header))
        return gscl_fail(s->context, GSCL_ERROR_INVALID_ARGUMENT,
                         "the image is %ux%u with %u channels, the file shows %ux%u with %u", image->width,
                         image->height, image->channels, s->width, s->height, gscl_picture_channels(header));
    if (s->count == 0)
        return gscl_fail(s->context, GSCL_ERROR_INVALID_ARGUMENT, "the file has no splats to measure");
    s->params = malloc(s->count * GSCL_PARAMS * sizeof *s->params);
    s->target = malloc(pixels * gsf_channel_count(header) * sizeof *s->target);
    if (!s->params || !s->target)
        return gscl_fail(s->context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
    gscl_picture_params(&s->picture, s->params, s->background);
    gscl_image_to_planes(image, s->options.colours, s->options.alpha_channel, 0, s->target);
    return GSCL_OK;
}

gscl_result gscl_subject_open(gscl_subject *s, gscl_context *context, const gscl_image *image, const uint8_t *bytes,
                              size_t size, const gscl_accuracy_settings *settings) {
    gscl_content content;
    memset(s, 0, sizeof *s);
    if (!context || !image || !bytes)
        return GSCL_ERROR_INVALID_ARGUMENT;
    context->message[0] = 0;
    s->context = context;
    s->settings = settings ? settings : &defaults;
    GSCL_TRY(check_settings(context, s->settings));
    GSCL_TRY(gscl_image_examine(context, image, &content));
    gscl_result result = gscl_picture_read(&s->picture, bytes, size);
    return result == GSCL_OK ? load(s, image) : gscl_picture_fail(context, result, bytes, size);
}

void gscl_subject_close(gscl_subject *s) {
    if (s->context)
        gscl_stage(s->context, NULL);
    gscl_picture_free(&s->picture);
    free(s->params);
    free(s->target);
}

gscl_blend gscl_subject_blend(const gscl_subject *s) {
    static const gscl_blend blends[] = {
        [GSCL_NORMALIZED] = GSCL_BLEND_NORMALIZED, [GSCL_ALPHA] = GSCL_BLEND_ALPHA, [GSCL_SUM] = GSCL_BLEND_SUM};
    return blends[s->options.blend];
}

const char *gscl_exponential_name(int exponential) {
    static const char *const names[] = {[GSCL_EXPONENTIAL_POLYNOMIAL] = "polynomial",
                                        [GSCL_EXPONENTIAL_EXACT] = "exp2",
                                        [GSCL_EXPONENTIAL_NATIVE] = "native_exp2"};
    return names[exponential];
}

gscl_result gscl_subject_time(const gscl_subject *s, gscl_subject_run *run, void *opaque, double *seconds) {
    double samples[MOST];
    for (uint32_t i = 0; i < WARM_UP + s->settings->repetitions; i++) {
        gscl_context_reset_timings(s->context);
        gscl_stage(s->context, "measure");
        GSCL_TRY(run(opaque));
        gscl_stage(s->context, NULL);
        if (i >= WARM_UP)
            samples[i - WARM_UP] = gscl_kernel_seconds(s->context);
    }
    gscl_sort_samples(samples, s->settings->repetitions);
    *seconds = samples[s->settings->repetitions / 2];
    return GSCL_OK;
}

/* ---- Errors ---- */

static size_t samples_of(const gscl_subject *s) {
    return (size_t)s->width * s->height * (size_t)(s->options.colours + s->options.alpha_channel);
}

static double clamped(double sample) {
    return fmin(fmax(sample, 0), 1);
}

void gscl_subject_compare(const gscl_subject *s, const double *drawn, const double *exact, gscl_accuracy *a) {
    size_t samples = samples_of(s);
    double sum = 0, squares = 0;
    a->largest_error = 0;
    for (size_t i = 0; i < samples; i++) {
        double error = 255 * fabs(clamped(drawn[i]) - clamped(exact[i])), apart = clamped(drawn[i]) - s->target[i];
        a->largest_error = fmax(a->largest_error, error);
        sum += error;
        squares += apart * apart;
    }
    a->mean_error = sum / (double)samples;
    a->psnr = -10 * log10(squares / (double)samples);
}

/* ---- Drawing in another way ---- */

typedef struct bench {
    gscl_subject *subject;
    gscl_accuracy_callback callback;
    void *opaque;
    gscl_renderer renderer;
    gscl_buffer drawn, image; /* of double precision */
    double *exact, *endless;  /* planes: as the format says, and with Gaussians that are not cut off */
    double *planes;
} bench;

static gscl_result draw_reference(const gscl_subject *s, bool cut, double *planes) {
    gscl_reference reference;
    const gscl_rectangle all = {0, 0, (int)s->width, (int)s->height};
    double *weights = malloc((size_t)s->width * s->height * sizeof *weights);
    gscl_result result = gscl_reference_create(&reference, &s->options, s->params, s->count, s->background, cut);
    if (result != GSCL_OK || !weights)
        result = gscl_fail(s->context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
    else
        gscl_reference_draw(&reference, all, planes, weights);
    gscl_reference_free(&reference);
    free(weights);
    return result;
}

static gscl_result run_float(void *opaque) {
    return gscl_renderer_render(&((bench *)opaque)->renderer);
}

/* The lists are those of single precision: their outlines are a little wide anyway. */
static gscl_result run_double(void *opaque) {
    bench *b = opaque;
    gscl_renderer *r = &b->renderer;
    gscl_kernel_options options = r->options;
    cl_ulong plane = gscl_renderer_plane(r);
    cl_kernel project, raster;
    options.is_double = 1;
    GSCL_TRY(gscl_renderer_project(r));
    GSCL_TRY(gscl_renderer_bin(r, true));
    GSCL_TRY(gscl_kernel(r->context, GSCL_PROGRAM_ACCURACY, &options, "project_exactly", &project));
    GSCL_TRY(GSCL_LAUNCH(r->context, project, gscl_groups((size_t)r->count, GSCL_SPLATS_PER_GROUP),
                         GSCL_SPLATS_PER_GROUP, GSCL_ARG_BUFFER(r->params), GSCL_ARG(r->count),
                         GSCL_ARG_BUFFER(b->drawn)));
    GSCL_TRY(gscl_kernel(r->context, GSCL_PROGRAM_ACCURACY, &options, "raster_forward", &raster));
    return GSCL_LAUNCH(r->context, raster, (size_t)r->view.tiles_x * (size_t)r->view.tiles_y,
                       gscl_tile_group_size(r->context), GSCL_ARG_BUFFER(b->drawn), GSCL_ARG_BUFFER(r->entries),
                       GSCL_ARG_BUFFER(r->tile_ranges), GSCL_ARG_BUFFER(r->background), GSCL_ARG_BUFFER(b->image),
                       GSCL_ARG(r->width), GSCL_ARG(r->height), GSCL_ARG(r->view.tiles_x), GSCL_ARG(plane));
}

static gscl_result read_floats(bench *b) {
    size_t samples = samples_of(b->subject);
    float *floats = malloc(samples * sizeof *floats);
    if (!floats)
        return gscl_fail(b->subject->context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
    gscl_result result = gscl_buffer_read(b->subject->context, &b->renderer.image, 0, floats, samples * sizeof *floats);
    for (size_t i = 0; i < samples && result == GSCL_OK; i++)
        b->planes[i] = floats[i];
    free(floats);
    return result;
}

/* Draws with `options`, which differ from the subject's in one thing, and tells. */
static gscl_result measure(bench *b, const gscl_kernel_options *options, const double *exact, gscl_accuracy a) {
    const gscl_subject *s = b->subject;
    double seconds;
    b->renderer.options = *options;
    b->renderer.options.is_double = 0; /* of project and bin */
    GSCL_TRY(gscl_subject_time(s, options->is_double ? run_double : run_float, b, &seconds));
    GSCL_TRY(options->is_double
                 ? gscl_buffer_read(s->context, &b->image, 0, b->planes, samples_of(s) * sizeof *b->planes)
                 : read_floats(b));
    gscl_subject_compare(s, b->planes, exact, &a);
    a.ns_per_pixel = 1e9 * seconds / ((double)s->width * s->height);
    a.blend = gscl_subject_blend(s);
    b->callback(b->opaque, &a);
    return GSCL_OK;
}

/* ---- The choices ---- */

static gscl_result measure_support(bench *b) {
    static const double sigmas[] = {2, 2.5, 3, 3.5, 0, 4, 4.5, 5, 6};
    const double usual = sqrt(2 * (double)GSCL_SUPPORT);
    for (size_t i = 0; i < sizeof sigmas / sizeof *sigmas; i++) {
        gscl_kernel_options options = b->subject->options;
        char name[32];
        double value = sigmas[i] > 0 ? sigmas[i] : usual;
        snprintf(name, sizeof name, "%.3g sigma", value);
        if (sigmas[i] > 0)
            options.support = value * value / 2;
        GSCL_TRY(measure(b, &options, b->endless,
                         (gscl_accuracy){"support", .variant = name, .value = value, .is_default = sigmas[i] == 0}));
    }
    return GSCL_OK;
}

static gscl_result measure_exponential(bench *b) {
    for (int i = GSCL_EXPONENTIAL_POLYNOMIAL; i <= GSCL_EXPONENTIAL_NATIVE; i++) {
        gscl_kernel_options options = b->subject->options;
        options.exponential = i;
        GSCL_TRY(measure(b, &options, b->exact,
                         (gscl_accuracy){"exponential", .variant = gscl_exponential_name(i), .is_default = i == 0}));
    }
    return GSCL_OK;
}

static bool has_double(const gscl_context *context) {
    cl_device_fp_config config = 0;
    clGetDeviceInfo(context->device, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof config, &config, NULL);
    return config != 0;
}

static gscl_result measure_precision(bench *b) {
    gscl_context *context = b->subject->context;
    gscl_kernel_options options = b->subject->options;
    GSCL_TRY(measure(b, &options, b->exact,
                     (gscl_accuracy){"precision", .variant = "float32", .value = 32, .is_default = true}));
    if (!has_double(context))
        return GSCL_OK;
    options.is_double = 1;
    GSCL_TRY(gscl_buffer_reserve(context, &b->drawn, b->subject->count * GSCL_DRAWN * sizeof(cl_double)));
    GSCL_TRY(gscl_buffer_reserve_image(context, &b->image, samples_of(b->subject) * sizeof(cl_double)));
    return measure(b, &options, b->exact, (gscl_accuracy){"precision", .variant = "float64", .value = 64});
}

static gscl_result measure_early_stop(bench *b) {
    static const double thresholds[] = {0, 1 / 4096.0, 1 / 1024.0, 1 / 255.0, 1 / 64.0};
    for (size_t i = 0; i < sizeof thresholds / sizeof *thresholds; i++) {
        gscl_kernel_options options = b->subject->options;
        char name[32] = "off";
        if (i > 0)
            snprintf(name, sizeof name, "below 1/%.0f", 1 / thresholds[i]);
        options.early_stop = thresholds[i];
        GSCL_TRY(measure(b, &options, b->exact,
                         (gscl_accuracy){"early stop", .variant = name, .value = thresholds[i], .is_default = i == 0}));
    }
    return GSCL_OK;
}

static gscl_result prepare(bench *b) {
    gscl_subject *s = b->subject;
    size_t samples = samples_of(s);
    b->exact = malloc(samples * sizeof *b->exact);
    b->endless = malloc(samples * sizeof *b->endless);
    b->planes = malloc(samples * sizeof *b->planes);
    if (!b->exact || !b->endless || !b->planes)
        return gscl_fail(s->context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
    GSCL_TRY(draw_reference(s, true, b->exact));
    GSCL_TRY(draw_reference(s, false, b->endless));
    GSCL_TRY(gscl_renderer_create(&b->renderer, s->context, &s->options));
    GSCL_TRY(gscl_renderer_set_view(&b->renderer, 0, 0, 0, s->width, s->height));
    return gscl_renderer_set_splats(&b->renderer, s->params, s->count, s->background);
}

static gscl_result measure_all(bench *b) {
    GSCL_TRY(prepare(b));
    GSCL_TRY(measure_support(b));
    GSCL_TRY(measure_exponential(b));
    GSCL_TRY(measure_precision(b));
    if (b->subject->options.blend == GSCL_ALPHA)
        return measure_early_stop(b);
    return b->subject->picture.file.header.coding == GSF_CODING_SCALAR
               ? gscl_measure_quantiser(b->subject, b->callback, b->opaque)
               : GSCL_OK;
}

gscl_result gscl_measure_accuracy(gscl_context *context, const gscl_image *image, const uint8_t *bytes, size_t size,
                                  const gscl_accuracy_settings *settings, gscl_accuracy_callback callback,
                                  void *opaque) {
    gscl_subject subject;
    if (!callback)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_result result = gscl_subject_open(&subject, context, image, bytes, size, settings);
    bench b = {.subject = &subject, .callback = callback, .opaque = opaque};
    if (result == GSCL_OK)
        result = measure_all(&b);
    gscl_renderer_free(&b.renderer);
    gscl_buffer_free(&b.drawn);
    gscl_buffer_free(&b.image);
    free(b.exact);
    free(b.endless);
    free(b.planes);
    gscl_subject_close(&subject);
    return result;
}
