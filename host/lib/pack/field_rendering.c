#include "pack/field_rendering.h"

#include <stdlib.h>

#include "decode/renderer.h"
#include "image/image.h"
#include "runtime/allocate.h"
#include "runtime/stage_clock.h"

#define BAND_SAMPLES (1u << 22) /* drawn at once, so that buffers of the device do not grow with the image */

static uint32_t rows_of_band(const gscl_image *image) {
    const uint32_t rows = BAND_SAMPLES / (image->width * image->channels) / GSCL_TILE * GSCL_TILE;
    return rows > GSCL_TILE ? rows : GSCL_TILE;
}

static gscl_result draw_bands(gscl_renderer *r, const gscl_image *image) {
    const gscl_sample_layout layout = {(int32_t)image->channels, (int32_t)image->sample, 1};
    const uint32_t rows = rows_of_band(image);
    for (uint32_t y = 0; y < image->height; y += rows) {
        const gscl_image band = gscl_image_rows(image, y, image->height - y < rows ? image->height - y : rows);
        GSCL_TRY(gscl_renderer_set_view(r, 0, 0, y, band.width, band.height));
        GSCL_TRY(gscl_renderer_samples(r, layout, band.pixels, gscl_image_row_size(&band)));
    }
    return GSCL_OK;
}

static gscl_result draw(const gscl_packing *p, const gscl_splat_list *splats, const gscl_image *image) {
    gscl_renderer renderer;
    const gscl_kernel_options options = gscl_coded_image_options(&p->header);
    gscl_result result = gscl_renderer_create(&renderer, p->context, &options);
    if (result == GSCL_OK)
        result = gscl_renderer_set_splats(&renderer, splats->params, splats->count, p->background);
    if (result == GSCL_OK)
        result = draw_bands(&renderer, image);
    gscl_renderer_free(&renderer);
    return result;
}

gscl_result gscl_pack_render(const gscl_packing *p, const gscl_splat_list *splats, gscl_image *image) {
    *image = (gscl_image){.width = p->header.width,
                          .height = p->header.height,
                          .channels = p->field->channels,
                          .sample = GSCL_SAMPLE_F32,
                          .premultiplied = true};
    image->pixels = gscl_allocate(image->height, gscl_image_row_size(image));
    if (!image->pixels)
        return gscl_fail_memory(p->context);
    gscl_stage(p->context, GSCL_STAGE_DRAW);
    const gscl_result result = draw(p, splats, image);
    if (result == GSCL_OK)
        return GSCL_OK;
    free(image->pixels);
    *image = (gscl_image){0};
    return result;
}
