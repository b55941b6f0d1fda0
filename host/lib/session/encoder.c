#include "session/encoder.h"

#include <stdlib.h>

#include "decode/coded_size.h"
#include "decode/decode.h"
#include "image/metrics.h"
#include "runtime/timing.h"
#include "session/tunables.h"

gscl_result gscl_source_create(gscl_source *s, gscl_context *context, const gscl_image *image,
                               const gsf_header *header) {
    const unsigned channels = gsf_channel_count(header);
    *s = (gscl_source){.image_width = image->width, .image_height = image->height};
    while (((uint64_t)image->width * image->height >> (2 * s->first_level)) > gscl_session_tunables.max_fit_pixels)
        s->first_level++;
    s->width = gscl_level_size(image->width, s->first_level);
    s->height = gscl_level_size(image->height, s->first_level);
    s->pixels = (size_t)s->width * s->height;
    s->planes = malloc(s->pixels * channels * sizeof(float));
    if (!s->planes)
        return gscl_fail(context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory for an image of %ux%u", image->width,
                         image->height);
    gscl_image_to_planes(image, header->has_chroma ? 3 : 1, header->has_alpha, s->first_level, s->planes);
    return gscl_find_flat_background(s->planes, s->width, s->height, (int)channels, &s->background)
               ? GSCL_OK
               : gscl_fail_memory(context);
}

void gscl_source_free(gscl_source *s) {
    free(s->planes);
    s->planes = NULL;
}

void gscl_encoder_release_source(gscl_encoder *e) {
    if (!gscl_target_is_quality(e->settings.target) && !e->may_search_smooth)
        gscl_source_free(&e->source);
}

void gscl_encoder_restart(gscl_encoder *e) {
    e->random = e->settings.seed;
    e->coded.file.header = e->header;
    e->coded.packets = e->packets.count;
}

static gscl_result measure_quality(const gscl_image *image, const gscl_image *decoded, gscl_target measure,
                                   double *quality) {
    gscl_comparison comparison;
    if (measure == GSCL_TARGET_SSIMULACRA2)
        return gscl_compare_appearance(image, decoded, quality);
    GSCL_TRY(gscl_compare_samples(image, decoded, &comparison));
    *quality = comparison.psnr;
    return GSCL_OK;
}

gscl_result gscl_file_quality(gscl_context *context, const uint8_t *bytes, size_t size, bool bare,
                              const gscl_image *image, gscl_target measure, double *quality) {
    gscl_image decoded = {0};
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.sample = image->sample;
    settings.premultiplied = image->premultiplied;
    settings.bare = bare;
    GSCL_TRY(gscl_decode_within(context, bytes, size, &settings, &decoded));
    const gscl_result result = measure_quality(image, &decoded, measure, quality);
    gscl_free(decoded.pixels);
    return result == GSCL_ERROR_OUT_OF_MEMORY ? gscl_fail_memory(context) : result;
}

gscl_result gscl_coded_quality(gscl_context *context, gscl_coded_image *coded, const gscl_image *image,
                               gscl_target measure, double *quality) {
    uint8_t *bytes;
    size_t size;
    GSCL_TRY(gscl_coded_image_write(coded, &bytes, &size));
    gscl_result result = gscl_file_quality(context, bytes, size, true, image, measure, quality);
    free(bytes);
    return result;
}

gscl_result gscl_encoder_quality(gscl_encoder *e, const gscl_image *image, gscl_target measure, double *quality) {
    return gscl_coded_quality(e->context, &e->coded, image, measure, quality);
}

gscl_result gscl_file_size(gscl_context *context, gscl_coded_image *coded, size_t *size) {
    const gscl_stage_id before = gscl_stage(context, GSCL_STAGE_ENTROPY_CODING);
    const gscl_result result = gscl_coded_image_size(coded, size);
    gscl_stage(context, before);
    return result;
}
