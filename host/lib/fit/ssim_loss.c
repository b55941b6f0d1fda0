#include "fit/ssim_loss.h"

#include <string.h>

#include "cl/constants.h"
#include "cl/structs.h"
#include "runtime/mapping.h"

#define WINDOW GSCL_SSIM_WINDOW
#define MOMENTS 5
#define MAPS 3

void gscl_ssim_free(gscl_ssim *s) {
    gscl_buffer_free(&s->moments);
    gscl_buffer_free(&s->maps);
    memset(s, 0, sizeof *s);
}

static gscl_ssim_shape ssim_shape(const gscl_kernel_options *options, int width, int height) {
    return (gscl_ssim_shape){.width = width,
                             .height = height,
                             .channels = options->colours + options->alpha_channel,
                             .stride = width + 2 * GSCL_SSIM_MARGIN};
}

static size_t ssim_groups(const gscl_context *context, const gscl_ssim_shape *shape) {
    return gscl_chunk_groups(context, shape->width, shape->height * shape->channels);
}

static gscl_result ssim_kernel(gscl_context *context, const gscl_kernel_options *options, const char *name,
                               gscl_kernel **kernel) {
    return gscl_kernel_find(context, GSCL_PROGRAM_SSIM, options, name, kernel);
}

/* Makes room for the maps.  Their margins are zeros, which kernels never overwrite. */
static gscl_result ssim_reserve(gscl_ssim *s, gscl_context *context, const gscl_ssim_shape *shape) {
    size_t rows = (size_t)(shape->height + 2 * GSCL_SSIM_MARGIN) * (size_t)shape->channels;
    size_t map = (size_t)shape->stride * rows * sizeof(float);
    if (s->width == shape->width && s->height == shape->height && s->channels == shape->channels)
        return GSCL_OK;
    GSCL_TRY(gscl_buffer_reserve(context, &s->moments, MOMENTS * map));
    GSCL_TRY(gscl_buffer_reserve(context, &s->maps, MAPS * map));
    GSCL_TRY(gscl_buffer_zero(context, &s->moments, 0, MOMENTS * map));
    GSCL_TRY(gscl_buffer_zero(context, &s->maps, 0, MAPS * map));
    s->width = shape->width;
    s->height = shape->height;
    s->channels = shape->channels;
    return GSCL_OK;
}

/* Horizontal sums of the moments of two images. */
static gscl_result ssim_blur_rows(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options,
                                  const gscl_ssim_shape *shape, const gscl_buffer *first, const gscl_buffer *second) {
    gscl_kernel *kernel;
    GSCL_TRY(ssim_kernel(context, options, "ssim_blur_rows", &kernel));
    GSCL_TRY(ssim_reserve(s, context, shape));
    return GSCL_LAUNCH(context, kernel, ssim_groups(context, shape), gscl_chunk_group_size(context),
                       GSCL_ARG_BUFFER(*first), GSCL_ARG_BUFFER(*second), GSCL_ARG(*shape),
                       GSCL_ARG_BUFFER(s->moments));
}

/* Blurs the maps along y; the sums replace the moments. */
static gscl_result ssim_blur_columns(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options,
                                     const gscl_ssim_shape *shape) {
    gscl_kernel *kernel;
    GSCL_TRY(ssim_kernel(context, options, "ssim_blur_columns", &kernel));
    return GSCL_LAUNCH(context, kernel, ssim_groups(context, shape), gscl_chunk_group_size(context),
                       GSCL_ARG_BUFFER(s->maps), GSCL_ARG(*shape), GSCL_ARG_BUFFER(s->moments));
}

/* Finishes the derivative from the blurred maps. */
static gscl_result ssim_finish(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options,
                               const gscl_ssim_shape *shape, const gscl_buffer *rendering, const gscl_buffer *target,
                               float weight, gscl_buffer *derivative) {
    gscl_kernel *kernel;
    float pixels = (float)shape->width * (float)shape->height;
    bool has_windows = shape->width >= WINDOW && shape->height >= WINDOW;
    float windows = (float)(shape->width - WINDOW + 1) * (float)(shape->height - WINDOW + 1);
    float l1_share = has_windows ? 1.0f - weight : 1.0f;
    float ssim_share = has_windows ? 0.5f * weight * pixels / windows : 0.0f;
    size_t samples = (size_t)shape->width * (size_t)shape->height * (size_t)shape->channels;
    GSCL_TRY(gscl_buffer_reserve_image(context, derivative, samples * sizeof(float)));
    GSCL_TRY(ssim_kernel(context, options, "ssim_derivative", &kernel));
    return GSCL_LAUNCH(context, kernel, ssim_groups(context, shape), gscl_chunk_group_size(context),
                       GSCL_ARG_BUFFER(s->moments), GSCL_ARG_BUFFER(*rendering), GSCL_ARG_BUFFER(*target),
                       GSCL_ARG(*shape), GSCL_ARG(l1_share), GSCL_ARG(ssim_share), GSCL_ARG_BUFFER(*derivative));
}

gscl_result gscl_ssim_derivative(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options, int width,
                                 int height, const gscl_buffer *rendering, const gscl_buffer *target, float weight,
                                 gscl_buffer *derivative) {
    const gscl_ssim_shape shape = ssim_shape(options, width, height);
    gscl_kernel *kernel;
    GSCL_TRY(ssim_blur_rows(s, context, options, &shape, rendering, target));
    GSCL_TRY(ssim_kernel(context, options, "ssim_window_derivatives", &kernel));
    GSCL_TRY(GSCL_LAUNCH(context, kernel, ssim_groups(context, &shape), gscl_chunk_group_size(context),
                         GSCL_ARG_BUFFER(s->moments), GSCL_ARG(shape), GSCL_ARG_BUFFER(s->maps)));
    GSCL_TRY(ssim_blur_columns(s, context, options, &shape));
    return ssim_finish(s, context, options, &shape, rendering, target, weight, derivative);
}

/* Evaluates the windows of the target (of the rendering and it, if there is one) and blurs the maps along y. */
static gscl_result ssim_evaluate(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options,
                                 const gscl_ssim_shape *shape, const gscl_buffer *rendering,
                                 const gscl_buffer *target) {
    gscl_kernel *kernel;
    const int32_t has_rendering = rendering != NULL;
    GSCL_TRY(ssim_blur_rows(s, context, options, shape, rendering ? rendering : target, target));
    GSCL_TRY(ssim_kernel(context, options, "ssim_evaluate_windows", &kernel));
    GSCL_TRY(GSCL_LAUNCH(context, kernel, ssim_groups(context, shape), gscl_chunk_group_size(context),
                         GSCL_ARG_BUFFER(s->moments), GSCL_ARG(*shape), GSCL_ARG(has_rendering),
                         GSCL_ARG_BUFFER(s->maps)));
    return ssim_blur_columns(s, context, options, shape);
}

gscl_result gscl_ssim_weights(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options, int width,
                              int height, const gscl_buffer *rendering, const gscl_buffer *target,
                              gscl_buffer *weights) {
    const gscl_ssim_shape shape = ssim_shape(options, width, height);
    const int32_t has_rendering = rendering != NULL;
    gscl_kernel *kernel;
    GSCL_TRY(ssim_evaluate(s, context, options, &shape, rendering, target));
    GSCL_TRY(ssim_kernel(context, options, "ssim_weights", &kernel));
    GSCL_TRY(gscl_buffer_reserve_image(context, weights, (size_t)width * (size_t)height * sizeof(float)));
    return GSCL_LAUNCH(context, kernel, ssim_groups(context, &shape), gscl_chunk_group_size(context),
                       GSCL_ARG_BUFFER(s->moments), GSCL_ARG(shape), GSCL_ARG(has_rendering),
                       GSCL_ARG_BUFFER(*weights));
}

gscl_result gscl_ssim_contrast_gains(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options, int width,
                                     int height, gscl_buffer *gains) {
    const gscl_ssim_shape shape = ssim_shape(options, width, height);
    gscl_kernel *kernel;
    size_t plane = (size_t)width * (size_t)height * sizeof(float);
    GSCL_TRY(ssim_kernel(context, options, "ssim_contrast_gains", &kernel));
    GSCL_TRY(gscl_buffer_reserve_image(context, gains, 2 * (size_t)shape.channels * plane));
    return GSCL_LAUNCH(context, kernel, ssim_groups(context, &shape), gscl_chunk_group_size(context),
                       GSCL_ARG_BUFFER(s->moments), GSCL_ARG(shape), GSCL_ARG_BUFFER(*gains));
}
