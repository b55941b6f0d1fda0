/* The whole decoder, and the order of its checks. */
#include <stdlib.h>
#include <string.h>

#include "parts.h"

/* "Errors", from the checksum on. */
static oracle_result result_of(const oracle_payload *payload, bool checksum_matches) {
    const oracle_decoder *decoder = &payload->decoder;
    if (!checksum_matches)
        return oracle_decoder_overrun(decoder) ? ORACLE_TRUNCATED : ORACLE_DAMAGED;
    if (oracle_decoder_failed(decoder) || decoder->consumed != decoder->size + 3 || !oracle_within_limits(payload))
        return ORACLE_CORRUPT;
    return ORACLE_OK;
}

static oracle_result read_with(oracle_payload *payload, const uint8_t *bytes, size_t size, oracle_image *image) {
    uint32_t checksum;
    const oracle_result result = oracle_read_header(bytes, size, &payload->header, &checksum);
    if (result != ORACLE_OK)
        return result;
    const size_t start = payload->header.bytes;
    oracle_decoder_start(&payload->decoder, bytes + start, size - start);
    if (!oracle_read_payload(payload))
        return ORACLE_OUT_OF_MEMORY;
    const oracle_result checked = result_of(payload, checksum == oracle_checksum(bytes, size, start));
    if (checked != ORACLE_OK)
        return checked;

    image->header = payload->header;
    image->samples = (payload->header.layout >= 2 ? 3 : 1) + (payload->header.layout & 1);
    image->splats = calloc(payload->header.splats + (size_t)1, sizeof *image->splats);
    if (!image->splats)
        return ORACLE_OUT_OF_MEMORY;
    oracle_dequantise(payload, image->splats, image->background);
    return ORACLE_OK;
}

oracle_result oracle_read(const uint8_t *bytes, size_t size, oracle_image *image) {
    memset(image, 0, sizeof *image);
    oracle_payload *payload = calloc(1, sizeof *payload);
    if (!payload)
        return ORACLE_OUT_OF_MEMORY;
    const oracle_result result = read_with(payload, bytes, size, image);
    free(payload->splats);
    free(payload);
    return result;
}

static bool draw_image(oracle_image *image) {
    const size_t pixels = (size_t)image->header.width * image->header.height;
    double *values = calloc(pixels * image->header.channels, sizeof *values);
    double *weights = calloc(pixels, sizeof *weights);
    image->pixels = calloc(pixels * image->samples, sizeof *image->pixels);
    const bool done = values && weights && image->pixels;
    if (done) {
        oracle_draw(image, values, weights);
        oracle_output(image, values, image->pixels);
    }
    free(values);
    free(weights);
    return done;
}

oracle_result oracle_decode(const uint8_t *bytes, size_t size, oracle_image *image) {
    const oracle_result result = oracle_read(bytes, size, image);
    if (result == ORACLE_OK && !draw_image(image))
        return ORACLE_OUT_OF_MEMORY;
    return result;
}

void oracle_free(oracle_image *image) {
    free(image->splats);
    free(image->pixels);
    image->splats = NULL;
    image->pixels = NULL;
}
