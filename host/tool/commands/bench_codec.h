/* The part of 'gscl bench' that times the stages of encodes and decodes of one image. */
#ifndef GSCL_TOOL_BENCH_CODEC_H
#define GSCL_TOOL_BENCH_CODEC_H

#include <gscl/gscl.h>

#include "cli/json.h"

typedef struct bench_codec {
    gscl_context *context; /* with timing */
    const gscl_image *image;
    unsigned encodes, decodes; /* runs of each that are measured */
    int effort;
    gscl_tune tune;
    json_writer *json; /* NULL: a table on standard output */
} bench_codec;

/* Measures all rates and reports each of them. */
gscl_result bench_codec_run(const bench_codec *codec);

#endif
