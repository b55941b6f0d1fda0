/* Costs and gains of the effects of a file, which is written again without each of them. */
#include <gscl/measure.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/coded_image.h"
#include "decode/coded_size.h"
#include "decode/quantise.h"
#include "decode/ycocg.h"
#include "session/encoder.h"

/* The header without an effect and without the effects that depend on it. */
static gsf_header header_without(gsf_header h, gscl_effect effect) {
    switch (effect) {
    case GSCL_EFFECT_CHROMA:
        h.has_chroma = false;
        break;
    case GSCL_EFFECT_ALPHA_CHANNEL:
        h.has_alpha = false;
        break;
    case GSCL_EFFECT_OPACITY:
        h.has_opacity = false;
        break;
    case GSCL_EFFECT_ROTATION:
        h.has_rotation = false;
        break;
    case GSCL_EFFECT_ANISOTROPY:
        h.has_rotation = h.has_anisotropy = false;
        break;
    case GSCL_EFFECT_TEXTURE:
        h.has_texture = false;
        break;
    case GSCL_EFFECT_CODEBOOKS:
        break;
    }
    return h;
}

/* Converts a colour (channels, then alpha) from the channels of one header to those of another. */
static void drop_channels(const gsf_header *from, const gsf_header *to, float colour[4]) {
    float alpha = colour[from->has_chroma ? 3 : 1];
    if (from->has_chroma && !to->has_chroma) {
        colour[0] = (float)gscl_ycocg_from_rgb(colour).y;
        colour[1] = alpha;
    }
}

/* Writes the same splats without an effect, as a bare picture. */
static gscl_result write_without(const gscl_coded_image *coded, gscl_effect effect, uint8_t **bytes, size_t *size) {
    const gsf_coded_image *file = &coded->file;
    gscl_coded_image other = {.file = {.header = header_without(file->header, effect),
                                       .steps = file->steps,
                                       .bare = true,
                                       .has_mean_background = file->has_mean_background}};
    float background[4] = {0}, *params = malloc(((size_t)file->header.splat_count + 1) * GSCL_PARAMS * sizeof *params);
    gscl_result result = params ? gscl_coded_image_reserve(&other, file->header.splat_count) : GSCL_ERROR_OUT_OF_MEMORY;
    if (result == GSCL_OK) {
        if (!other.file.header.has_rotation)
            other.file.steps.angle = 0;
        gscl_coded_image_params(coded, params, background);
        drop_channels(&file->header, &other.file.header, background);
        for (unsigned k = 0; k < gsf_channel_count(&other.file.header); k++)
            other.file.background[k] = gscl_quantise_background(&other.file.header, background[k]);
        for (uint32_t i = 0; i < file->header.splat_count; i++) {
            float *p = params + (size_t)i * GSCL_PARAMS;
            drop_channels(&file->header, &other.file.header, p + GSCL_COLOUR);
            gscl_quantise(&other.file, p, &other.file.splats[i]);
        }
        result = gscl_coded_image_write(&other, bytes, size);
    }
    free(params);
    gscl_coded_image_free(&other);
    return result;
}

static gscl_result measure_effect(gscl_context *context, const gscl_coded_image *coded, size_t size,
                                  const gscl_image *image, double psnr, gscl_effect_use *use) {
    uint8_t *bytes;
    size_t smaller;
    double without;
    use->bits = use->gain_db = NAN;
    if (coded->file.header.coding == GSF_CODING_CODEBOOK)
        return GSCL_OK;
    GSCL_TRY(write_without(coded, use->effect, &bytes, &smaller));
    use->bits = 8.0 * ((double)size - (double)smaller);
    gscl_result result =
        image ? gscl_file_quality(context, bytes, smaller, true, image, GSCL_TARGET_PSNR, &without) : GSCL_OK;
    if (image && result == GSCL_OK)
        use->gain_db = psnr - without;
    free(bytes);
    return result;
}

/* Size of the picture of a coded image. */
static gscl_result picture_size(gscl_coded_image *coded, size_t *size) {
    coded->file.bare = true;
    return gscl_coded_image_size(coded, size);
}

gscl_result gscl_inspect_effects(gscl_context *context, const uint8_t *bytes, size_t size,
                                 const gscl_read_settings *settings, const gscl_image *image, gscl_effect_use *uses,
                                 size_t *count) {
    gscl_info info = {.struct_size = sizeof info};
    gscl_coded_image coded = {.capacity = 0};
    double psnr = NAN;
    size_t picture = 0;
    gscl_forget_message(context);
    if (!bytes || !uses || !count || (image && !context))
        return gscl_complete_message(context, GSCL_ERROR_INVALID_ARGUMENT);
    if (image)
        GSCL_TRY(gscl_require_encoder(context, "measuring effects"));
    gscl_result result = gscl_probe(bytes, size, settings, &info);
    const bool bare = settings && settings->bare;
    if (result == GSCL_OK)
        result = gscl_coded_image_read(&coded, bytes, size, bare);
    if (result == GSCL_OK)
        result = picture_size(&coded, &picture);
    if (result == GSCL_OK && image)
        result = gscl_file_quality(context, bytes, size, bare, image, GSCL_TARGET_PSNR, &psnr);
    size_t used = 0;
    for (unsigned bit = 0; bit < GSCL_EFFECT_COUNT && result == GSCL_OK; bit++)
        if (info.effects >> bit & 1) {
            uses[used].effect = (gscl_effect)(1u << bit);
            result = measure_effect(context, &coded, picture, image, psnr, &uses[used++]);
        }
    if (result == GSCL_OK)
        *count = used;
    gscl_coded_image_free(&coded);
    return gscl_complete_message(context, result);
}
