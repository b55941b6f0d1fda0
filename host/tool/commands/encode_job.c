#include "commands/encode_job.h"

#include <errno.h>
#include <stdlib.h>

#include "cli/base64.h"
#include "cli/exit_code.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/read_file.h"
#include "commands/packet_files.h"
#include "image/image_file.h"

/* ---- The start --------------------------------------------------------------------------------- */

static void *run_job(void *opaque) {
    encode_job *job = opaque;
    job->report.struct_size = sizeof job->report;
    job->result = gscl_encode(job->worker->context, &job->image, &job->settings, &job->bytes, &job->size, &job->report);
    if (job->result == GSCL_OK) /* else the message of the context is still needed */
        batch_worker_end(job->worker);
    batch_devices_signal(job->devices, &job->is_done);
    return NULL;
}

static void add_block(encode_job *job, gscl_block_type type, const void *data, size_t size) {
    gscl_block *block = &job->blocks[type];
    if (size == 0)
        return;
    *block = (gscl_block){.next = job->settings.blocks, .type = type, .data = data, .size = size};
    job->settings.blocks = block;
}

static void add_blocks(encode_job *job) {
    const image_metadata *metadata = &job->metadata;
    add_block(job, GSCL_BLOCK_COLOUR_SPACE, metadata->cicp, metadata->has_cicp ? sizeof metadata->cicp : 0);
    add_block(job, GSCL_BLOCK_ICC, metadata->icc.bytes, metadata->icc.size);
    add_block(job, GSCL_BLOCK_EXIF, metadata->exif.bytes, metadata->exif.size);
    add_block(job, GSCL_BLOCK_XMP, metadata->xmp.bytes, metadata->xmp.size);
}

static int start_thread(encode_job *job) {
    const encode_batch *batch = job->batch;
    job->settings = batch->settings;
    add_blocks(job);
    progress_start(&job->line, input_label(job->input), batch->quiet || batch->choice.verbose);
    job->settings.progress = progress_update;
    job->settings.progress_opaque = &job->line;
    interrupt_set_deferring(true); /* until the thread ends, so that the library cancels the encode */
    batch_worker_begin(job->worker, &job->image);
    job->started = pthread_create(&job->thread, NULL, run_job, job) == 0;
    if (job->started)
        return EXIT_SUCCESS;
    batch_worker_end(job->worker);
    output_discard(&job->output);
    job->code = GSCL_ERROR_OUT_OF_MEMORY;
    report_error(input_label(job->input),
                 "cannot be encoded: the system starts no thread for it; try fewer processes at a time");
    return EXIT_FAILURE;
}

static bool read_input(encode_job *job) {
    image_read_options options = job->batch->reading;
    options.quiet = job->batch->quiet;
    options.verbose = job->batch->choice.verbose;
    if (!job->crash.text)
        return image_read_with(job->input, &options, &job->image, &job->metadata);
    crash_guard_begin(input_label(job->input), &job->crash);
    const bool ok = image_read_with(job->input, &options, &job->image, &job->metadata);
    crash_guard_end();
    return ok;
}

static bool open_output(encode_job *job) {
    if (job->batch->out_dir && !output_make_folders(job->output_name))
        return false;
    return job->batch->base64 ? output_open_text(&job->output, job->output_name)
                              : output_open(&job->output, job->output_name);
}

/* Reads the image, opens context and output, and starts the thread.  Returns the exit code of the program. */
static int prepare(encode_job *job) {
    job->code = PICTURE_INPUT;
    if (!read_input(job))
        return EXIT_FAILURE;
    const int opened = batch_worker_open(job->worker);
    if (opened != EXIT_SUCCESS) {
        job->is_fatal = true;
        return opened;
    }
    job->code = PICTURE_OUTPUT;
    if (!open_output(job))
        return EXIT_FAILURE;
    return start_thread(job);
}

void encode_job_start(encode_job *job, batch_worker *worker) {
    job->worker = worker;
    message_keep_errors(job->message, sizeof job->message);
    job->status = prepare(job);
    message_keep_errors(NULL, 0);
    if (!job->started)
        job->is_done = true;
}

/* ---- The end ----------------------------------------------------------------------------------- */

static void write_line(encode_job *job, const uint8_t *bytes, size_t size) {
    size_t length = 0;
    char *line = base64_line(bytes, size, &length);
    if (line)
        output_write(&job->output, line, length);
    else
        job->output.error = ENOMEM;
    free(line);
}

/* Writes each packet, or the file, as a line of text. */
static void write_text(encode_job *job) {
    const uint8_t *packet;
    size_t position = 0, size;
    if (job->settings.packet_size == 0)
        write_line(job, job->bytes, job->size);
    while (gscl_next_packet(job->bytes, job->size, &position, &packet, &size))
        write_line(job, packet, size);
}

/* Writes the file, the list of packets or the packets, as bytes or as text. */
static bool write_file(encode_job *job) {
    if (encode_batch_has_packet_files(job->batch))
        return packet_files_write(&job->output, job->output_name, job->bytes, job->size);
    if (job->batch->base64)
        write_text(job);
    else
        output_write(&job->output, job->bytes, job->size);
    return true;
}

/* Writes the result of the thread.  Returns the exit code of the program. */
static int write_output(encode_job *job) {
    job->code = job->result;
    if (job->result != GSCL_OK) {
        output_discard(&job->output);
        return report_result(job->worker->context, input_label(job->input), job->result);
    }
    const bool ok = write_file(job);
    gscl_free(job->bytes);
    if (!ok)
        output_discard(&job->output);
    else if (output_commit(&job->output))
        return EXIT_SUCCESS;
    job->code = PICTURE_OUTPUT;
    return EXIT_FAILURE;
}

void encode_job_finish(encode_job *job) {
    if (!job->started)
        return;
    pthread_join(job->thread, NULL);
    progress_finish(&job->line);
    const bool failed = job->result != GSCL_OK;
    /* The library does not see a signal that comes after its last check. */
    if (job->result == GSCL_OK && interrupt_pending()) {
        gscl_free(job->bytes);
        job->result = GSCL_ERROR_CANCELLED;
    }
    message_keep_errors(job->message, sizeof job->message);
    job->status = write_output(job);
    message_keep_errors(NULL, 0);
    if (failed)
        batch_worker_end(job->worker);
}

void encode_job_free(encode_job *job) {
    free(job->image.pixels);
    image_metadata_free(&job->metadata);
    free(job->input);
    free(job->output_name);
    free(job->crash.text);
    *job = (encode_job){.in_use = false};
}
