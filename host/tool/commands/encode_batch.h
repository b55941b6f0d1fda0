/* Encoding one image or many on one device. */
#ifndef GSCL_TOOL_ENCODE_BATCH_H
#define GSCL_TOOL_ENCODE_BATCH_H

#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"

typedef struct encode_batch {
    char *const *inputs;
    int count;
    const char *output;            /* of the only input; NULL: the input's name with .gscl, */
    const char *out_dir;           /* in this folder; NULL: beside the input */
    gscl_encode_settings settings; /* without the callback */
    device_choice choice;
    bool json, quiet;
} encode_batch;

/* Encodes all inputs; goes on after a bad one.  Returns the program's exit code. */
int encode_batch_run(const encode_batch *batch);

#endif
