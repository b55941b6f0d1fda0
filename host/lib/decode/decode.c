#include <gscl/gscl.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/coded_image.h"
#include "decode/frame.h"
#include "decode/renderer.h"
#include "decode/resize.h"
#include "decode/tunables.h"
#include "image/image.h"
#include "runtime/struct_size.h"
#include "runtime/timing.h"

void gscl_decode_settings_init(gscl_decode_settings *settings, size_t struct_size) {
    const gscl_decode_settings defaults = {0};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}

/* The image that the decode returns, without pixels. */
static gscl_image shape_of(const gscl_frame *f, const gsf_header *header, const gscl_decode_settings *s) {
    gscl_sample sample = s->sample != GSCL_SAMPLE_AUTO ? s->sample
                         : header->high_bit_depth      ? GSCL_SAMPLE_U16
                                                       : GSCL_SAMPLE_U8;
    return (gscl_image){.width = f->width,
                        .height = f->height,
                        .channels = gscl_coded_image_channels(header),
                        .sample = sample,
                        .premultiplied = s->premultiplied};
}

/* Takes the caller's pixels when they fit, or allocates. */
static gscl_result provide_pixels(gscl_context *context, gscl_image *shape, const gscl_image *caller) {
    if (!caller->pixels) {
        shape->stride = 0;
        shape->pixels = malloc(gscl_image_stride(shape) * shape->height);
        return shape->pixels ? GSCL_OK : gscl_fail_memory(context);
    }
    if (caller->width != shape->width || caller->height != shape->height || caller->channels != shape->channels ||
        caller->sample != shape->sample)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "the caller's image is %ux%u with %u channels, the decode gives %ux%u with %u", caller->width,
                         caller->height, caller->channels, shape->width, shape->height, shape->channels);
    size_t row = gscl_image_stride(shape);
    if (caller->stride && caller->stride < row)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the stride of %zu bytes is shorter than a row of %zu",
                         caller->stride, row);
    shape->stride = caller->stride;
    shape->pixels = caller->pixels;
    return GSCL_OK;
}

/* Draws the frame band by band, so that no buffer grows with the image. */
static gscl_result draw_bands(gscl_renderer *r, const gscl_frame *f, const gscl_image *image) {
    gscl_sample_layout layout = {(cl_int)image->channels, (cl_int)image->sample, image->premultiplied};
    const size_t row_samples = (size_t)f->width * image->channels;
    uint32_t rows = (uint32_t)((size_t)gscl_decode_tunables.band_samples / row_samples / GSCL_TILE * GSCL_TILE);
    if (rows < GSCL_TILE)
        rows = GSCL_TILE;
    for (uint32_t y = 0; y < f->height; y += rows) {
        uint32_t n = f->height - y < rows ? f->height - y : rows;
        size_t stride = gscl_image_stride(image);
        GSCL_TRY(gscl_renderer_set_view(r, 0, f->x, f->y + y, f->width, n));
        GSCL_TRY(gscl_renderer_samples(r, layout, (unsigned char *)image->pixels + y * stride, stride));
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
    gscl_renderer_set_options(r, GSCL_PROGRAM_RENDER, options);
    *renderer = r;
    return GSCL_OK;
}

/* `params` and `background`: room for the data that are copied to the device. */
static gscl_result draw_splats(gscl_context *context, const gscl_coded_image *coded, const gscl_frame *f,
                               const gscl_image *image, float *params, float background[4]) {
    const gsf_header *header = &coded->file.header;
    gscl_renderer *renderer = NULL;
    gscl_kernel_options options = gscl_coded_image_options(header);
    double scale_x = (double)f->full_width / header->width, scale_y = (double)f->full_height / header->height;
    gscl_stage(context, GSCL_STAGE_DEQUANTISE);
    gscl_coded_image_params(coded, params, background);
    gscl_resize_splats(params, header->splat_count, scale_x, scale_y);
    if (!(options.shape == GSCL_SHAPE_ISOTROPIC && scale_x == scale_y) && (scale_x != 1 || scale_y != 1))
        options.shape = GSCL_SHAPE_ROTATED; /* scaling turns the axes */
    gscl_stage(context, GSCL_STAGE_DRAW);
    GSCL_TRY(reuse_renderer(context, &options, &renderer));
    GSCL_TRY(gscl_renderer_set_splats_async(renderer, params, header->splat_count, background));
    return draw_bands(renderer, f, image);
}

static gscl_result decode_draw(gscl_context *context, const gscl_coded_image *coded, const gscl_frame *f,
                               const gscl_image *image) {
    float background[4], *params = malloc(((size_t)coded->file.header.splat_count + 1) * GSCL_PARAMS * sizeof *params);
    if (!params)
        return gscl_fail_memory(context);
    gscl_result result = draw_splats(context, coded, f, image, params, background);
    gscl_finish(context); /* after an error, too, the device may still read `params` */
    free(params);
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
    GSCL_TRY(gscl_frame_resolve(context, s, &header, f));
    gscl_stage(context, GSCL_STAGE_ENTROPY_DECODING);
    uint32_t total;
    result = s->partial ? gscl_coded_image_read_prefix(coded, bytes, size, s->bare, &total)
                        : gscl_coded_image_read(coded, bytes, size, s->bare);
    if (result != GSCL_OK)
        gscl_coded_image_fail(context, result, bytes, size);
    else if ((result = gscl_frame_check_work(context, s, coded, f)) != GSCL_OK)
        gscl_coded_image_free(coded);
    if (result != GSCL_OK)
        gscl_stage(context, GSCL_STAGE_NONE);
    return result;
}

gscl_result gscl_decode(gscl_context *context, const uint8_t *bytes, size_t size, const gscl_decode_settings *settings,
                        gscl_image *image) {
    if (!context || !bytes || !image)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_forget_message(context);
    gscl_decode_settings s;
    gscl_decode_settings_default(&s);
    GSCL_TRY(GSCL_STRUCT_READ(context, gscl_decode_settings, max_pixels, settings, &s));
    if ((unsigned)s.sample > GSCL_SAMPLE_F32)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "unknown sample type %d", (int)s.sample);
    gscl_coded_image coded;
    gscl_frame f;
    GSCL_TRY(read_within_limits(context, bytes, size, &s, &coded, &f));
    gscl_image decoded = shape_of(&f, &coded.file.header, &s);
    gscl_result result = provide_pixels(context, &decoded, image);
    if (result == GSCL_OK)
        result = decode_draw(context, &coded, &f, &decoded);
    if (result == GSCL_OK)
        *image = decoded;
    else if (!image->pixels)
        free(decoded.pixels);
    gscl_coded_image_free(&coded);
    gscl_stage(context, GSCL_STAGE_NONE);
    return gscl_complete_message(context, result);
}
