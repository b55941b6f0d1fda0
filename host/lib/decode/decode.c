#include "decode/decode.h"

#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/coded_image.h"
#include "decode/dequantise.h"
#include "decode/draw_device.h"
#include "decode/draw_progress.h"
#include "decode/format_result.h"
#include "decode/frame_message.h"
#include "decode/output.h"
#include "decode/tunables.h"
#include "host/system/clock.h"
#include "image/image.h"
#include "runtime/allocate.h"
#include "runtime/stage_clock.h"
#include "runtime/struct_size.h"
#include "software/canvas.h"
#include "software/software.h"

/* Takes the caller's pixels when they fit, or allocates some. */
static gscl_result provide_pixels(gscl_context *context, gscl_image *shape, const gscl_image *caller,
                                  void **allocated) {
    if (!caller->pixels) {
        shape->pixels = *allocated = gscl_allocate(shape->height, gscl_image_row_size(shape));
        return shape->pixels ? GSCL_OK : gscl_fail_memory(context);
    }
    if (caller->width != shape->width || caller->height != shape->height || caller->channels != shape->channels ||
        caller->sample != shape->sample)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "the caller's image is %ux%u with %u channels, the decode gives %ux%u with %u", caller->width,
                         caller->height, caller->channels, shape->width, shape->height, shape->channels);
    shape->stride = caller->stride;
    if (!gscl_image_rows_fit(shape))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the stride of %td bytes is shorter than a row of %zu",
                         caller->stride, gscl_image_row_size(shape));
    shape->pixels = caller->pixels;
    return GSCL_OK;
}

/* Adds all splats, one by one, so that no memory holds the parameters of all; adds up their colours in `sums`. */
static void add_splats(const gscl_coded_image *coded, const gscl_frame *f, gscl_software *software, gscl_real sums[4]) {
    const gsf_header *header = &coded->file.header;
    for (uint32_t i = 0; i < header->splat_count; i++) {
        float params[GSCL_PARAMS];
        gscl_frame_splat(&coded->file, i, f, params);
        gscl_software_add(software, params);
        for (unsigned k = 0; k < gsf_channel_count(header); k++)
            sums[k] += params[GSCL_COLOUR + k];
    }
}

/* Draws the splats that were added.  `scratch`: room for GSCL_BLOCK_ROWS drawn rows of a mixed output, else NULL. */
static gscl_result draw_rows(gscl_context *context, gscl_software *software, const float background[4],
                             const gscl_frame *f, const gscl_output *o, void *scratch,
                             const gscl_draw_progress *progress) {
    for (uint32_t y = 0; y < f->height;) {
        const gscl_image rows = gscl_image_rows(&o->image, y, gscl_software_rows(software, y, f->height));
        const gscl_image target = gscl_output_target(o, &rows, scratch);
        gscl_software_draw_rows(software, background, y, &target);
        gscl_output_finish(o, &target, &rows);
        y += rows.height;
        GSCL_TRY(gscl_draw_progress_report(context, progress, f, y));
    }
    return GSCL_OK;
}

static gscl_result draw_in_software(gscl_context *context, const gscl_coded_image *coded, const gscl_frame *f,
                                    const gscl_output *o, const gscl_draw_progress *progress) {
    const gscl_kernel_options options = gscl_frame_options(&coded->file.header, f);
    const gscl_software_view view = {f->full_width, f->full_height, f->x, f->y};
    gscl_real sums[4] = {0};
    float background[4];
    gscl_stage(context, GSCL_STAGE_DEQUANTISE);
    gscl_software *software = gscl_software_create(&options, &view, coded->file.header.splat_count);
    void *scratch = o->is_mixed ? gscl_allocate(GSCL_BLOCK_ROWS, gscl_image_row_size(&o->drawn)) : NULL;
    gscl_result result = GSCL_OK;
    if (!software || (o->is_mixed && !scratch)) {
        result = gscl_fail_memory(context);
    } else {
        add_splats(coded, f, software, sums);
        gscl_dequantise_background(&coded->file, sums, background);
        gscl_stage(context, GSCL_STAGE_DRAW);
        result = draw_rows(context, software, background, f, o, scratch, progress);
    }
    free(scratch);
    gscl_software_free(software);
    return result;
}

/* Reads the file, checking each limit as soon as its figure is known: the header before anything is allocated, the work
 * before pixels and memory of the device are. */
static gscl_result read_within_limits(gscl_context *context, const uint8_t *bytes, size_t size,
                                      const gscl_decode_settings *s, gscl_coded_image *coded, gscl_frame *f) {
    gsf_header header;
    gscl_result result = gscl_result_of_format(gsf_read_header(bytes, size, s->bare, &header));
    if (result != GSCL_OK) {
        gscl_coded_image_fail(context, result, bytes, size);
        return result;
    }
    GSCL_TRY(gscl_frame_resolve_for(context, s, &header, f));
    gscl_stage(context, GSCL_STAGE_ENTROPY_DECODING);
    uint32_t total;
    result = s->partial ? gscl_coded_image_read_prefix(coded, bytes, size, s->bare, &total)
                        : gscl_coded_image_read(coded, bytes, size, s->bare);
    if (result != GSCL_OK)
        gscl_coded_image_fail(context, result, bytes, size);
    else if ((result = gscl_frame_check_work(context, s, &coded->file, f)) != GSCL_OK)
        gscl_coded_image_free(coded);
    if (result != GSCL_OK)
        gscl_stage(context, GSCL_STAGE_NONE);
    return result;
}

static gscl_result draw(gscl_context *context, const gscl_coded_image *coded, const gscl_frame *f, const gscl_output *o,
                        const gscl_draw_progress *progress) {
    const bool in_software =
        !context->backend || (context->is_host && gscl_frame_pixels(f) <= gscl_decode_tunables.software_pixels);
    GSCL_TRY(gscl_draw_progress_report(context, progress, f, 0));
    return in_software ? draw_in_software(context, coded, f, o, progress)
                       : gscl_draw_on_device(context, coded, f, o, progress);
}

gscl_result gscl_decode_within(gscl_context *context, const uint8_t *bytes, size_t size,
                               const gscl_decode_settings *settings, gscl_image *image) {
    if (!bytes || !image)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "there are no bytes, or no image to decode them into");
    GSCL_TRY(gscl_require_open(context));
    const double start_s = gscl_now();
    gscl_decode_settings s;
    gscl_decode_settings_default(&s);
    GSCL_TRY(GSCL_STRUCT_READ(context, gscl_decode_settings, max_pixels, settings, &s));
    GSCL_TRY(gscl_output_check(context, &s));
    gscl_coded_image coded;
    gscl_frame f;
    GSCL_TRY(read_within_limits(context, bytes, size, &s, &coded, &f));
    gscl_output output = gscl_output_of(&f, &s, &coded.file.header);
    void *allocated = NULL;
    gscl_result result = provide_pixels(context, &output.image, image, &allocated);
    if (result == GSCL_OK) {
        const gscl_draw_progress progress = gscl_draw_progress_begin(&s, &coded, start_s);
        result = draw(context, &coded, &f, &output, &progress);
    }
    if (result == GSCL_OK)
        *image = output.image;
    else
        free(allocated);
    gscl_coded_image_free(&coded);
    gscl_stage(context, GSCL_STAGE_NONE);
    return result;
}

gscl_result gscl_decode(gscl_context *context, const uint8_t *bytes, size_t size, const gscl_decode_settings *settings,
                        gscl_image *image) {
    if (!context)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_call_begin(context, "gscl_decode");
    return gscl_call_end(context, gscl_decode_within(context, bytes, size, settings, image));
}
