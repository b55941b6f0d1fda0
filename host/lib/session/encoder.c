#include "session/encoder.h"

#include <stdlib.h>

#include "cl/constants.h"
#include "image/metrics.h"
#include "runtime/timing.h"

#define FIT_PIXELS (1u << 25) /* larger images are fitted at a smaller level; the splats draw at any size */

gscl_result gscl_encoder_make_planes(gscl_encoder *e) {
    const gsf_header *header = &e->coded.file.header;
    while (((uint64_t)e->image->width * e->image->height >> (2 * e->source.first_level)) > FIT_PIXELS)
        e->source.first_level++;
    uint32_t width = gscl_level_size(e->image->width, e->source.first_level);
    uint32_t height = gscl_level_size(e->image->height, e->source.first_level);
    e->source.pixels = (size_t)width * height;
    free(e->source.planes);
    e->source.planes = malloc(e->source.pixels * gsf_channel_count(header) * sizeof(float));
    if (!e->source.planes)
        return gscl_fail(e->context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory for an image of %ux%u", e->image->width,
                         e->image->height);
    gscl_image_to_planes(e->image, header->has_chroma ? 3 : 1, header->has_alpha, e->source.first_level,
                         e->source.planes);
    e->source.background = gscl_find_flat_background(e->source.planes, width, height, (int)gsf_channel_count(header));
    return GSCL_OK;
}

size_t gscl_max_splats(const gscl_encoder *e, size_t bytes) {
    size_t useful = (size_t)e->image->width * e->image->height / 2 + 8;
    return bytes == 0 || useful > GSCL_MAX_SPLATS ? GSCL_MAX_SPLATS : useful;
}

int gscl_loss_kind(gscl_loss loss) {
    return loss == GSCL_LOSS_L1        ? GSCL_LOSS_KIND_L1
           : loss == GSCL_LOSS_L1_SSIM ? GSCL_LOSS_KIND_EXTERNAL
                                       : GSCL_LOSS_KIND_L2;
}

gscl_result gscl_file_psnr(gscl_context *context, const uint8_t *bytes, size_t size, const gscl_image *image,
                           double *psnr) {
    gscl_image decoded = {0};
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.sample = image->sample;
    settings.premultiplied = image->premultiplied;
    gscl_comparison comparison;
    GSCL_TRY(gscl_decode(context, bytes, size, &settings, &decoded));
    gscl_result result = gscl_compare_samples(image, &decoded, &comparison);
    if (result == GSCL_OK)
        *psnr = comparison.psnr;
    gscl_free(decoded.pixels);
    return result;
}

gscl_result gscl_encoder_psnr(gscl_encoder *e, double *psnr) {
    uint8_t *bytes;
    size_t size;
    GSCL_TRY(gscl_coded_image_write(&e->coded, &bytes, &size));
    gscl_result result = gscl_file_psnr(e->context, bytes, size, e->image, psnr);
    free(bytes);
    return result;
}

gscl_result gscl_encoder_size(gscl_encoder *e, size_t *size) {
    gscl_stage_id before = gscl_stage(e->context, GSCL_STAGE_ENTROPY_CODING);
    gscl_result result = gscl_coded_image_size(&e->coded, size);
    gscl_stage(e->context, before);
    return result;
}
