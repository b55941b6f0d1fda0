#include "fit/ssim_loss.h"

#include <string.h>

#include "cl/constants.h"

#define WINDOW 11
#define MAPS 5
#define GROUP 16 /* work-items; few, so that small levels still fill all cores */

void gscl_ssim_free(gscl_ssim *s) {
    gscl_buffer_free(&s->moments);
    gscl_buffer_free(&s->slopes);
    memset(s, 0, sizeof *s);
}

/* What all kernels of cl/ssim.cl are told about an image. */
typedef struct shape {
    cl_int width, height, channels, stride;
    cl_ulong image;
    size_t groups;
} shape;

static shape shape_of(const gscl_context *context, const gscl_kernel_options *options, int width, int height) {
    shape s = {.width = width, .height = height, .channels = options->colours + options->alpha_channel};
    s.stride = width + 2 * GSCL_SSIM_MARGIN;
    s.image = (cl_ulong)s.stride * (cl_ulong)(height + 2 * GSCL_SSIM_MARGIN) * (cl_ulong)s.channels;
    s.groups = gscl_chunk_groups(context, width, height * s.channels, GROUP);
    return s;
}

#define SHAPE_ARGS(s) \
    GSCL_ARG((s).width), GSCL_ARG((s).height), GSCL_ARG((s).channels), GSCL_ARG((s).stride), GSCL_ARG((s).image)

static bool has_windows(const shape *s) {
    return s->width >= WINDOW && s->height >= WINDOW;
}

/* Makes room for the maps; margins are zeros, which kernels never overwrite. */
static gscl_result prepare(gscl_ssim *s, gscl_context *context, const shape *is) {
    size_t map = (size_t)is->image * sizeof(float);
    if (s->width == is->width && s->height == is->height && s->channels == is->channels)
        return GSCL_OK;
    GSCL_TRY(gscl_buffer_reserve(context, &s->moments, MAPS * map));
    GSCL_TRY(gscl_buffer_reserve(context, &s->slopes, 3 * map));
    GSCL_TRY(gscl_buffer_zero(context, &s->moments, 0, MAPS * map));
    GSCL_TRY(gscl_buffer_zero(context, &s->slopes, 0, 3 * map));
    s->width = is->width;
    s->height = is->height;
    s->channels = is->channels;
    return GSCL_OK;
}

gscl_result gscl_ssim_derivative(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options, int width,
                                 int height, const gscl_buffer *picture, const gscl_buffer *target, float weight,
                                 gscl_buffer *derivative) {
    shape is = shape_of(context, options, width, height);
    size_t samples = (size_t)width * (size_t)height * (size_t)is.channels;
    bool windows = has_windows(&is);
    cl_float l1_share = windows ? 1.0f - weight : 1.0f;
    cl_float share = windows ? 0.5f * weight * ((float)width * (float)height) /
                                   ((float)(width - WINDOW + 1) * (float)(height - WINDOW + 1))
                             : 0.0f;
    cl_kernel rows, per_window, columns, slope;
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_rows", &rows));
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_windows", &per_window));
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_columns", &columns));
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_slope", &slope));
    GSCL_TRY(prepare(s, context, &is));
    GSCL_TRY(gscl_buffer_reserve_image(context, derivative, samples * sizeof(float)));
    GSCL_TRY(GSCL_LAUNCH(context, rows, is.groups, GROUP, GSCL_ARG_BUFFER(*picture), GSCL_ARG_BUFFER(*target),
                         SHAPE_ARGS(is), GSCL_ARG_BUFFER(s->moments)));
    GSCL_TRY(GSCL_LAUNCH(context, per_window, is.groups, GROUP, GSCL_ARG_BUFFER(s->moments), SHAPE_ARGS(is),
                         GSCL_ARG_BUFFER(s->slopes)));
    /* The moments are done with: the sums take their place. */
    GSCL_TRY(GSCL_LAUNCH(context, columns, is.groups, GROUP, GSCL_ARG_BUFFER(s->slopes), SHAPE_ARGS(is),
                         GSCL_ARG_BUFFER(s->moments)));
    return GSCL_LAUNCH(context, slope, is.groups, GROUP, GSCL_ARG_BUFFER(s->moments), GSCL_ARG_BUFFER(*picture),
                       GSCL_ARG_BUFFER(*target), SHAPE_ARGS(is), GSCL_ARG(l1_share), GSCL_ARG(share),
                       GSCL_ARG_BUFFER(*derivative));
}

/* Judges the windows of `target` (of `picture` and it, if there is one) and blurs the maps back along y: into
 * s->moments. */
static gscl_result judge(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options, const shape *is,
                         const gscl_buffer *picture, const gscl_buffer *target) {
    const gscl_buffer *first = picture ? picture : target;
    cl_kernel rows, windows, columns;
    cl_int known = picture != NULL;
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_rows", &rows));
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_judge", &windows));
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_columns", &columns));
    GSCL_TRY(prepare(s, context, is));
    GSCL_TRY(GSCL_LAUNCH(context, rows, is->groups, GROUP, GSCL_ARG_BUFFER(*first), GSCL_ARG_BUFFER(*target),
                         SHAPE_ARGS(*is), GSCL_ARG_BUFFER(s->moments)));
    GSCL_TRY(GSCL_LAUNCH(context, windows, is->groups, GROUP, GSCL_ARG_BUFFER(s->moments), SHAPE_ARGS(*is),
                         GSCL_ARG(known), GSCL_ARG_BUFFER(s->slopes)));
    return GSCL_LAUNCH(context, columns, is->groups, GROUP, GSCL_ARG_BUFFER(s->slopes), SHAPE_ARGS(*is),
                       GSCL_ARG_BUFFER(s->moments));
}

gscl_result gscl_ssim_weights(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options, int width,
                              int height, const gscl_buffer *picture, const gscl_buffer *target, gscl_buffer *weights) {
    shape is = shape_of(context, options, width, height);
    cl_int known = picture != NULL;
    cl_kernel weigh;
    GSCL_TRY(judge(s, context, options, &is, picture, target));
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_weights", &weigh));
    GSCL_TRY(gscl_buffer_reserve_image(context, weights, (size_t)width * (size_t)height * sizeof(float)));
    return GSCL_LAUNCH(context, weigh, is.groups, GROUP, GSCL_ARG_BUFFER(s->moments), SHAPE_ARGS(is), GSCL_ARG(known),
                       GSCL_ARG_BUFFER(*weights));
}

gscl_result gscl_ssim_contrast_gains(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options, int width,
                                     int height, gscl_buffer *gains) {
    shape is = shape_of(context, options, width, height);
    cl_kernel kernel;
    size_t plane = (size_t)width * (size_t)height * sizeof(float);
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_gains", &kernel));
    GSCL_TRY(gscl_buffer_reserve_image(context, gains, 2 * (size_t)is.channels * plane));
    return GSCL_LAUNCH(context, kernel, is.groups, GROUP, GSCL_ARG_BUFFER(s->moments), SHAPE_ARGS(is),
                       GSCL_ARG_BUFFER(*gains));
}
