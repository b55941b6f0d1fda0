/* Errors and times of the ways of drawing, against a rendering in double precision. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/renderer.h"
#include "measure/accuracy_quantiser.h"
#include "measure/reference.h"
#include "measure/subject.h"
#include "runtime/mapping.h"

#define MAX_VARIANTS 24

/* ---- Drawing ---- */

/* One way of drawing. */
typedef struct variant {
    gscl_kernel_options options;
    const double *exact; /* planes that its errors are measured against */
    gscl_accuracy row;
    char name[32];
} variant;

typedef struct variant_set {
    gscl_subject *subject;
    size_t count;
    variant variants[MAX_VARIANTS];
    gscl_renderer renderer;
    gscl_buffer projected, image; /* of double precision */
    double *exact, *uncut;        /* planes: as the format defines, and with Gaussians that are not cut off */
    double *planes;
} variant_set;

static gscl_result draw_reference(const gscl_subject *s, bool cut, double *planes) {
    gscl_reference reference;
    const gscl_rectangle all = {0, 0, (int)s->width, (int)s->height};
    double *weights = malloc((size_t)s->width * s->height * sizeof *weights);
    gscl_result result = gscl_reference_create(&reference, &s->options, s->params, s->count, s->background, cut);
    if (result != GSCL_OK || !weights)
        result = gscl_fail_memory(s->context);
    else
        gscl_reference_draw(&reference, all, planes, weights);
    gscl_reference_free(&reference);
    free(weights);
    return result;
}

/* Draws in double precision, with the lists of single precision: their outlines are wide enough for both. */
static gscl_result draw_double(variant_set *b) {
    gscl_renderer *r = &b->renderer;
    gscl_kernel_options options = r->options;
    const gscl_image_shape shape = gscl_renderer_shape(r);
    gscl_kernel *project, *raster;
    options.is_double = 1;
    options.shape = GSCL_SHAPE_ROTATED; /* project_double makes splats of this shape only */
    GSCL_TRY(gscl_renderer_project(r));
    GSCL_TRY(gscl_renderer_bin(r, true));
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_ACCURACY, &options, "project_double", &project));
    GSCL_TRY(GSCL_LAUNCH(r->context, project, gscl_groups((size_t)r->count, GSCL_SPLATS_PER_GROUP),
                         GSCL_SPLATS_PER_GROUP, GSCL_ARG_BUFFER(r->params), GSCL_ARG(r->count),
                         GSCL_ARG_BUFFER(b->projected)));
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_ACCURACY, &options, "raster_forward", &raster));
    return GSCL_LAUNCH(r->context, raster, gscl_renderer_tiles(r), gscl_tile_group_size(r->context),
                       GSCL_ARG_BUFFER(b->projected), GSCL_ARG_BUFFER(r->entries), GSCL_ARG_BUFFER(r->tile_ranges),
                       GSCL_ARG_BUFFER(r->background), GSCL_ARG_BUFFER(b->image), GSCL_ARG(shape));
}

static gscl_result draw_variant(void *opaque, size_t which) {
    variant_set *b = opaque;
    gscl_kernel_options options = b->variants[which].options;
    options.is_double = 0; /* projecting and binning are in single precision */
    gscl_renderer_set_options(&b->renderer, &options);
    return b->variants[which].options.is_double ? draw_double(b) : gscl_renderer_render(&b->renderer);
}

static gscl_result read_rendering(variant_set *b) {
    size_t samples = gscl_subject_samples(b->subject);
    float *floats = malloc(samples * sizeof *floats);
    if (!floats)
        return gscl_fail_memory(b->subject->context);
    gscl_result result = gscl_buffer_read(b->subject->context, &b->renderer.image, 0, floats, samples * sizeof *floats);
    for (size_t i = 0; i < samples && result == GSCL_OK; i++)
        b->planes[i] = floats[i];
    free(floats);
    return result;
}

static gscl_result measure_error(variant_set *b, size_t which) {
    variant *v = &b->variants[which];
    GSCL_TRY(draw_variant(b, which));
    GSCL_TRY(v->options.is_double ? gscl_buffer_read(b->subject->context, &b->image, 0, b->planes,
                                                     gscl_subject_samples(b->subject) * sizeof *b->planes)
                                  : read_rendering(b));
    gscl_subject_compare(b->subject, b->planes, v->exact, &v->row);
    return GSCL_OK;
}

/* The default way of drawing is a variant of each choice: all of them report the time of the first. */
static gscl_result measure_variants(variant_set *b, gscl_accuracy_callback callback, void *opaque) {
    const gscl_subject *s = b->subject;
    double seconds[MAX_VARIANTS], default_seconds = 0;
    for (size_t i = 0; i < b->count; i++)
        GSCL_TRY(measure_error(b, i));
    GSCL_TRY(gscl_subject_time(s, draw_variant, b, b->count, seconds));
    for (size_t i = 0; i < b->count; i++) {
        gscl_accuracy *row = &b->variants[i].row;
        if (row->is_default && default_seconds == 0)
            default_seconds = seconds[i];
        row->ns_per_pixel = 1e9 * (row->is_default ? default_seconds : seconds[i]) / ((double)s->width * s->height);
        row->variant = b->variants[i].name;
        callback(opaque, row);
    }
    return GSCL_OK;
}

/* ---- Choices and their variants ---- */

/* Adds a variant and returns its options, which are those of the file: the caller changes one of them. */
static gscl_kernel_options *add_variant(variant_set *b, const double *exact, const char *choice, const char *name,
                                        double value, bool is_default) {
    variant *v = &b->variants[b->count++];
    v->options = b->subject->options;
    v->exact = exact;
    v->row = (gscl_accuracy){
        .choice = choice, .value = value, .is_default = is_default, .blend = gscl_subject_blend(b->subject)};
    snprintf(v->name, sizeof v->name, "%s", name);
    return &v->options;
}

static void add_supports(variant_set *b) {
    static const double sigmas[] = {2, 2.5, 3, 3.5, 0, 4, 4.5, 5, 6}; /* 0: the default */
    for (size_t i = 0; i < sizeof sigmas / sizeof *sigmas; i++) {
        char name[32];
        const bool is_default = sigmas[i] == 0;
        const double value = is_default ? sqrt(2 * (double)GSCL_SUPPORT) : sigmas[i];
        snprintf(name, sizeof name, "%.3g sigma", value);
        gscl_kernel_options *options = add_variant(b, b->uncut, "support", name, value, is_default);
        if (!is_default)
            options->support = value * value / 2;
    }
}

static void add_exponentials(variant_set *b) {
    for (int i = GSCL_EXPONENTIAL_POLYNOMIAL; i <= GSCL_EXPONENTIAL_NATIVE; i++)
        add_variant(b, b->exact, "exponential", gscl_exponential_name(i), 0, i == GSCL_EXPONENTIAL_POLYNOMIAL)
            ->exponential = i;
}

static gscl_result add_precisions(variant_set *b) {
    gscl_context *context = b->subject->context;
    add_variant(b, b->exact, "precision", "float32", 32, true);
    if (!context->backend->has_double(context))
        return GSCL_OK;
    add_variant(b, b->exact, "precision", "float64", 64, false)->is_double = 1;
    GSCL_TRY(gscl_buffer_reserve(context, &b->projected, b->subject->count * GSCL_PROJECTED * sizeof(double)));
    return gscl_buffer_reserve_image(context, &b->image, gscl_subject_samples(b->subject) * sizeof(double));
}

static void add_early_stops(variant_set *b) {
    static const double thresholds[] = {0, 1 / 4096.0, 1 / 1024.0, 1 / 255.0, 1 / 64.0};
    for (size_t i = 0; i < sizeof thresholds / sizeof *thresholds; i++) {
        char name[32] = "off";
        if (i > 0)
            snprintf(name, sizeof name, "below 1/%.0f", 1 / thresholds[i]);
        add_variant(b, b->exact, "early stop", name, thresholds[i], i == 0)->early_stop = thresholds[i];
    }
}

static gscl_result variant_set_prepare(variant_set *b) {
    gscl_subject *s = b->subject;
    size_t samples = gscl_subject_samples(s);
    b->exact = malloc(samples * sizeof *b->exact);
    b->uncut = malloc(samples * sizeof *b->uncut);
    b->planes = malloc(samples * sizeof *b->planes);
    if (!b->exact || !b->uncut || !b->planes)
        return gscl_fail_memory(s->context);
    GSCL_TRY(draw_reference(s, true, b->exact));
    GSCL_TRY(draw_reference(s, false, b->uncut));
    GSCL_TRY(gscl_renderer_create(&b->renderer, s->context, &s->options));
    GSCL_TRY(gscl_renderer_set_view(&b->renderer, 0, 0, 0, s->width, s->height));
    return gscl_renderer_set_splats(&b->renderer, s->params, s->count, s->background);
}

static gscl_result measure_choices(variant_set *b, gscl_accuracy_callback callback, void *opaque) {
    gscl_subject *s = b->subject;
    const bool alpha = s->options.blend == GSCL_ALPHA, scalar = s->coded.file.header.coding == GSF_CODING_SCALAR;
    GSCL_TRY(variant_set_prepare(b));
    add_supports(b);
    add_exponentials(b);
    GSCL_TRY(add_precisions(b));
    if (alpha)
        add_early_stops(b);
    GSCL_TRY(measure_variants(b, callback, opaque));
    return scalar && !alpha ? gscl_measure_quantiser(s, callback, opaque) : GSCL_OK;
}

gscl_result gscl_measure_accuracy(gscl_context *context, const gscl_image *image, const uint8_t *bytes, size_t size,
                                  const gscl_accuracy_settings *settings, gscl_accuracy_callback callback,
                                  void *opaque) {
    gscl_subject subject;
    gscl_forget_message(context);
    if (!callback)
        return gscl_complete_message(context, GSCL_ERROR_INVALID_ARGUMENT);
    gscl_result result = gscl_subject_open(&subject, context, image, bytes, size, settings);
    variant_set b = {.subject = &subject};
    if (result == GSCL_OK)
        result = measure_choices(&b, callback, opaque);
    gscl_renderer_free(&b.renderer);
    gscl_buffer_free(&b.projected);
    gscl_buffer_free(&b.image);
    free(b.exact);
    free(b.uncut);
    free(b.planes);
    gscl_subject_close(&subject);
    return gscl_complete_message(context, result);
}
