#include "measure/accuracy_quantiser.h"
#include "decode/coded_size.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/quantise.h"
#include "fit/fit.h"
#include "measure/tunables.h"

typedef struct sweep {
    gscl_subject *subject;
    gscl_accuracy_callback callback;
    void *opaque;
    gscl_fit fit;
    gscl_coded_image coded;      /* the splats with other steps */
    float *unquantised, *params; /* parameters before and after quantising */
    float *rendering;            /* samples on the device */
    double *exact, *planes;
} sweep;

/* Refines the splats by a few steps without a quantiser, so that their parameters are continuous. */
static gscl_result fit_unquantised(sweep *w) {
    gscl_subject *s = w->subject;
    gscl_kernel_options options = s->options;
    options.loss = GSCL_LOSS_KIND_L2;
    GSCL_TRY(gscl_fit_create(&w->fit, s->context, &options, s->width, s->height, 0, s->target));
    GSCL_TRY(gscl_renderer_set_splats(&w->fit.renderer, NULL, 0, s->background));
    GSCL_TRY(gscl_fit_append(&w->fit, s->params, s->count));
    for (int i = 0; i < gscl_measure_tunables.unquantised_steps; i++)
        GSCL_TRY(gscl_fit_step(&w->fit, gscl_measure_tunables.unquantised_rate, 1));
    return gscl_fit_read(&w->fit, w->unquantised);
}

static gscl_result sweep_render(sweep *w, const float *params, double *planes) {
    gscl_renderer *r = &w->fit.renderer;
    size_t samples = (size_t)gscl_renderer_plane(r) * (size_t)r->channels;
    GSCL_TRY(gscl_renderer_set_splats(r, params, w->subject->count, w->subject->background));
    GSCL_TRY(gscl_renderer_render(r));
    GSCL_TRY(gscl_buffer_read(r->context, &r->image, 0, w->rendering, samples * sizeof *w->rendering));
    for (size_t i = 0; i < samples; i++)
        planes[i] = w->rendering[i];
    return GSCL_OK;
}

static void sweep_report(sweep *w, const char *name, double factor, double bits) {
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
    gscl_coded_image *p = &w->coded;
    size_t count = w->subject->count, size;
    char name[32];
    p->file.steps = gscl_scale_steps(&w->subject->coded.file.steps, factor);
    for (size_t i = 0; i < count; i++)
        gscl_quantise(&p->file, w->unquantised + i * GSCL_PARAMS, &p->file.splats[i]);
    GSCL_TRY(gscl_coded_image_sort(p, NULL));
    GSCL_TRY(gscl_coded_image_size(p, &size));
    gscl_coded_image_params(p, w->params, w->subject->background);
    GSCL_TRY(sweep_render(w, w->params, w->planes));
    snprintf(name, sizeof name, "steps x%g", factor);
    sweep_report(w, name, factor, 8.0 * (double)size / (double)count);
    return GSCL_OK;
}

static gscl_result measure_all_steps(sweep *w) {
    static const double factors[] = {0.25, 0.5, 0.7, 1, 1.4, 2, 4};
    gscl_subject *s = w->subject;
    size_t samples = (size_t)s->width * s->height * gsf_channel_count(&s->coded.file.header);
    w->unquantised = malloc(s->count * GSCL_PARAMS * sizeof *w->unquantised);
    w->params = malloc(s->count * GSCL_PARAMS * sizeof *w->params);
    w->rendering = malloc(samples * sizeof *w->rendering);
    w->exact = malloc(samples * sizeof *w->exact);
    w->planes = malloc(samples * sizeof *w->planes);
    if (!w->unquantised || !w->params || !w->rendering || !w->exact || !w->planes)
        return gscl_fail_memory(s->context);
    w->coded.file.header = s->coded.file.header;
    memcpy(w->coded.file.background, s->coded.file.background, sizeof w->coded.file.background);
    GSCL_TRY(gscl_coded_image_reserve(&w->coded, s->count));
    GSCL_TRY(fit_unquantised(w));
    GSCL_TRY(sweep_render(w, w->unquantised, w->exact));
    memcpy(w->planes, w->exact, samples * sizeof *w->planes);
    sweep_report(w, "none", 0, 0);
    for (size_t i = 0; i < sizeof factors / sizeof *factors; i++)
        GSCL_TRY(measure_steps(w, factors[i]));
    return GSCL_OK;
}

gscl_result gscl_measure_quantiser(gscl_subject *subject, gscl_accuracy_callback callback, void *opaque) {
    sweep w = {.subject = subject, .callback = callback, .opaque = opaque};
    gscl_result result = measure_all_steps(&w);
    gscl_fit_free(&w.fit);
    gscl_coded_image_free(&w.coded);
    free(w.unquantised);
    free(w.params);
    free(w.rendering);
    free(w.exact);
    free(w.planes);
    return result;
}
