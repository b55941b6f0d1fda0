#include "decode/draw_device.h"

#include <math.h>
#include <stdlib.h>

#include "cl/constants.h"
#include "decode/renderer.h"
#include "decode/resize.h"
#include "decode/tunables.h"
#include "image/image.h"
#include "runtime/queue.h"
#include "runtime/stage_clock.h"

/* Rows of a band: whole rows of tiles, as many as its samples and, where there is a callback, its work allow. */
static uint32_t rows_of_band(const gscl_coded_image *coded, const gscl_frame *f, const gscl_image *image,
                             const gscl_draw_progress *progress) {
    const struct gscl_decode_tunables *t = &gscl_decode_tunables;
    double rows = (double)t->band_samples / ((double)f->width * image->channels);
    if (progress->callback)
        rows = fmin(rows, t->band_work * f->height / ((double)gscl_frame_work(&coded->file, f) + 1));
    return rows < GSCL_TILE ? GSCL_TILE : (uint32_t)rows / GSCL_TILE * GSCL_TILE;
}

/* Draws the frame band by band, so that no buffer grows with the image. */
static gscl_result draw_bands(gscl_renderer *r, const gscl_coded_image *coded, const gscl_frame *f,
                              const gscl_image *image, const gscl_draw_progress *progress) {
    gscl_sample_layout layout = {(int32_t)image->channels, (int32_t)image->sample, image->premultiplied};
    const uint32_t rows = rows_of_band(coded, f, image, progress);
    for (uint32_t y = 0; y < f->height; y += rows) {
        uint32_t n = f->height - y < rows ? f->height - y : rows;
        size_t stride = gscl_image_stride(image);
        GSCL_TRY(gscl_renderer_set_view(r, 0, f->x, f->y + y, f->width, n));
        GSCL_TRY(gscl_renderer_samples(r, layout, (unsigned char *)image->pixels + y * stride, stride));
        GSCL_TRY(gscl_draw_progress_report(r->context, progress, f, y + n));
    }
    return GSCL_OK;
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
                               const gscl_image *image, const gscl_draw_progress *progress, float *params,
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
    return draw_bands(renderer, coded, f, image, progress);
}

gscl_result gscl_draw_on_device(gscl_context *context, const gscl_coded_image *coded, const gscl_frame *f,
                                const gscl_image *image, const gscl_draw_progress *progress) {
    const size_t count = (size_t)coded->file.header.splat_count * GSCL_PARAMS;
    float *params = malloc((count + 4) * sizeof *params), *background = params ? params + count : NULL;
    if (!params)
        return gscl_fail_memory(context);
    gscl_result result = draw_splats(context, coded, f, image, progress, params, background);
    gscl_release_after_copies(context, params); /* after an error the device may still read them */
    return result;
}
