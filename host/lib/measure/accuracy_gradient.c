/* Errors of the fit's derivatives: single precision on the device against central differences in double precision. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "measure/subject.h"
#include "measure/tunables.h"

/* A kind of parameters. */
typedef struct kind {
    const char *name;
    int first, end; /* parameters first..end - 1 of a splat */
} kind;

typedef struct gradient_check {
    gscl_subject *subject;
    gscl_rectangle part; /* of the image; positions below are relative to it */
    float *params;       /* as the subject's, relative to the part */
    float *target;
    size_t *chosen; /* splats whose derivatives are compared */
    size_t chosen_count;
    gscl_fit fit;
    float *gradients; /* of the fit */
    gscl_reference reference;
    double *exact; /* derivatives of the chosen splats, at GSCL_PARAMS for each splat */
    double *planes, *weights;
} gradient_check;

static int part_width(const gradient_check *b) {
    return b->part.x1 - b->part.x0;
}
static int part_height(const gradient_check *b) {
    return b->part.y1 - b->part.y0;
}

static size_t splat_nearest_centre(const gscl_subject *s) {
    size_t best = 0;
    double min_distance = INFINITY;
    for (size_t i = 0; i < s->count; i++) {
        const float *p = s->params + i * GSCL_PARAMS;
        double distance = hypot(p[GSCL_X] - 0.5 * s->width, p[GSCL_Y] - 0.5 * s->height);
        if (distance < min_distance) {
            min_distance = distance;
            best = i;
        }
    }
    return best;
}

/* The first of `length` pixels around `at`, within 0..size. */
static int start_of(float at, int length, uint32_t size) {
    double last = (double)size - length;
    return (int)fmin(fmax(floor(at - 0.5 * length), 0), last);
}

static int min_int(int a, int b) {
    return a < b ? a : b;
}

static gscl_rectangle part_around(const gscl_subject *s, size_t splat) {
    const float *p = s->params + splat * GSCL_PARAMS;
    const int side = gscl_measure_tunables.max_part_side;
    const int w = min_int((int)s->width, side), h = min_int((int)s->height, side);
    const int x = start_of(p[GSCL_X], w, s->width), y = start_of(p[GSCL_Y], h, s->height);
    return (gscl_rectangle){x, y, x + w, y + h};
}

static void copy_target_part(gradient_check *b) {
    const gscl_subject *s = b->subject;
    size_t width = (size_t)part_width(b), plane = (size_t)s->width * s->height;
    float *to = b->target;
    for (int k = 0; k < s->options.colours + s->options.alpha_channel; k++)
        for (int y = b->part.y0; y < b->part.y1; y++, to += width)
            memcpy(to, s->target + (size_t)k * plane + (size_t)y * s->width + b->part.x0, width * sizeof *to);
}

/* Chooses every n-th splat whose centre is in the part, so that there are at most settings.splats.  `first` counts as
 * in the part. */
static void choose_splats(gradient_check *b, size_t first) {
    const gscl_subject *s = b->subject;
    size_t found = 0;
    for (size_t i = 0; i < s->count; i++) {
        const float *p = b->params + i * GSCL_PARAMS;
        if (i == first || (p[GSCL_X] >= 0 && p[GSCL_X] < part_width(b) && p[GSCL_Y] >= 0 && p[GSCL_Y] < part_height(b)))
            b->chosen[found++] = i;
    }
    b->chosen_count = found < s->settings.splats ? found : s->settings.splats;
    for (size_t i = 0; i < b->chosen_count; i++)
        b->chosen[i] = b->chosen[i * found / b->chosen_count];
}

/* ---- Central differences in double precision ---- */

/* Half the sum of squared errors in a rectangle within the part. */
static double loss_in(const gradient_check *b, gscl_rectangle where) {
    const gscl_reference *r = &b->reference;
    const size_t width = (size_t)(where.x1 - where.x0), height = (size_t)(where.y1 - where.y0);
    double loss = 0;
    gscl_reference_draw(r, where, b->planes, b->weights);
    for (int k = 0; k < r->channels; k++)
        for (size_t y = 0; y < height; y++)
            for (size_t x = 0; x < width; x++) {
                size_t row = ((size_t)k * (size_t)part_height(b) + (size_t)where.y0 + y) * (size_t)part_width(b);
                double e = b->planes[((size_t)k * height + y) * width + x] - b->target[row + (size_t)where.x0 + x];
                loss += 0.5 * e * e;
            }
    return loss;
}

static gscl_rectangle union_of(gscl_rectangle a, gscl_rectangle b) {
    return (gscl_rectangle){a.x0 < b.x0 ? a.x0 : b.x0, a.y0 < b.y0 ? a.y0 : b.y0, a.x1 > b.x1 ? a.x1 : b.x1,
                            a.y1 > b.y1 ? a.y1 : b.y1};
}

/* The derivative of the loss by one parameter.  The loss changes only where the splat is, before or after a step. */
static double central_difference(gradient_check *b, size_t i, int parameter) {
    const gscl_rectangle all = {0, 0, part_width(b), part_height(b)};
    const double step = gscl_measure_tunables.difference_step;
    double p[GSCL_PARAMS], above, below;
    for (int k = 0; k < GSCL_PARAMS; k++)
        p[k] = b->params[i * GSCL_PARAMS + (size_t)k];
    const double at = p[parameter];
    gscl_rectangle where = gscl_reference_box(&b->reference, i, all);
    p[parameter] = at + step;
    gscl_reference_replace(&b->reference, i, p);
    where = union_of(where, gscl_reference_box(&b->reference, i, all));
    above = loss_in(b, where);
    p[parameter] = at - step;
    gscl_reference_replace(&b->reference, i, p);
    below = loss_in(b, where);
    p[parameter] = at;
    gscl_reference_replace(&b->reference, i, p);
    return (above - below) / (2 * step);
}

static void differentiate_reference(gradient_check *b) {
    const int end = GSCL_COLOUR + b->reference.channels;
    for (size_t i = 0; i < b->chosen_count; i++)
        for (int k = 0; k < end; k++)
            if (k != GSCL_OPACITY || b->reference.opacity)
                b->exact[b->chosen[i] * GSCL_PARAMS + (size_t)k] = central_difference(b, b->chosen[i], k);
}

/* ---- Derivatives on the device ---- */

static void set_exponential(gradient_check *b, int exponential) {
    gscl_kernel_options options = b->fit.renderer.options;
    options.exponential = exponential;
    gscl_renderer_set_options(&b->fit.renderer, &options);
}

static gscl_result run_gradients(void *opaque, size_t exponential) {
    gradient_check *b = opaque;
    set_exponential(b, (int)exponential);
    return gscl_fit_gradients(&b->fit, b->gradients); /* no tile is skipped */
}

static void compare_kind(const gradient_check *b, const kind *k, gscl_gradient_accuracy *a) {
    double errors = 0, squares = 0, largest = 0, largest_error = 0;
    a->kind = k->name;
    a->parameters = 0;
    for (size_t i = 0; i < b->chosen_count; i++)
        for (int p = k->first; p < k->end; p++, a->parameters++) {
            size_t at = b->chosen[i] * GSCL_PARAMS + (size_t)p;
            double error = fabs(b->gradients[at] - b->exact[at]);
            errors += error * error;
            squares += b->exact[at] * b->exact[at];
            largest_error = fmax(largest_error, error);
            largest = fmax(largest, fabs(b->exact[at]));
        }
    a->rms_error = squares > 0 ? sqrt(errors / squares) : 0;
    a->largest_error = largest > 0 ? largest_error / largest : 0;
}

/* Isotropic splats have one axis, which is neither of the reference's two; only rotated splats have an angle. */
static bool is_compared(const gscl_subject *s, const kind *k) {
    return k->first == GSCL_OPACITY  ? s->options.opacity
           : k->first == GSCL_LOG_S1 ? s->options.shape != GSCL_SHAPE_ISOTROPIC
           : k->first == GSCL_THETA  ? s->options.shape == GSCL_SHAPE_ROTATED
                                     : true;
}

static gscl_result measure_variant(gradient_check *b, int exponential, double seconds, gscl_gradient_callback callback,
                                   void *opaque) {
    const gscl_subject *s = b->subject;
    const kind kinds[] = {{"position", GSCL_X, GSCL_LOG_S1},
                          {"scale", GSCL_LOG_S1, GSCL_THETA},
                          {"angle", GSCL_THETA, GSCL_OPACITY},
                          {"opacity", GSCL_OPACITY, GSCL_COLOUR},
                          {"colour", GSCL_COLOUR, GSCL_COLOUR + b->reference.channels}};
    gscl_gradient_accuracy a = {.variant = gscl_exponential_name(exponential),
                                .is_default = exponential == GSCL_EXPONENTIAL_POLYNOMIAL,
                                .blend = gscl_subject_blend(s),
                                .ns_per_pixel = 1e9 * seconds / ((double)part_width(b) * part_height(b))};
    set_exponential(b, exponential);
    GSCL_TRY(gscl_fit_gradients(&b->fit, b->gradients));
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (!is_compared(s, &kinds[i]))
            continue;
        compare_kind(b, &kinds[i], &a);
        callback(opaque, &a);
    }
    return GSCL_OK;
}

static gscl_result measure_variants(gradient_check *b, gscl_gradient_callback callback, void *opaque) {
    double seconds[GSCL_EXPONENTIAL_NATIVE + 1];
    differentiate_reference(b);
    GSCL_TRY(gscl_subject_time(b->subject, run_gradients, b, GSCL_EXPONENTIAL_NATIVE + 1, seconds));
    for (int i = GSCL_EXPONENTIAL_POLYNOMIAL; i <= GSCL_EXPONENTIAL_NATIVE; i++)
        GSCL_TRY(measure_variant(b, i, seconds[i], callback, opaque));
    return GSCL_OK;
}

static gscl_result create_fit(gradient_check *b) {
    const gscl_subject *s = b->subject;
    gscl_kernel_options options = s->options;
    options.loss = GSCL_LOSS_KIND_L2;
    GSCL_TRY(gscl_fit_create(&b->fit, s->context, &options, (uint32_t)part_width(b), (uint32_t)part_height(b), 0,
                             b->target));
    GSCL_TRY(gscl_renderer_set_splats(&b->fit.renderer, NULL, 0, s->background));
    return gscl_fit_append(&b->fit, b->params, s->count);
}

static gscl_result gradient_check_prepare(gradient_check *b) {
    const gscl_subject *s = b->subject;
    size_t values = s->count * GSCL_PARAMS, channels = (size_t)(s->options.colours + s->options.alpha_channel);
    const size_t first = splat_nearest_centre(s);
    b->part = part_around(s, first);
    size_t pixels = (size_t)part_width(b) * (size_t)part_height(b);
    b->params = malloc(values * sizeof *b->params);
    b->target = malloc(pixels * channels * sizeof *b->target);
    b->chosen = malloc(s->count * sizeof *b->chosen);
    b->gradients = malloc(values * sizeof *b->gradients);
    b->exact = calloc(values, sizeof *b->exact);
    b->planes = malloc(pixels * channels * sizeof *b->planes);
    b->weights = malloc(pixels * sizeof *b->weights);
    if (!b->params || !b->target || !b->chosen || !b->gradients || !b->exact || !b->planes || !b->weights)
        return gscl_fail_memory(s->context);
    memcpy(b->params, s->params, values * sizeof *b->params);
    for (size_t i = 0; i < s->count; i++) {
        b->params[i * GSCL_PARAMS + GSCL_X] -= (float)b->part.x0;
        b->params[i * GSCL_PARAMS + GSCL_Y] -= (float)b->part.y0;
    }
    copy_target_part(b);
    choose_splats(b, first);
    GSCL_TRY(gscl_reference_create(&b->reference, &s->options, b->params, s->count, s->background, true));
    return create_fit(b);
}

static void gradient_check_free(gradient_check *b) {
    gscl_fit_free(&b->fit);
    gscl_reference_free(&b->reference);
    free(b->params);
    free(b->target);
    free(b->chosen);
    free(b->gradients);
    free(b->exact);
    free(b->planes);
    free(b->weights);
}

gscl_result gscl_measure_gradients(gscl_context *context, const gscl_image *image, const uint8_t *bytes, size_t size,
                                   const gscl_accuracy_settings *settings, gscl_gradient_callback callback,
                                   void *opaque) {
    gscl_subject subject;
    gscl_forget_message(context);
    if (!callback)
        return gscl_complete_message(context, GSCL_ERROR_INVALID_ARGUMENT);
    gscl_result result = gscl_subject_open(&subject, context, image, bytes, size, settings);
    gradient_check b = {.subject = &subject};
    if (result == GSCL_OK)
        result = gradient_check_prepare(&b);
    if (result == GSCL_OK)
        result = measure_variants(&b, callback, opaque);
    gradient_check_free(&b);
    gscl_subject_close(&subject);
    return gscl_complete_message(context, result);
}
