#include "commands/encode_batch.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli/base64.h"
#include "cli/exit_code.h"
#include "cli/interrupt.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/names.h"
#include "cli/output_file.h"
#include "cli/progress.h"
#include "cli/read_file.h"
#include "cli/rate.h"
#include "cli/report_json.h"
#include "commands/batch_devices.h"
#include "commands/output_names.h"
#include "image/image_file.h"

/* With all devices, how many images may be encoded ahead of one that a slow device holds up, for each worker. */
#define AHEAD 4

/* An image and its encode.  The thread only encodes; the main thread handles files and messages. */
typedef struct encode_job {
    batch_devices *devices;
    batch_worker *worker; /* encodes it; NULL before */
    const char *input;
    gscl_image image;
    image_metadata metadata;
    gscl_block blocks[GSCL_BLOCK_XMP + 1]; /* by type */
    output_file output;
    gscl_encode_settings settings;
    progress_line line;
    pthread_t thread;
    int status; /* exit code if the thread was not started */
    bool started;
    bool is_done; /* nothing is left but to write the result; guarded by the lock of the devices */
    uint8_t *bytes;
    size_t size;
    gscl_encode_report report;
    gscl_result result;
} encode_job;

/* State of a running batch. */
typedef struct batch_state {
    const encode_batch *batch;
    batch_devices devices;
    encode_job *jobs; /* `job_count`; input i uses job i % job_count */
    int job_count;
    json_writer json;
    bool stop; /* after a signal, or a failure that all further inputs would share */
} batch_state;

/* ---- One image --------------------------------------------------------------------------------- */

static void print_report(batch_state *state, const encode_job *job) {
    const gscl_image *image = &job->image;
    const gscl_encode_report *report = &job->report;
    const char *output = job->output.label, *device = gscl_context_device(job->worker->context)->id;
    const double bpp = bits_per_pixel(report->bytes, image->width, image->height);
    json_writer *json = &state->json;
    if (!state->batch->json) {
        if (!state->batch->quiet)
            report_note("%s: %llu bytes, %.4f bpp, %u splats, %.2f dB, %.2f s%s%s", output,
                        (unsigned long long)report->bytes, bpp, report->splats, report->psnr, report->seconds,
                        state->devices.is_all ? " on device " : "", state->devices.is_all ? device : "");
        return;
    }
    json_open_object(json, NULL);
    json_string(json, "input", input_label(job->input));
    json_string(json, "output", output);
    json_string(json, "device", device);
    json_integer(json, "width", image->width);
    json_integer(json, "height", image->height);
    json_integer(json, "channels", image->channels);
    json_integer(json, "bytes", report->bytes);
    json_real(json, "bpp", bpp);
    json_integer(json, "splats", report->splats);
    json_real(json, "psnr", report->psnr);
    json_real(json, "seconds", report->seconds);
    json_integer(json, "trials", report->trials);
    json_string(json, "blend", blend_words[report->blend]);
    report_write_decisions(json, report);
    report_write_stages(json, report);
    if (state->batch->settings.trace)
        report_write_trace(json, report);
    json_close_object(json);
}

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

/* Starts the thread.  Signals are deferred until it ends, so that the library cancels the encode. */
static bool start_thread(batch_state *state, encode_job *job) {
    const encode_batch *batch = state->batch;
    job->settings = batch->settings;
    add_blocks(job);
    progress_start(&job->line, input_label(job->input), batch->quiet || batch->choice.verbose);
    job->settings.progress = progress_update;
    job->settings.progress_opaque = &job->line;
    interrupt_set_deferring(true);
    batch_worker_begin(job->worker, &job->image);
    job->started = pthread_create(&job->thread, NULL, run_job, job) == 0;
    if (!job->started) {
        batch_worker_end(job->worker);
        output_discard(&job->output);
        report_error(input_label(job->input),
                     "cannot be encoded: the system starts no thread for it; try fewer processes at a time");
    }
    return job->started;
}

static bool read_input(const encode_batch *batch, encode_job *job) {
    image_read_options options = batch->reading;
    options.quiet = batch->quiet;
    options.verbose = batch->choice.verbose;
    return image_read_with(job->input, &options, &job->image, &job->metadata);
}

static void free_input(encode_job *job) {
    free(job->image.pixels);
    image_metadata_free(&job->metadata);
}

static bool open_output(const batch_state *state, encode_job *job, const char *name) {
    return state->batch->base64 ? output_open_text(&job->output, name) : output_open(&job->output, name);
}

/* Reads an image and starts its encode by a worker.  A failure is reported and left in job->status. */
static void start_job(batch_state *state, encode_job *job, batch_worker *worker, const char *input,
                      const char *output_name) {
    *job = (encode_job){.devices = &state->devices, .worker = worker, .input = input, .status = EXIT_FAILURE};
    if (read_input(state->batch, job)) {
        const int opened = batch_worker_open(worker);
        if (opened != EXIT_SUCCESS) {
            job->status = opened;
            state->stop = true;
        } else if (open_output(state, job, output_name)) {
            start_thread(state, job);
        }
    }
    if (!job->started) {
        free_input(job);
        job->is_done = true;
    }
}

/* Writes the file, as bytes or as text. */
static void write_file(batch_state *state, encode_job *job) {
    if (!state->batch->base64) {
        output_write(&job->output, job->bytes, job->size);
        return;
    }
    size_t length = 0;
    char *line = base64_line(job->bytes, job->size, &length);
    if (line)
        output_write(&job->output, line, length);
    else
        job->output.error = ENOMEM;
    free(line);
}

/* Writes the result of the thread.  Returns the exit code. */
static int write_output(batch_state *state, encode_job *job) {
    if (job->result != GSCL_OK) {
        output_discard(&job->output);
        return report_result(job->worker->context, input_label(job->input), job->result);
    }
    write_file(state, job);
    gscl_free(job->bytes);
    if (!output_commit(&job->output))
        return EXIT_FAILURE;
    print_report(state, job);
    return EXIT_SUCCESS;
}

/* Waits for the encode and writes its result.  Returns the exit code. */
static int finish_job(batch_state *state, encode_job *job, bool is_last) {
    if (!job->started)
        return job->status;
    pthread_join(job->thread, NULL);
    if (is_last)
        interrupt_set_deferring(false);
    progress_finish(&job->line);
    const bool failed = job->result != GSCL_OK;
    /* The library does not see a signal that comes after its last check. */
    if (job->result == GSCL_OK && interrupt_pending()) {
        gscl_free(job->bytes);
        job->result = GSCL_ERROR_CANCELLED;
    }
    state->stop = state->stop || interrupt_pending() != 0;
    const int status = write_output(state, job);
    if (failed)
        batch_worker_end(job->worker);
    free_input(job);
    return status;
}

/* ---- All images -------------------------------------------------------------------------------- */

/* Starts the next image where a device has room for it. */
static bool start_next(batch_state *state, char *const *names, int started, int finished) {
    const encode_batch *batch = state->batch;
    if (started == batch->count || state->stop || started - finished == state->job_count)
        return false;
    batch_worker *worker = batch_devices_idle(&state->devices);
    if (worker)
        start_job(state, &state->jobs[started % state->job_count], worker, batch->inputs[started], names[started]);
    return worker != NULL;
}

/* Images are started by whatever device has room, and their results are written in the order of the inputs. */
static int encode_files(batch_state *state, char *const *names) {
    int status = EXIT_SUCCESS, started = 0, finished = 0;
    while (finished < started || (started < state->batch->count && !state->stop)) {
        encode_job *oldest = finished < started ? &state->jobs[finished % state->job_count] : NULL;
        bool is_done = false;
        const uint64_t endings = batch_devices_endings(&state->devices, oldest ? &oldest->is_done : NULL, &is_done);
        if (oldest && is_done) {
            const int job_status = finish_job(state, oldest, started == finished + 1);
            finished++;
            status = job_status != EXIT_SUCCESS ? job_status : status;
        } else if (start_next(state, names, started, finished)) {
            started++;
        } else if (oldest) {
            batch_devices_wait(&state->devices, endings);
        } else {
            report_error("OpenCL", "no device can be used; 'gscl devices' lists them");
            return EXIT_FAILURE;
        }
    }
    return status;
}

/* Opens the devices and encodes all images. */
static int encode_on_devices(batch_state *state, char *const *names) {
    int status = batch_devices_create(&state->devices, &state->batch->choice);
    state->job_count = BATCH_WORKERS * (state->devices.is_all ? AHEAD * (int)state->devices.count : 1);
    state->jobs = status == EXIT_SUCCESS ? calloc((size_t)state->job_count, sizeof *state->jobs) : NULL;
    if (state->jobs) {
        status = encode_files(state, names);
    } else if (status == EXIT_SUCCESS) {
        report_error(state->batch->inputs[0], "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        status = EXIT_FAILURE;
    }
    free(state->jobs);
    batch_devices_free(&state->devices);
    return status;
}

int encode_batch_run(const encode_batch *batch) {
    batch_state state = {.batch = batch};
    const char *output = batch->base64 && !batch->output && !batch->out_dir ? "-" : batch->output;
    char **names =
        output_names_make(batch->inputs, batch->count, output, batch->out_dir, batch->base64 ? ".b64" : ".gscl");
    if (!names) {
        report_error(batch->inputs[0], "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        return EXIT_FAILURE;
    }
    int status = EXIT_USAGE;
    if (output_names_check(batch->inputs, names, batch->count)) {
        const bool as_array = batch->json && batch->count > 1;
        json_start(&state.json, stdout);
        if (as_array)
            json_open_array(&state.json, NULL);
        status = encode_on_devices(&state, names);
        if (as_array)
            json_close_array(&state.json);
    }
    output_names_free(names, batch->count);
    return status;
}
