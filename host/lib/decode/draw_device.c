#include "decode/draw_device.h"

#include <math.h>
#include <stdlib.h>

#include "cl/constants.h"
#include "decode/renderer.h"
#include "decode/resize.h"
#include "decode/tunables.h"
#include "image/image.h"
#include "runtime/allocate.h"
#include "runtime/queue.h"
#include "runtime/stage_clock.h"

/* Rows of a band: whole rows of tiles, as many as its bytes and, where there is a callback, its work allow. */
static uint32_t rows_of_band(const gscl_coded_image *coded, const gscl_frame *f, const gscl_output *o,
                             const gscl_draw_progress *progress) {
    const struct gscl_decode_tunables *t = &gscl_decode_tunables;
    double rows = (double)t->band_bytes / (double)gscl_image_row_size(&o->drawn);
    if (progress->callback)
        rows = fmin(rows, t->band_work * f->height / ((double)gscl_frame_work(&coded->file, f) + 1));
    rows = rows < GSCL_TILE ? GSCL_TILE : floor(rows / GSCL_TILE) * GSCL_TILE;
    return rows < f->height ? (uint32_t)rows : f->height;
}

static gscl_result draw_band(gscl_renderer *r, const gscl_frame *f, const gscl_output *o, uint32_t y,
                             const gscl_image *band, void *scratch) {
    const gscl_image target = gscl_output_target(o, band, scratch);
    const gscl_sample_layout layout = {(int32_t)target.channels, (int32_t)target.sample, target.premultiplied};
    GSCL_TRY(gscl_renderer_set_view(r, 0, f->x, f->y + y, f->width, band->height));
    GSCL_TRY(gscl_renderer_samples(r, layout, target.pixels, (size_t)gscl_image_stride(&target)));
    gscl_output_finish(o, &target, band);
    return GSCL_OK;
}

/* Draws the frame band by band, so that no buffer grows with the image.  `scratch`: room for drawn rows of a band,
 * where they do not come to lie in the image. */
static gscl_result draw_bands(gscl_renderer *r, const gscl_frame *f, const gscl_output *o, uint32_t rows, void *scratch,
                              const gscl_draw_progress *progress) {
    for (uint32_t y = 0; y < f->height; y += rows) {
        const gscl_image band = gscl_image_rows(&o->image, y, f->height - y < rows ? f->height - y : rows);
        GSCL_TRY(draw_band(r, f, o, y, &band, scratch));
        GSCL_TRY(gscl_draw_progress_report(r->context, progress, f, y + band.height));
    }
    return GSCL_OK;
}

/* Devices copy rows only in the order of their addresses. */
static gscl_result draw_output(gscl_renderer *r, const gscl_coded_image *coded, const gscl_frame *f,
                               const gscl_output *o, const gscl_draw_progress *progress) {
    const uint32_t rows = rows_of_band(coded, f, o, progress);
    const bool needs_scratch = o->is_mixed || o->image.stride < 0;
    void *scratch = needs_scratch ? gscl_allocate(rows, gscl_image_row_size(&o->drawn)) : NULL;
    if (needs_scratch && !scratch)
        return gscl_fail_memory(r->context);
    const gscl_result result = draw_bands(r, f, o, rows, scratch, progress);
    free(scratch);
    return result;
}

static void free_renderer(void *renderer) {
    gscl_renderer_free(renderer);
    free(renderer);
}

/* The renderer that the context keeps from one decode to the next: creating its buffers takes as long as drawing. */
static gscl_result reuse_renderer(gscl_context *context, const gscl_kernel_options *options, gscl_renderer **renderer) {
    gscl_renderer *r = context->decoder;
    if (!r) {
        r = calloc(1, sizeof *r);
        if (!r)
            return gscl_fail_memory(context);
        gscl_result result = gscl_renderer_create(r, context, options);
        if (result != GSCL_OK) {
            free_renderer(r);
            return result;
        }
        context->decoder = r;
        context->decoder_free = free_renderer;
    }
    r->row_capacity = 0; /* the capacity of another image may be too large for this number of rows */
    gscl_renderer_set_options(r, options);
    *renderer = r;
    return GSCL_OK;
}

/* `params` and `background`: room for the data that are copied to the device. */
static gscl_result draw_splats(gscl_context *context, const gscl_coded_image *coded, const gscl_frame *f,
                               const gscl_output *o, const gscl_draw_progress *progress, float *params,
                               float *background) {
    const gsf_header *header = &coded->file.header;
    gscl_renderer *renderer = NULL;
    const gscl_kernel_options options = gscl_frame_options(header, f);
    gscl_stage(context, GSCL_STAGE_DEQUANTISE);
    gscl_coded_image_params(coded, params, background);
    gscl_resize_splats(params, header->splat_count, f->scale_x, f->scale_y);
    gscl_stage(context, GSCL_STAGE_DRAW);
    GSCL_TRY(reuse_renderer(context, &options, &renderer));
    GSCL_TRY(gscl_renderer_set_splats_async(renderer, params, header->splat_count, background));
    return draw_output(renderer, coded, f, o, progress);
}

gscl_result gscl_draw_on_device(gscl_context *context, const gscl_coded_image *coded, const gscl_frame *f,
                                const gscl_output *o, const gscl_draw_progress *progress) {
    const size_t count = (size_t)coded->file.header.splat_count * GSCL_PARAMS;
    float *params = malloc((count + 4) * sizeof *params), *background = params ? params + count : NULL;
    if (!params)
        return gscl_fail_memory(context);
    gscl_result result = draw_splats(context, coded, f, o, progress, params, background);
    gscl_release_after_copies(context, params); /* after an error the device may still read them */
    return result;
}
