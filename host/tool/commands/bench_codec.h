/* The part of 'gscl bench' that encodes and decodes a picture, stage by stage. */
#ifndef GSCL_TOOL_BENCH_CODEC_H
#define GSCL_TOOL_BENCH_CODEC_H

#include <gscl/gscl.h>

#include "cli/json.h"

typedef struct bench_codec {
    gscl_context *context; /* with timing */
    const gscl_image *image;
    unsigned encodes, decodes; /* how often each is measured */
    json_writer *json;         /* NULL: a table on standard output */
} bench_codec;

gscl_result bench_codec_run(const bench_codec *codec);

#endif
