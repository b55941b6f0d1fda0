/* The whole decoder: what is checked, and in which order. */
#include <stdlib.h>
#include <string.h>

#include "parts.h"

/* "Errors", from the checksum on. */
static oracle_result judge(const oracle_payload *payload, bool checksum_right) {
    const oracle_decoder *decoder = &payload->decoder;
    if (!checksum_right)
        return oracle_decoder_overrun(decoder) ? ORACLE_TRUNCATED : ORACLE_DAMAGED;
    if (oracle_decoder_failed(decoder) || decoder->consumed != decoder->size + 3 || !oracle_within_limits(payload))
        return ORACLE_CORRUPT;
    return ORACLE_OK;
}

static oracle_result read_with(oracle_payload *payload, const uint8_t *bytes, size_t size, oracle_picture *picture) {
    uint32_t checksum;
    const oracle_result result = oracle_read_header(bytes, size, &payload->header, &checksum);
    if (result != ORACLE_OK)
        return result;
    const size_t start = payload->header.bytes;
    oracle_decoder_start(&payload->decoder, bytes + start, size - start);
    if (!oracle_read_payload(payload))
        return ORACLE_OUT_OF_MEMORY;
    const oracle_result verdict = judge(payload, checksum == oracle_checksum(bytes, size, start));
    if (verdict != ORACLE_OK)
        return verdict;

    picture->header = payload->header;
    picture->samples = (payload->header.layout >= 2 ? 3 : 1) + (payload->header.layout & 1);
    picture->splats = calloc(payload->header.splats + (size_t)1, sizeof *picture->splats);
    if (!picture->splats)
        return ORACLE_OUT_OF_MEMORY;
    oracle_dequantise(payload, picture->splats, picture->background);
    return ORACLE_OK;
}

oracle_result oracle_read(const uint8_t *bytes, size_t size, oracle_picture *picture) {
    memset(picture, 0, sizeof *picture);
    oracle_payload *payload = calloc(1, sizeof *payload);
    if (!payload)
        return ORACLE_OUT_OF_MEMORY;
    const oracle_result result = read_with(payload, bytes, size, picture);
    free(payload->splats);
    free(payload);
    return result;
}

static bool draw(oracle_picture *picture) {
    const size_t pixels = (size_t)picture->header.width * picture->header.height;
    double *values = calloc(pixels * picture->header.channels, sizeof *values);
    double *weights = calloc(pixels, sizeof *weights);
    picture->pixels = calloc(pixels * picture->samples, sizeof *picture->pixels);
    const bool done = values && weights && picture->pixels;
    if (done) {
        oracle_draw(picture, values, weights);
        oracle_output(picture, values, picture->pixels);
    }
    free(values);
    free(weights);
    return done;
}

oracle_result oracle_decode(const uint8_t *bytes, size_t size, oracle_picture *picture) {
    const oracle_result result = oracle_read(bytes, size, picture);
    if (result == ORACLE_OK && !draw(picture))
        return ORACLE_OUT_OF_MEMORY;
    return result;
}

void oracle_free(oracle_picture *picture) {
    free(picture->splats);
    free(picture->pixels);
    picture->splats = NULL;
    picture->pixels = NULL;
}
