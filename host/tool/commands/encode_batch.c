#include "commands/encode_batch.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli/exit_code.h"
#include "cli/interrupt.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/names.h"
#include "cli/rate.h"
#include "cli/read_file.h"
#include "cli/report_json.h"
#include "commands/batch_devices.h"
#include "commands/encode_job.h"
#include "commands/picture_queue.h"

/* With all devices and results in order, how many images may be encoded ahead of one that a slow device holds up, for each
 * worker. */
#define AHEAD 4

/* How long to wait for the next name of a list, in ms: an encode may end meanwhile, or a signal come. */
#define WAIT_WHILE_ENCODING 20
#define WAIT_FOR_NAME 100

/* State of a running batch. */
typedef struct batch_state {
    const encode_batch *batch;
    batch_devices devices;
    picture_queue queue;
    encode_job *jobs; /* `job_count` */
    int job_count, running;
    bool is_ordered;   /* results are written in the order of the inputs */
    uint64_t finished; /* jobs */
    json_writer json;
    bool is_ended; /* no input is left */
    int stopped;   /* exit code of the program after a failure that all further inputs would share; else EXIT_SUCCESS */
} batch_state;

/* Says where a quality was not reached, whose best file is a result all the same (GSCL_TARGET_QUALITY). */
static void note_missed_quality(const encode_job *job) {
    const double quality = job->settings.target_value;
    if (job->settings.target == GSCL_TARGET_QUALITY && job->report.ssimulacra2 < gscl_quality_score(quality))
        report_note("%s: quality %g is not reached: this is the best file that was found", job->output.label, quality);
}

static void print_report(batch_state *state, const encode_job *job) {
    const gscl_image *image = &job->image;
    const gscl_encode_report *report = &job->report;
    const char *output = job->output.label, *device = gscl_context_device(job->worker->context)->id;
    const double bpp = bits_per_pixel(report->bytes, image->width, image->height);
    json_writer *json = &state->json;
    if (!state->batch->json) {
        char score[40] = "";
        if (!isnan(report->ssimulacra2))
            snprintf(score, sizeof score, "SSIMULACRA 2 %.2f, ", report->ssimulacra2);
        if (!state->batch->quiet) {
            report_note("%s: %llu bytes, %.4f bpp, %u splats, %.2f dB, %s%.2f s%s%s", output,
                        (unsigned long long)report->bytes, bpp, report->splats, report->psnr, score, report->seconds,
                        state->devices.is_all ? " on device " : "", state->devices.is_all ? device : "");
            note_missed_quality(job);
        }
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
    json_real(json, "ssimulacra2", report->ssimulacra2);
    json_real(json, "seconds", report->seconds);
    json_integer(json, "trials", report->trials);
    json_string(json, "blend", blend_words[report->blend]);
    json_string(json, "tune", tune_words[report->tune]);
    report_write_decisions(json, report);
    report_write_stages(json, report);
    if (state->batch->settings.trace)
        report_write_trace(json, report);
    json_close_object(json);
}

/* ---- Jobs -------------------------------------------------------------------------------------- */

/* A signal ends the program at once, but while images are encoded, and in a run, whose report and summary it would lose. */
static void update_deferring(const batch_state *state) {
    interrupt_set_deferring(state->running > 0 || state->queue.is_run);
}

/* A job whose result can be written, or NULL. */
static encode_job *find_done(batch_state *state) {
    for (int i = 0; i < state->job_count; i++) {
        encode_job *job = &state->jobs[i];
        bool is_done = false;
        if (!job->in_use || (state->is_ordered && job->number != state->finished))
            continue;
        batch_devices_endings(&state->devices, &job->is_done, &is_done);
        if (is_done)
            return job;
    }
    return NULL;
}

static encode_job *find_free(batch_state *state) {
    for (int i = 0; i < state->job_count; i++)
        if (!state->jobs[i].in_use)
            return &state->jobs[i];
    return NULL;
}

static void finish_job(batch_state *state, encode_job *job) {
    encode_job_finish(job);
    state->finished++;
    state->running--;
    update_deferring(state);
    if (job->status == EXIT_SUCCESS)
        print_report(state, job);
    if (!picture_queue_record(&state->queue, job))
        state->stopped = EXIT_FAILURE;
    if (job->is_fatal)
        state->stopped = job->status;
    encode_job_free(job);
}

/* Starts the next image where a device has room for it.  Returns false where nothing can be done but wait. */
static bool start_next(batch_state *state) {
    encode_job *job = state->is_ended || state->stopped != EXIT_SUCCESS ? NULL : find_free(state);
    batch_worker *worker = job ? batch_devices_idle(&state->devices) : NULL;
    if (job && !worker && state->running == 0) {
        report_error("devices", "no device can be used; 'gscl devices' lists them");
        state->stopped = EXIT_FAILURE;
    }
    if (!worker)
        return false;
    switch (picture_queue_next(&state->queue, job)) {
    case QUEUE_PICTURE:
        job->devices = &state->devices;
        state->running++;
        encode_job_start(job, worker);
        return true;
    case QUEUE_HANDLED:
        return true;
    case QUEUE_WAIT:
        input_list_wait(&state->queue.list, state->running > 0 ? WAIT_WHILE_ENCODING : WAIT_FOR_NAME);
        return true;
    case QUEUE_END:
        state->is_ended = true;
        return true;
    case QUEUE_ERROR:
        state->stopped = EXIT_FAILURE;
        return true;
    }
    return false;
}

/* Images are started by whatever device has room. */
static void encode_pictures(batch_state *state) {
    for (;;) {
        /* Before the jobs are looked at, so that none ends unseen. */
        const uint64_t endings = batch_devices_endings(&state->devices, NULL, NULL);
        encode_job *done = find_done(state);
        if (interrupt_pending())
            state->stopped = EXIT_SIGNAL + interrupt_pending();
        if (done)
            finish_job(state, done);
        else if (start_next(state))
            continue;
        else if (state->running > 0)
            batch_devices_wait(&state->devices, endings);
        else
            return;
    }
}

/* ---- The batch --------------------------------------------------------------------------------- */

/* Opens the devices and encodes all images.  The exit code is left in the state. */
static void encode_on_devices(batch_state *state) {
    state->stopped = batch_devices_create(&state->devices, &state->batch->choice, (int)state->batch->jobs);
    state->job_count = (int)state->devices.worker_count;
    if (state->devices.is_all && state->is_ordered)
        state->job_count *= AHEAD;
    if (state->job_count > MAX_GUARDED_FILES)
        state->job_count = MAX_GUARDED_FILES;
    state->jobs = state->stopped == EXIT_SUCCESS ? calloc((size_t)state->job_count, sizeof *state->jobs) : NULL;
    if (state->jobs) {
        update_deferring(state);
        encode_pictures(state);
    } else if (state->stopped == EXIT_SUCCESS) {
        report_error("encode", "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        state->stopped = EXIT_FAILURE;
    }
    free(state->jobs);
    batch_devices_free(&state->devices);
}

int encode_batch_run(const encode_batch *batch) {
    batch_state state = {.batch = batch, .is_ordered = batch->json || encode_batch_is_piped(batch)};
    int status = picture_queue_open(&state.queue, batch);
    if (status == EXIT_SUCCESS) {
        const bool as_array = batch->json && batch->count > 1;
        json_start(&state.json, stdout);
        if (as_array)
            json_open_array(&state.json, NULL);
        encode_on_devices(&state);
        if (as_array)
            json_close_array(&state.json);
        return picture_queue_close(&state.queue, state.stopped);
    }
    picture_queue_close(&state.queue, status);
    return status;
}
