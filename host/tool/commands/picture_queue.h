/* Which pictures of a batch are to be encoded, and what has become of them: the inputs, their outputs, the share of this
 * run, what is done already, the report and the summary. */
#ifndef GSCL_TOOL_PICTURE_QUEUE_H
#define GSCL_TOOL_PICTURE_QUEUE_H

#include <stdbool.h>
#include <stdint.h>

#include "commands/batch_report.h"
#include "commands/batch_settings.h"
#include "commands/encode_job.h"
#include "commands/input_list.h"
#include "commands/output_names.h"

typedef struct picture_queue {
    const encode_batch *batch;
    output_naming naming;
    char **names; /* of all outputs, where the batch is no run; else NULL */
    bool is_run;
    bool is_open;
    input_list list;
    batch_report report; /* of a run */
    uint64_t taken;      /* pictures given to jobs */
    uint64_t encoded, skipped, failed;
    int status; /* exit code of the picture that failed last */
} picture_queue;

typedef enum queue_state {
    QUEUE_PICTURE, /* a job has been given a picture */
    QUEUE_HANDLED, /* a name needed no encode; there may be more */
    QUEUE_WAIT,    /* the list has no next name yet */
    QUEUE_END,
    QUEUE_ERROR /* the list or the report cannot be used; has been reported */
} queue_state;

/* Reports errors and returns the exit code of the program; the caller closes in either case. */
int picture_queue_open(picture_queue *queue, const encode_batch *batch);

/* Sets batch, input, output_name, id and number of the job. */
queue_state picture_queue_next(picture_queue *queue, encode_job *job);

/* Counts and reports a finished job.  Returns false when the report cannot be written. */
bool picture_queue_record(picture_queue *queue, const encode_job *job);

/* Ends the report and prints the summary of a run, which was stopped early where `stopped` is the exit code of the program
 * for that, or else EXIT_SUCCESS.  Returns the exit code of the program. */
int picture_queue_close(picture_queue *queue, int stopped);

#endif
