/* Encoding one image or many, on one device or on all. */
#ifndef GSCL_TOOL_ENCODE_BATCH_H
#define GSCL_TOOL_ENCODE_BATCH_H

#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"
#include "image/image_content.h"

typedef struct encode_batch {
    char *const *inputs;
    int count;
    const char *output;            /* for a single input; NULL: the name of the input with .gscl or .b64 */
    const char *out_dir;           /* folder of those names; NULL: beside the input */
    gscl_encode_settings settings; /* without the progress callback */
    image_read_options reading;    /* what becomes of metadata; quiet and verbose are those of this struct */
    device_choice choice;
    bool json, quiet;
    bool base64; /* each file is written as a line of text; without `output` and `out_dir` on standard output */
} encode_batch;

/* Encodes all inputs, and continues after a failed one.  Returns the exit code of the program. */
int encode_batch_run(const encode_batch *batch);

#endif
