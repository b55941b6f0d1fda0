/* One image of a batch: it is read, encoded by a thread, and written. */
#ifndef GSCL_TOOL_ENCODE_JOB_H
#define GSCL_TOOL_ENCODE_JOB_H

#include <pthread.h>
#include <stdbool.h>

#include <gscl/gscl.h>

#include "cli/output_file.h"
#include "cli/progress.h"
#include "commands/batch_devices.h"
#include "commands/batch_report.h"
#include "commands/batch_settings.h"
#include "host/system/crash_guard.h"
#include "image/image_content.h"

#define JOB_MESSAGE_SIZE 512 /* bytes, the NUL included; a longer message is cut */

/* The thread only encodes; the main thread handles files and messages. */
typedef struct encode_job {
    const encode_batch *batch;
    batch_devices *devices;
    batch_worker *worker; /* encodes it; NULL before */
    char *input, *output_name;
    picture_id id;
    uint64_t number;  /* of the image in the batch */
    crash_line crash; /* of a run: what the report gets if reading the image crashes */
    gscl_image image;
    image_metadata metadata;
    gscl_block blocks[GSCL_BLOCK_XMP + 1]; /* by type */
    output_file output;
    gscl_encode_settings settings;
    progress_line line;
    pthread_t thread;
    bool in_use;
    bool started;
    bool is_done; /* nothing is left but to write the result; guarded by the lock of the devices */
    uint8_t *bytes;
    size_t size;
    gscl_encode_report report;
    gscl_result result;
    int status;                     /* exit code of the program for this image alone */
    bool is_fatal;                  /* all further images would fail as this one */
    int code;                       /* as in picture_line */
    char message[JOB_MESSAGE_SIZE]; /* of the error */
} encode_job;

/* Reads the image and starts the encode by a worker.  batch, devices, input, output_name, id and number are set.  A failure
 * is reported and left in the job, which then is done. */
void encode_job_start(encode_job *job, batch_worker *worker);

/* Waits for the encode and writes its result.  Reports errors; job->status says how it ended. */
void encode_job_finish(encode_job *job);

/* Releases what encode_job_finish leaves: names, pixels and metadata. */
void encode_job_free(encode_job *job);

#endif
