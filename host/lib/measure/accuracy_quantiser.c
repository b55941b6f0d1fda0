/* What coarser and finer quantiser steps do to a picture and to its file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure/accuracy_quantiser.h"
#include "cl/constants.h"
#include "fit/fit.h"
#include "decode/quantise.h"

#define LOOSE_STEPS 60  /* of gradient descent without a quantiser: what the codes hold becomes continuous again */
#define LOOSE_RATE 0.1f /* on the learning rates */

typedef struct sweep {
    gscl_subject *subject;
    gscl_accuracy_callback callback;
    void *opaque;
    gscl_fit fit;
    gscl_coded_image picture; /* quantised */
    float *loose, *params;    /* before and after quantising */
    float *floats;            /* what is drawn */
    double *exact, *planes;
} sweep;

static gscl_result loosen(sweep *w) {
    gscl_subject *s = w->subject;
    gscl_kernel_options options = s->options;
    options.loss = GSCL_LOSS_KIND_L2;
    GSCL_TRY(gscl_fit_create(&w->fit, s->context, &options, s->width, s->height, 0, s->target));
    GSCL_TRY(gscl_renderer_set_splats(&w->fit.renderer, NULL, 0, s->background));
    GSCL_TRY(gscl_fit_append(&w->fit, s->params, s->count));
    for (int i = 0; i < LOOSE_STEPS; i++)
        GSCL_TRY(gscl_fit_step(&w->fit, LOOSE_RATE));
    return gscl_fit_read(&w->fit, w->loose);
}

static gscl_result draw(sweep *w, const float *params, double *planes) {
    gscl_renderer *r = &w->fit.renderer;
    size_t samples = (size_t)gscl_renderer_plane(r) * (size_t)r->channels;
    GSCL_TRY(gscl_renderer_set_splats(r, params, w->subject->count, w->subject->background));
    GSCL_TRY(gscl_renderer_render(r));
    GSCL_TRY(gscl_buffer_read(r->context, &r->image, 0, w->floats, samples * sizeof *w->floats));
    for (size_t i = 0; i < samples; i++)
        planes[i] = w->floats[i];
    return GSCL_OK;
}

static void tell(sweep *w, const char *name, double factor, double bits) {
    gscl_accuracy a = {"quantiser",
                       .variant = name,
                       .value = factor,
                       .is_default = factor == 1,
                       .blend = gscl_subject_blend(w->subject),
                       .bits_per_splat = bits};
    gscl_subject_compare(w->subject, w->planes, w->exact, &a);
    w->callback(w->opaque, &a);
}

static gscl_result measure_steps(sweep *w, double factor) {
    gscl_coded_image *p = &w->picture;
    size_t count = w->subject->count, size;
    char name[32];
    p->file.steps = gscl_scale_steps(&w->subject->picture.file.steps, factor);
    for (size_t i = 0; i < count; i++)
        gscl_quantise(&p->file, w->loose + i * GSCL_PARAMS, &p->file.splats[i]);
    GSCL_TRY(gscl_coded_image_sort(p, NULL));
    GSCL_TRY(gscl_coded_image_size(p, &size));
    gscl_coded_image_params(p, w->params, w->subject->background);
    GSCL_TRY(draw(w, w->params, w->planes));
    snprintf(name, sizeof name, "steps x%g", factor);
    tell(w, name, factor, 8.0 * (double)size / (double)count);
    return GSCL_OK;
}

static gscl_result measure(sweep *w) {
    static const double factors[] = {0.25, 0.5, 0.7, 1, 1.4, 2, 4};
    gscl_subject *s = w->subject;
    size_t samples = (size_t)s->width * s->height * gsf_channel_count(&s->picture.file.header);
    w->loose = malloc(s->count * GSCL_PARAMS * sizeof *w->loose);
    w->params = malloc(s->count * GSCL_PARAMS * sizeof *w->params);
    w->floats = malloc(samples * sizeof *w->floats);
    w->exact = malloc(samples * sizeof *w->exact);
    w->planes = malloc(samples * sizeof *w->planes);
    if (!w->loose || !w->params || !w->floats || !w->exact || !w->planes)
        return gscl_fail_memory(s->context);
    w->picture.file.header = s->picture.file.header;
    memcpy(w->picture.file.background, s->picture.file.background, sizeof w->picture.file.background);
    GSCL_TRY(gscl_coded_image_reserve(&w->picture, s->count));
    GSCL_TRY(loosen(w));
    GSCL_TRY(draw(w, w->loose, w->exact));
    memcpy(w->planes, w->exact, samples * sizeof *w->planes);
    tell(w, "none", 0, 0);
    for (size_t i = 0; i < sizeof factors / sizeof *factors; i++)
        GSCL_TRY(measure_steps(w, factors[i]));
    return GSCL_OK;
}

gscl_result gscl_measure_quantiser(gscl_subject *subject, gscl_accuracy_callback callback, void *opaque) {
    sweep w = {.subject = subject, .callback = callback, .opaque = opaque};
    gscl_result result = measure(&w);
    gscl_fit_free(&w.fit);
    gscl_coded_image_free(&w.picture);
    free(w.loose);
    free(w.params);
    free(w.floats);
    free(w.exact);
    free(w.planes);
    return result;
}
