#include <gscl/gscl.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "image/image.h"
#include "decode/coded_image.h"
#include "decode/renderer.h"
#include "decode/resize.h"
#include "runtime/timing.h"

#define BAND_SAMPLES (16u << 20) /* of a band: 64 MiB of floats */

void gscl_decode_settings_default(gscl_decode_settings *settings) {
    if (settings)
        *settings = (gscl_decode_settings){0};
}

/* What is drawn: the size of the whole drawn picture and the rectangle of it that is wanted. */
typedef struct frame {
    uint32_t full_width, full_height;
    uint32_t x, y, width, height;
} frame;

static gscl_result resolve_frame(gscl_context *context, const gscl_decode_settings *s, const gsf_header *header,
                                 frame *f) {
    if ((s->width == 0) != (s->height == 0))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "both width and height must be given, or neither");
    f->full_width = s->width ? s->width : header->width;
    f->full_height = s->height ? s->height : header->height;
    if (f->full_width > GSCL_MAX_DIMENSION || f->full_height > GSCL_MAX_DIMENSION)
        return gscl_fail(context, GSCL_ERROR_IMAGE_SIZE, "cannot draw %ux%u pixels; at most %dx%d", f->full_width,
                         f->full_height, GSCL_MAX_DIMENSION, GSCL_MAX_DIMENSION);
    bool crop = s->crop_width || s->crop_height || s->crop_x || s->crop_y;
    *f = (frame){f->full_width, f->full_height, s->crop_x, s->crop_y, s->crop_width, s->crop_height};
    if (!crop || f->width == 0)
        f->width = f->full_width > f->x ? f->full_width - f->x : 0;
    if (!crop || f->height == 0)
        f->height = f->full_height > f->y ? f->full_height - f->y : 0;
    if (f->width == 0 || f->height == 0 || f->x > f->full_width - f->width || f->y > f->full_height - f->height ||
        f->width > f->full_width || f->height > f->full_height)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "crop %u,%u,%u,%u does not lie inside %ux%u", s->crop_x,
                         s->crop_y, s->crop_width, s->crop_height, f->full_width, f->full_height);
    return GSCL_OK;
}

/* The image that the decode gives, without pixels. */
static gscl_image shape_of(const frame *f, const gsf_header *header, const gscl_decode_settings *s) {
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

/* Draws the frame band by band, so that no buffer grows with the picture. */
static gscl_result draw_bands(gscl_renderer *r, const frame *f, const gscl_image *image) {
    gscl_sample_layout layout = {(cl_int)image->channels, (cl_int)image->sample, image->premultiplied};
    uint32_t rows = (uint32_t)(BAND_SAMPLES / ((size_t)f->width * image->channels) / GSCL_TILE * GSCL_TILE);
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
    r->options = *options;
    r->channels = options->colours + options->alpha_channel;
    *renderer = r;
    return GSCL_OK;
}

/* `params` and `background`: room for what the device is given. */
static gscl_result draw_splats(gscl_context *context, const gscl_coded_image *picture, const frame *f,
                               const gscl_image *image, float *params, float background[4]) {
    const gsf_header *header = &picture->file.header;
    gscl_renderer *renderer = NULL;
    gscl_kernel_options options = gscl_coded_image_options(header);
    double scale_x = (double)f->full_width / header->width, scale_y = (double)f->full_height / header->height;
    gscl_stage(context, GSCL_STAGE_DEQUANTISE);
    gscl_coded_image_params(picture, params, background);
    gscl_resize_splats(params, header->splat_count, scale_x, scale_y);
    if (!(options.shape == GSCL_SHAPE_ISOTROPIC && scale_x == scale_y) && (scale_x != 1 || scale_y != 1))
        options.shape = GSCL_SHAPE_ROTATED; /* what scaling makes of them */
    gscl_stage(context, GSCL_STAGE_DRAW);
    GSCL_TRY(reuse_renderer(context, &options, &renderer));
    GSCL_TRY(gscl_renderer_set_splats_async(renderer, params, header->splat_count, background));
    return draw_bands(renderer, f, image);
}

static gscl_result draw(gscl_context *context, const gscl_coded_image *picture, const frame *f,
                        const gscl_image *image) {
    float background[4],
        *params = malloc(((size_t)picture->file.header.splat_count + 1) * GSCL_PARAMS * sizeof *params);
    if (!params)
        return gscl_fail_memory(context);
    gscl_result result = draw_splats(context, picture, f, image, params, background);
    gscl_finish(context); /* also after an error nobody reads them any more */
    free(params);
    return result;
}

gscl_result gscl_decode(gscl_context *context, const uint8_t *bytes, size_t size, const gscl_decode_settings *settings,
                        gscl_image *image) {
    if (!context || !bytes || !image)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_decode_settings defaults = {0};
    if (!settings)
        settings = &defaults;
    if (settings->sample > GSCL_SAMPLE_F32)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "unknown sample type %d", (int)settings->sample);
    context->message[0] = 0;
    gscl_coded_image picture;
    gscl_stage(context, GSCL_STAGE_ENTROPY_DECODING);
    gscl_result result = gscl_coded_image_read(&picture, bytes, size);
    if (result != GSCL_OK) {
        gscl_stage(context, GSCL_STAGE_NONE);
        return gscl_coded_image_fail(context, result, bytes, size);
    }
    frame f = {0};
    gscl_image decoded = {0};
    result = resolve_frame(context, settings, &picture.file.header, &f);
    if (result == GSCL_OK) {
        decoded = shape_of(&f, &picture.file.header, settings);
        result = provide_pixels(context, &decoded, image);
    }
    if (result == GSCL_OK)
        result = draw(context, &picture, &f, &decoded);
    if (result == GSCL_OK)
        *image = decoded;
    else if (!image->pixels)
        free(decoded.pixels);
    gscl_coded_image_free(&picture);
    gscl_stage(context, GSCL_STAGE_NONE);
    return result;
}
