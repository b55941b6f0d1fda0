#include "ssim.h"

#include <string.h>

#include "constants.h"

#define WINDOW 11
#define MAPS 5
#define GROUP 16 /* work-items; few, so that small levels still fill all cores */

void gscl_ssim_free(gscl_ssim *s) {
    gscl_buffer_free(&s->moments);
    gscl_buffer_free(&s->slopes);
    memset(s, 0, sizeof *s);
}

/* Makes room for the maps; margins are zeros, which kernels never overwrite. */
static gscl_result prepare(gscl_ssim *s, gscl_context *context, int width, int height, int channels, size_t image) {
    if (s->width == width && s->height == height && s->channels == channels)
        return GSCL_OK;
    GSCL_TRY(gscl_buffer_reserve(context, &s->moments, MAPS * image * sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve(context, &s->slopes, 3 * image * sizeof(float)));
    GSCL_TRY(gscl_buffer_zero(context, &s->moments, 0, MAPS * image * sizeof(float)));
    GSCL_TRY(gscl_buffer_zero(context, &s->slopes, 0, 3 * image * sizeof(float)));
    s->width = width;
    s->height = height;
    s->channels = channels;
    return GSCL_OK;
}

gscl_result gscl_ssim_derivative(gscl_ssim *s, gscl_context *context, const gscl_kernel_options *options, int width,
                                 int height, const gscl_buffer *picture, const gscl_buffer *target, float weight,
                                 gscl_buffer *derivative) {
    cl_int w = width, h = height, channels = options->colours + options->alpha_channel,
           stride = width + 2 * GSCL_SSIM_MARGIN;
    cl_ulong image = (cl_ulong)stride * (cl_ulong)(height + 2 * GSCL_SSIM_MARGIN) * (cl_ulong)channels;
    size_t samples = (size_t)width * (size_t)height * (size_t)channels;
    size_t groups = gscl_chunk_groups(context, width, height * channels, GROUP);
    bool windows = width >= WINDOW && height >= WINDOW;
    cl_float l1_share = windows ? 1.0f - weight : 1.0f;
    cl_float share = windows ? 0.5f * weight * ((float)width * (float)height) /
                                   ((float)(width - WINDOW + 1) * (float)(height - WINDOW + 1))
                             : 0.0f;
    cl_kernel rows, per_window, columns, slope;
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_rows", &rows));
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_windows", &per_window));
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_columns", &columns));
    GSCL_TRY(gscl_kernel(context, GSCL_PROGRAM_SSIM, options, "ssim_slope", &slope));
    GSCL_TRY(prepare(s, context, width, height, channels, (size_t)image));
    GSCL_TRY(gscl_buffer_reserve_image(context, derivative, samples * sizeof(float)));
    GSCL_TRY(GSCL_LAUNCH(context, rows, groups, GROUP, GSCL_ARG_BUFFER(*picture), GSCL_ARG_BUFFER(*target), GSCL_ARG(w),
                         GSCL_ARG(h), GSCL_ARG(channels), GSCL_ARG(stride), GSCL_ARG(image),
                         GSCL_ARG_BUFFER(s->moments)));
    GSCL_TRY(GSCL_LAUNCH(context, per_window, groups, GROUP, GSCL_ARG_BUFFER(s->moments), GSCL_ARG(w), GSCL_ARG(h),
                         GSCL_ARG(channels), GSCL_ARG(stride), GSCL_ARG(image), GSCL_ARG_BUFFER(s->slopes)));
    /* The moments are done with: the sums take their place. */
    GSCL_TRY(GSCL_LAUNCH(context, columns, groups, GROUP, GSCL_ARG_BUFFER(s->slopes), GSCL_ARG(w), GSCL_ARG(h),
                         GSCL_ARG(channels), GSCL_ARG(stride), GSCL_ARG(image), GSCL_ARG_BUFFER(s->moments)));
    return GSCL_LAUNCH(context, slope, groups, GROUP, GSCL_ARG_BUFFER(s->moments), GSCL_ARG_BUFFER(*picture),
                       GSCL_ARG_BUFFER(*target), GSCL_ARG(w), GSCL_ARG(h), GSCL_ARG(channels), GSCL_ARG(stride),
                       GSCL_ARG(image), GSCL_ARG(l1_share), GSCL_ARG(share), GSCL_ARG_BUFFER(*derivative));
}
