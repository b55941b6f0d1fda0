/* What is to be encoded, and how: the command line of 'gscl encode'. */
#ifndef GSCL_TOOL_BATCH_SETTINGS_H
#define GSCL_TOOL_BATCH_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"
#include "cli/options.h"
#include "image/image_content.h"

typedef struct encode_batch {
    char *const *inputs; /* of the command line */
    int count;
    const char *files_from;        /* a list of further inputs; "-": standard input; NULL: none */
    bool null;                     /* a NUL ends each name of the list, not a line break */
    const char *output;            /* for a single input; NULL: the name of the input with .gscl or .b64 */
    const char *out_dir;           /* folder of those names, which is made; NULL: beside the input */
    bool keep_tree;                /* below out_dir with the folders of the input */
    bool skip_existing;            /* inputs whose output exists are left out */
    const char *jsonl;             /* the report of a run; NULL: none */
    option_share shard;            /* the share of the inputs to encode; {0, 0}: all */
    uint64_t jobs;                 /* images at a time on each device; 0: the default for the device */
    gscl_encode_settings settings; /* without the progress callback */
    image_read_options reading;    /* what becomes of metadata; quiet and verbose are those of this struct */
    device_choice choice;
    bool json, quiet;
    bool base64; /* each file is written as a line of text; without `output` and `out_dir` on standard output */
} encode_batch;

/* Whether the batch is a run of unknown length: its inputs are a stream, its results are recorded as they come, and it ends
 * with a summary.  Other batches have all their inputs on the command line, which is checked before the first encode. */
bool encode_batch_is_run(const encode_batch *batch);

/* Whether each packet is written to a file of its own. */
bool encode_batch_has_packet_files(const encode_batch *batch);

/* Whether the output is standard output. */
bool encode_batch_is_piped(const encode_batch *batch);

#endif
