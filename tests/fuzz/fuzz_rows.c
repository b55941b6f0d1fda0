/* Decodes hostile files by rows in exactly the memory that gscl_rows_memory says, as whole files and as bare pictures.  The last
 * byte chooses the settings.  Decoding ends with a result; all rows come when it is GSCL_OK, and none before a file or a limit
 * fails; memory never does. */
#include <gscl/gscl.h>
#include <stdlib.h>

#include "coded_memory.h"
#include "mutator.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MAX_WORK 1000000u   /* keeps the time of an input short */
#define MAX_MEMORY 1000000u /* bytes */

typedef struct progress {
    uint32_t rows, sum;
} progress;

static bool receive(void *opaque, uint32_t y, const gscl_image *strip) {
    progress *p = opaque;
    fuzz_require(y == p->rows && strip->height > 0, "a strip does not follow the one before");
    const size_t bytes =
        (size_t)strip->width * strip->height * strip->channels * (strip->sample == GSCL_SAMPLE_U16 ? 2 : 1);
    for (size_t i = 0; i < bytes; i++) /* lets a sanitizer see what is not there */
        p->sum += ((const uint8_t *)strip->pixels)[i];
    p->rows += strip->height;
    return true;
}

static gscl_decode_settings settings_of(unsigned choice, bool bare) {
    gscl_decode_settings s;
    gscl_decode_settings_default(&s);
    s.bare = bare;
    s.partial = choice & 1;
    s.premultiplied = choice & 2;
    s.layout = (gscl_layout)(choice / 3 % (GSCL_LAYOUT_BGRA + 1));
    s.max_work = MAX_WORK;
    if (choice & 4) {
        s.width = 1 + choice;
        s.height = 1 + choice / 8;
    } else {
        s.crop_width = s.crop_height = 1; /* of pictures that are too large without it */
        s.crop_x = choice;
    }
    return s;
}

static void decode(const uint8_t *data, size_t size, unsigned choice, bool bare) {
    const gscl_decode_settings settings = settings_of(choice, bare);
    const uint32_t strip_rows = choice >> 3;
    progress p = {0, 0};
    gscl_image image;
    size_t needed;
    if (gscl_rows_memory(data, size, &settings, strip_rows, &image, &needed) != GSCL_OK || needed > MAX_MEMORY)
        return;
    void *memory = malloc(needed); /* of this size, so that a sanitizer sees what lies beyond it */
    fuzz_require(memory != NULL, "no memory");
    const gscl_result result = gscl_decode_rows(data, size, &settings, strip_rows, memory, needed, receive, &p);
    free(memory);
    fuzz_require(result != GSCL_ERROR_OUT_OF_MEMORY && result != GSCL_ERROR_CANCELLED, "an unexpected result");
    fuzz_require(p.rows == (result == GSCL_OK ? image.height : 0), "rows are missing");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size == 0)
        return 0;
    decode(data, size, data[size - 1], false);
    decode(data, size, data[size - 1], true);
    return 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    return fuzz_mutate_file(data, size, max_size, seed);
}
