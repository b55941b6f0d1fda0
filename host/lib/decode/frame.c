#include "decode/frame.h"

#include "cl/constants.h"
#include "decode/dequantise.h"
#include "decode/ellipse.h"
#include "decode/resize.h"
#include "runtime/context.h"

static gscl_result resolve_size(const gscl_decode_settings *s, const gsf_header *header, gscl_frame *f) {
    if ((s->width == 0) != (s->height == 0))
        return GSCL_ERROR_INVALID_ARGUMENT;
    f->full_width = s->width ? s->width : header->width;
    f->full_height = s->height ? s->height : header->height;
    f->scale_x = (gscl_real)f->full_width / (gscl_real)header->width;
    f->scale_y = (gscl_real)f->full_height / (gscl_real)header->height;
    return f->full_width > GSCL_MAX_DIMENSION || f->full_height > GSCL_MAX_DIMENSION ? GSCL_ERROR_IMAGE_SIZE : GSCL_OK;
}

static gscl_result resolve_crop(const gscl_decode_settings *s, gscl_frame *f) {
    f->x = s->crop_x;
    f->y = s->crop_y;
    f->width = s->crop_width;
    f->height = s->crop_height;
    if (f->width == 0)
        f->width = f->full_width > f->x ? f->full_width - f->x : 0;
    if (f->height == 0)
        f->height = f->full_height > f->y ? f->full_height - f->y : 0;
    const bool is_inside = f->width > 0 && f->height > 0 && f->width <= f->full_width && f->height <= f->full_height &&
                           f->x <= f->full_width - f->width && f->y <= f->full_height - f->height;
    return is_inside ? GSCL_OK : GSCL_ERROR_INVALID_ARGUMENT;
}

uint64_t gscl_frame_pixels(const gscl_frame *f) {
    return (uint64_t)f->width * f->height;
}

gscl_result gscl_frame_resolve(const gscl_decode_settings *s, const gsf_header *header, gscl_frame *f) {
    GSCL_TRY(resolve_size(s, header, f));
    GSCL_TRY(resolve_crop(s, f));
    if ((s->max_pixels && gscl_frame_pixels(f) > s->max_pixels) || (s->max_work && header->splat_count > s->max_work))
        return GSCL_ERROR_LIMIT;
    return GSCL_OK;
}

gscl_kernel_options gscl_frame_options(const gsf_header *header, const gscl_frame *f) {
    gscl_kernel_options options = gscl_coded_image_options(header);
    if (!(options.shape == GSCL_SHAPE_ISOTROPIC && f->scale_x == f->scale_y) && (f->scale_x != 1 || f->scale_y != 1))
        options.shape = GSCL_SHAPE_ROTATED;                                /* scaling turns the axes */
    options.opacity = options.opacity || f->scale_x < 1 || f->scale_y < 1; /* those of reduced splats differ */
    return options;
}

/* Length of the part of [centre - half, centre + half] that lies inside [first, first + length]. */
static gscl_real overlap(gscl_real centre, gscl_real half, uint32_t first, uint32_t length) {
    const gscl_real begin = (gscl_real)first, end = (gscl_real)(first + length);
    return gscl_real_max(0, gscl_real_min(centre + half, end) - gscl_real_max(centre - half, begin));
}

/* Area of the rectangle around a splat's outline inside the frame; the kernel `project` computes the same half
 * sizes. */
static gscl_real outline_area(const float *p, const gscl_frame *f) {
    const gscl_half_size half = gscl_ellipse_half_size(p[GSCL_LOG_S1], p[GSCL_LOG_S2], p[GSCL_THETA], 0,
                                                       gscl_real_sqrt(2 * (gscl_real)GSCL_SUPPORT));
    return overlap(p[GSCL_X], half.width, f->x, f->width) * overlap(p[GSCL_Y], half.height, f->y, f->height);
}

void gscl_frame_splat(const gsf_coded_image *coded, uint32_t i, const gscl_frame *f, float *params) {
    gscl_dequantise_splat(coded, i, params);
    gscl_resize_splats(params, 1, f->scale_x, f->scale_y);
}

uint64_t gscl_frame_work(const gsf_coded_image *coded, const gscl_frame *f) {
    uint64_t work = 0;
    for (uint32_t i = 0; i < coded->header.splat_count; i++) {
        float params[GSCL_PARAMS];
        gscl_frame_splat(coded, i, f, params);
        work += (uint32_t)gscl_real_max(1, gscl_real_ceil(outline_area(params, f))); /* at most 2^28 */
    }
    return work;
}

uint64_t gscl_frame_excess_work(const gscl_decode_settings *s, const gsf_coded_image *coded, const gscl_frame *f) {
    const uint64_t bound = coded->header.splat_count * gscl_frame_pixels(f); /* at most 2^48 */
    if (s->max_work == 0 || bound <= s->max_work)
        return 0;
    const uint64_t work = gscl_frame_work(coded, f);
    return work > s->max_work ? work : 0;
}
