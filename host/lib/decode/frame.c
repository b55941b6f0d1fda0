#include "decode/frame.h"

#include <inttypes.h>
#include <math.h>

#include "cl/constants.h"
#include "decode/ellipse.h"
#include "decode/resize.h"
#include "runtime/context.h"

static gscl_result resolve_size(gscl_context *context, const gscl_decode_settings *s, const gsf_header *header,
                                gscl_frame *f) {
    if ((s->width == 0) != (s->height == 0))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "both width and height must be given, or neither");
    f->full_width = s->width ? s->width : header->width;
    f->full_height = s->height ? s->height : header->height;
    f->scale_x = (double)f->full_width / header->width;
    f->scale_y = (double)f->full_height / header->height;
    if (f->full_width > GSCL_MAX_DIMENSION || f->full_height > GSCL_MAX_DIMENSION)
        return gscl_fail(context, GSCL_ERROR_IMAGE_SIZE, "cannot draw %ux%u pixels; at most %dx%d", f->full_width,
                         f->full_height, GSCL_MAX_DIMENSION, GSCL_MAX_DIMENSION);
    return GSCL_OK;
}

static gscl_result resolve_crop(gscl_context *context, const gscl_decode_settings *s, gscl_frame *f) {
    f->x = s->crop_x;
    f->y = s->crop_y;
    f->width = s->crop_width;
    f->height = s->crop_height;
    if (f->width == 0)
        f->width = f->full_width > f->x ? f->full_width - f->x : 0;
    if (f->height == 0)
        f->height = f->full_height > f->y ? f->full_height - f->y : 0;
    if (f->width == 0 || f->height == 0 || f->width > f->full_width || f->height > f->full_height ||
        f->x > f->full_width - f->width || f->y > f->full_height - f->height)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "crop %u,%u,%u,%u does not lie inside %ux%u", s->crop_x,
                         s->crop_y, s->crop_width, s->crop_height, f->full_width, f->full_height);
    return GSCL_OK;
}

/* The number of pixels in the returned rectangle. */
static uint64_t frame_pixels(const gscl_frame *f) {
    return (uint64_t)f->width * f->height;
}

gscl_result gscl_frame_resolve(gscl_context *context, const gscl_decode_settings *s, const gsf_header *header,
                               gscl_frame *f) {
    GSCL_TRY(resolve_size(context, s, header, f));
    GSCL_TRY(resolve_crop(context, s, f));
    const uint64_t pixels = frame_pixels(f);
    if (s->max_pixels && pixels > s->max_pixels)
        return gscl_fail(context, GSCL_ERROR_LIMIT,
                         "the decoded image has %" PRIu64 " pixels (%ux%u); max_pixels is %" PRIu64, pixels, f->width,
                         f->height, s->max_pixels);
    if (s->max_work && header->splat_count > s->max_work)
        return gscl_fail(context, GSCL_ERROR_LIMIT,
                         "the file has %" PRIu32 " splats of at least one evaluation each; max_work is %" PRIu64,
                         header->splat_count, s->max_work);
    return GSCL_OK;
}

gscl_kernel_options gscl_frame_options(const gsf_header *header, const gscl_frame *f) {
    gscl_kernel_options options = gscl_coded_image_options(header);
    if (!(options.shape == GSCL_SHAPE_ISOTROPIC && f->scale_x == f->scale_y) && (f->scale_x != 1 || f->scale_y != 1))
        options.shape = GSCL_SHAPE_ROTATED; /* scaling turns the axes */
    return options;
}

/* Length of the part of [centre - half, centre + half] that lies inside [first, first + length]. */
static double overlap(double centre, double half, double first, double length) {
    return fmax(0, fmin(centre + half, first + length) - fmax(centre - half, first));
}

/* Area of the rectangle around a splat's outline inside the frame; the kernel `project` computes the same half
 * sizes. */
static double outline_area(const float *p, const gscl_frame *f) {
    const gscl_half_size half =
        gscl_ellipse_half_size(p[GSCL_LOG_S1], p[GSCL_LOG_S2], p[GSCL_THETA], 0, sqrt(2 * GSCL_SUPPORT));
    return overlap(p[GSCL_X], half.width, f->x, f->width) * overlap(p[GSCL_Y], half.height, f->y, f->height);
}

uint64_t gscl_frame_work(const gscl_coded_image *coded, const gscl_frame *f) {
    const gsf_header *header = &coded->file.header;
    uint64_t work = 0;
    for (uint32_t i = 0; i < header->splat_count; i++) {
        float params[GSCL_PARAMS];
        gscl_coded_image_splat(coded, i, params);
        gscl_resize_splats(params, 1, f->scale_x, f->scale_y);
        work += (uint64_t)fmax(1, ceil(outline_area(params, f)));
    }
    return work;
}

gscl_result gscl_frame_check_work(gscl_context *context, const gscl_decode_settings *s, const gscl_coded_image *coded,
                                  const gscl_frame *f) {
    const uint64_t bound = coded->file.header.splat_count * frame_pixels(f); /* at most 2^48 */
    if (s->max_work == 0 || bound <= s->max_work)
        return GSCL_OK;
    const uint64_t work = gscl_frame_work(coded, f);
    if (work > s->max_work)
        return gscl_fail(context, GSCL_ERROR_LIMIT,
                         "drawing the image takes %" PRIu64 " evaluations; max_work is %" PRIu64, work, s->max_work);
    return GSCL_OK;
}
