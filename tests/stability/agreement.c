/* Forward and backward, against the oracle and its bounds. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "both_mappings.h"
#include "check.h"
#include "fit/fit.h"
#include "fit_oracle.h"
#include "report.h"
#ifdef GSCL_WITH_OPENCL
#include "opencl/opencl_device.h"
#endif
#ifdef GSCL_WITH_NATIVE
#include "native/native_device.h"
#endif

#define KINDS (GSCL_COLOUR + 1)

const char *const stability_blends[3] = {"normalized", "alpha", "sum"};
static const char *const kinds[KINDS] = {"x", "y", "ln s1", "ln s2", "theta", "opacity", "colour"};

int stability_mapping_count(void) {
    return mapping_count;
}
gscl_context *stability_context(int mapping) {
    return contexts[mapping];
}
const char *stability_mapping_name(int mapping) {
    return mapping_names[mapping];
}
int stability_decoders(gscl_context *const **decoders) {
    *decoders = contexts;
    return decoder_count;
}
int stability_open(void **state) {
    return open_contexts(state);
}
int stability_close(void **state) {
    return close_contexts(state);
}

/* Whether the device's fma() rounds the product. */
static bool rounds_products(const gscl_context *context) {
#ifdef GSCL_WITH_NATIVE
    if (context->is_host) { /* those of SOFTWARE_FMA in host/lib/native/meson.build */
        const char *name = gscl_native(context)->processor->name;
        return strcmp(name, "x86_64_v2") == 0 || strcmp(name, "i686_sse2") == 0;
    }
#endif
#ifdef GSCL_WITH_OPENCL
    return gscl_opencl(context)->quirks->software_fma;
#else
    return false;
#endif
}

/* ---- The oracle's side ---- */

typedef struct {
    double *planes, *bounds;            /* of all samples */
    double *gradient, *gradient_bounds; /* of all parameters */
    double *natural;                    /* their natural steps */
} reference;

static double *allocate_doubles(size_t count) {
    double *values = calloc(count + 1, sizeof *values);
    assert_non_null(values);
    return values;
}

static size_t samples_of(const scene *s) {
    return (size_t)scene_level_width(s) * (size_t)scene_level_height(s) * SCENE_CHANNELS;
}

static reference reference_create(const scene *s, const float background[4]) {
    const size_t samples = samples_of(s), parameters = s->count * GSCL_PARAMS;
    double *target = allocate_doubles(samples), *params = allocate_doubles(parameters);
    reference t = {allocate_doubles(samples), allocate_doubles(samples), allocate_doubles(parameters),
                   allocate_doubles(parameters), allocate_doubles(parameters)};
    oracle_fit fit = {.blend = (oracle_blend)s->blend,
                      .colours = SCENE_CHANNELS,
                      .opacity = true,
                      .stepped = s->shape != GSCL_SHAPE_ROTATED,
                      .rounds_products = rounds_products(contexts[0]),
                      .level = s->level,
                      .width = scene_level_width(s),
                      .height = scene_level_height(s),
                      .target = target};
    for (int k = 0; k < SCENE_CHANNELS; k++)
        fit.background[k] = background[k];
    for (size_t i = 0; i < samples; i++)
        target[i] = s->target[i];
    for (size_t i = 0; i < parameters; i++)
        params[i] = s->params[i];
    oracle_fit_draw(&fit, params, s->count, t.planes);
    oracle_fit_gradient(&fit, params, s->count, s->stride, t.gradient);
    oracle_fit_bounds(&fit, params, s->count, t.bounds, t.gradient_bounds);
    const bool rotated = s->shape == GSCL_SHAPE_ROTATED, isotropic = s->shape == GSCL_SHAPE_ISOTROPIC;
    for (size_t i = 0; i < s->count; i++) {
        oracle_shape_gradient(t.gradient + i * GSCL_PARAMS, rotated, isotropic);
        oracle_shape_gradient(t.gradient_bounds + i * GSCL_PARAMS, rotated, isotropic);
    }
    for (size_t i = 0; i < parameters; i++)
        t.natural[i] = oracle_natural_step(&fit, params + i / GSCL_PARAMS * GSCL_PARAMS, i % GSCL_PARAMS);
    free(target);
    free(params);
    return t;
}

static void reference_free(reference *t) {
    free(t->planes);
    free(t->bounds);
    free(t->gradient);
    free(t->gradient_bounds);
    free(t->natural);
}

/* ---- The library's side ---- */

typedef struct {
    float *values; /* samples, then gradients */
    size_t samples, gradients;
    float background[4];
    double loss;
} outcome;

static gscl_result run_fit(gscl_fit *fit, const scene *s, outcome *o) {
    GSCL_TRY(gscl_fit_append(fit, s->params, s->count));
    GSCL_TRY(gscl_fit_gradients(fit, o->values + o->samples));
    GSCL_TRY(gscl_fit_loss(fit, &o->loss));
    GSCL_TRY(gscl_renderer_render(&fit->renderer));
    memcpy(o->background, fit->background, sizeof o->background);
    return gscl_buffer_read(fit->context, &fit->renderer.image, 0, o->values, o->samples * sizeof(float));
}

static gscl_result run_scene(gscl_context *context, const scene *s, outcome *o) {
    const gscl_kernel_options options = {.blend = s->blend, .colours = SCENE_CHANNELS, .opacity = 1, .shape = s->shape};
    gscl_fit fit;
    *o = (outcome){.samples = samples_of(s), .gradients = s->count * GSCL_PARAMS};
    o->values = calloc(o->samples + o->gradients + 1, sizeof *o->values);
    assert_non_null(o->values);
    gscl_result result =
        gscl_fit_create(&fit, context, &options, (uint32_t)s->width, (uint32_t)s->height, s->level, s->target);
    if (result == GSCL_OK)
        result = run_fit(&fit, s, o);
    gscl_fit_free(&fit);
    return result;
}

/* ---- Comparison ---- */

static bool outcome_is_finite(const outcome *o, char *message, size_t capacity) {
    for (size_t i = 0; i < o->samples + o->gradients; i++) {
        const size_t p = i - o->samples;
        if (isfinite(o->values[i]))
            continue;
        if (i < o->samples)
            snprintf(message, capacity, "sample %zu is %g", i, o->values[i]);
        else
            snprintf(message, capacity, "splat %zu, parameter %zu: gradient %g", p / GSCL_PARAMS, p % GSCL_PARAMS,
                     o->values[i]);
        return false;
    }
    if (!isfinite(o->loss))
        snprintf(message, capacity, "the loss is %g", o->loss);
    return isfinite(o->loss);
}

static bool check_forward(const reference *t, const outcome *o, scene_errors *e, char *message, size_t capacity) {
    for (size_t i = 0; i < o->samples; i++) {
        const double error = fabs(o->values[i] - t->planes[i]), bound = t->bounds[i];
        e->forward = fmax(e->forward, 255.0 * error);
        e->forward_bound = fmax(e->forward_bound, 255.0 * bound);
        e->share = bound > 0.0 ? fmax(e->share, error / bound) : e->share;
        if (error <= bound)
            continue;
        snprintf(message, capacity, "sample %zu is %.9g, %.9g expected, at most %.3g apart", i, o->values[i],
                 t->planes[i], bound);
        return false;
    }
    return true;
}

/* Whether the oracle has a gradient for a parameter. */
static bool is_differenced(const scene *s, size_t i) {
    return (s->count - 1 - i / GSCL_PARAMS) % s->stride == 0 && i % GSCL_PARAMS < GSCL_COLOUR + SCENE_CHANNELS;
}

/* The largest change of the loss by one natural step along a gradient. */
static double largest_change(const scene *s, const reference *t) {
    double largest = 0.0;
    for (size_t i = 0; i < s->count * GSCL_PARAMS; i++)
        largest = fmax(largest, fabs(t->gradient[i]) * t->natural[i]);
    return largest;
}

static bool check_backward(const scene *s, const reference *t, const outcome *o, scene_errors *e, char *message,
                           size_t capacity) {
    const double largest = largest_change(s, t);
    for (size_t i = 0; i < o->gradients; i++) {
        const double found = o->values[o->samples + i], error = fabs(found - t->gradient[i]);
        const double bound = t->gradient_bounds[i];
        const bool is_angle = i % GSCL_PARAMS == GSCL_THETA;
        if (!is_differenced(s, i))
            continue;
        if (largest > 0.0) {
            e->backward = fmax(e->backward, error * t->natural[i] / largest);
            e->backward_bound = fmax(e->backward_bound, bound * t->natural[i] / largest);
        }
        e->share = bound > 0.0 ? fmax(e->share, error / bound) : e->share;
        if (error <= bound && !(s->isotropic && is_angle && found != 0.0))
            continue;
        const size_t kind = i % GSCL_PARAMS < GSCL_COLOUR ? i % GSCL_PARAMS : GSCL_COLOUR;
        snprintf(message, capacity, "splat %zu, %s: gradient %.9g, %.9g expected, at most %.3g apart", i / GSCL_PARAMS,
                 kinds[kind], found, t->gradient[i], bound);
        return false;
    }
    return true;
}

static bool same_bits(const outcome *a, const outcome *b, char *message, size_t capacity) {
    if (!memcmp(a->values, b->values, (a->samples + a->gradients) * sizeof(float)) && a->loss == b->loss)
        return true;
    snprintf(message, capacity, "a second run has other bits");
    return false;
}

static bool outcomes_agree(const scene *s, const outcome outcomes[2 * STABILITY_MAPPINGS],
                           scene_errors errors[STABILITY_MAPPINGS], char *message, size_t capacity) {
    reference t = reference_create(s, outcomes[0].background);
    bool good = true;
    for (int m = 0; m < mapping_count && good; m++) {
        char what[200] = "";
        good = outcome_is_finite(&outcomes[m], what, sizeof what) &&
               check_forward(&t, &outcomes[m], &errors[m], what, sizeof what) &&
               check_backward(s, &t, &outcomes[m], &errors[m], what, sizeof what) &&
               (!outcomes[m + mapping_count].values ||
                same_bits(&outcomes[m], &outcomes[m + mapping_count], what, sizeof what));
        if (!good)
            snprintf(message, capacity, "%s mapping: %s", mapping_names[m], what);
    }
    reference_free(&t);
    return good;
}

bool scene_agrees(const scene *s, scene_errors errors[STABILITY_MAPPINGS], char *message, size_t capacity) {
    outcome outcomes[2 * STABILITY_MAPPINGS] = {{0}}; /* of all mappings, twice */
    const int runs = mapping_count * (int)scene_scaled(2, 1);
    bool good = true;
    memset(errors, 0, STABILITY_MAPPINGS * sizeof *errors);
    for (int i = 0; i < runs; i++) {
        const int m = i % mapping_count;
        if (run_scene(contexts[m], s, &outcomes[i]) == GSCL_OK)
            continue;
        snprintf(message, capacity, "%s mapping: %s", mapping_names[m], gscl_context_message(contexts[m]));
        good = false;
    }
    good = good && outcomes_agree(s, outcomes, errors, message, capacity);
    for (int i = 0; i < 2 * STABILITY_MAPPINGS; i++)
        free(outcomes[i].values);
    return good;
}

void check_scene(const scene *s) {
    scene_errors errors[STABILITY_MAPPINGS];
    char message[300];
    if (!scene_agrees(s, errors, message, sizeof message) ||
        (s->shape == GSCL_SHAPE_ROTATED && !scene_encodes(s, message, sizeof message)))
        fail_msg("%s, %s: %s", s->name, stability_blends[s->blend], message);
    for (int m = 0; m < mapping_count; m++) {
        char detail[40];
        snprintf(detail, sizeof detail, "%s, %s", stability_blends[s->blend], mapping_names[m]);
        report("scene", s->name, detail, "forward", errors[m].forward_bound, errors[m].forward);
        report("scene", s->name, detail, "backward", errors[m].backward_bound, errors[m].backward);
        report("scene", s->name, detail, "share", 1.0, errors[m].share);
    }
}
