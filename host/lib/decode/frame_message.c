#include "decode/frame_message.h"

#include <inttypes.h>

#include "runtime/context.h"

static gscl_result fail_arguments(gscl_context *context, const gscl_decode_settings *s, const gscl_frame *f) {
    if ((s->width == 0) != (s->height == 0))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "both width and height must be given, or neither");
    return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "crop %u,%u,%u,%u does not lie inside %ux%u", s->crop_x,
                     s->crop_y, s->crop_width, s->crop_height, f->full_width, f->full_height);
}

gscl_result gscl_output_check(gscl_context *context, const gscl_decode_settings *s) {
    if (gscl_output_is_possible(s))
        return GSCL_OK;
    if ((unsigned)s->sample > GSCL_SAMPLE_F32)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "unknown sample type %d", (int)s->sample);
    if ((unsigned)s->layout > GSCL_LAYOUT_BGRA)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "unknown layout %d; there are 0 to %d", (int)s->layout,
                         (int)GSCL_LAYOUT_BGRA);
    return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the background %g, %g, %g is no colour of 0..1",
                     (double)s->background[0], (double)s->background[1], (double)s->background[2]);
}

static gscl_result fail_limit(gscl_context *context, const gscl_decode_settings *s, const gsf_header *header,
                              const gscl_frame *f) {
    const uint64_t pixels = gscl_frame_pixels(f);
    if (s->max_pixels && pixels > s->max_pixels)
        return gscl_fail(context, GSCL_ERROR_LIMIT,
                         "the decoded image has %" PRIu64 " pixels (%ux%u); max_pixels is %" PRIu64, pixels, f->width,
                         f->height, s->max_pixels);
    return gscl_fail(context, GSCL_ERROR_LIMIT,
                     "the file has %" PRIu32 " splats of at least one evaluation each; max_work is %" PRIu64,
                     header->splat_count, s->max_work);
}

gscl_result gscl_frame_resolve_for(gscl_context *context, const gscl_decode_settings *s, const gsf_header *header,
                                   gscl_frame *f) {
    const gscl_result result = gscl_frame_resolve(s, header, f);
    if (result == GSCL_ERROR_INVALID_ARGUMENT)
        return fail_arguments(context, s, f);
    if (result == GSCL_ERROR_LIMIT)
        return fail_limit(context, s, header, f);
    if (result == GSCL_ERROR_IMAGE_SIZE)
        return gscl_fail(context, GSCL_ERROR_IMAGE_SIZE, "cannot draw %ux%u pixels; at most %dx%d", f->full_width,
                         f->full_height, GSCL_MAX_DIMENSION, GSCL_MAX_DIMENSION);
    return result;
}

gscl_result gscl_frame_check_work(gscl_context *context, const gscl_decode_settings *s, const gsf_coded_image *coded,
                                  const gscl_frame *f) {
    const uint64_t work = gscl_frame_excess_work(s, coded, f);
    if (work == 0)
        return GSCL_OK;
    return gscl_fail(context, GSCL_ERROR_LIMIT, "drawing the image takes %" PRIu64 " evaluations; max_work is %" PRIu64,
                     work, s->max_work);
}
