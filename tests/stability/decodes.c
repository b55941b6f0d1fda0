#include "decodes.h"

#include <stdio.h>
#include <stdlib.h>

#include "oracle.h"

static bool image_is_close(const oracle_image *expected_image, const gscl_image *image, char *message,
                           size_t capacity) {
    const bool high_bit_depth = image->sample == GSCL_SAMPLE_U16;
    const uint32_t peak = high_bit_depth ? 65535 : 255;
    for (size_t i = 0; i < (size_t)image->width * image->height * image->channels; i++) {
        const int found = high_bit_depth ? ((const uint16_t *)image->pixels)[i] : ((const uint8_t *)image->pixels)[i];
        if (oracle_allows(expected_image, i, found, peak))
            continue;
        snprintf(message, capacity, "sample %zu of the decoded file is %d, %d to %d expected", i, found,
                 (int)oracle_round(expected_image->low[i], peak), (int)oracle_round(expected_image->high[i], peak));
        return false;
    }
    return true;
}

bool decodes_alike(gscl_context *const *contexts, int count, const uint8_t *bytes, size_t size, char *message,
                   size_t capacity) {
    oracle_image expected_image;
    bool good = oracle_decode(bytes, size, &expected_image);
    if (!good)
        snprintf(message, capacity, "the file cannot be read");
    for (int m = 0; m < count && good; m++) {
        gscl_image image = {0};
        good = gscl_decode(contexts[m], bytes, size, NULL, &image) == GSCL_OK;
        if (!good)
            snprintf(message, capacity, "%s", gscl_context_message(contexts[m]));
        good = good && image_is_close(&expected_image, &image, message, capacity);
        gscl_free(image.pixels);
    }
    oracle_free(&expected_image);
    return good;
}
