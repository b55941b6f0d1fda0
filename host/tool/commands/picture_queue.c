#define _DEFAULT_SOURCE /* strdup */
#include "commands/picture_queue.h"

#include "commands/packet_files.h"
#include "host/system/files.h"

#include <stdlib.h>
#include <string.h>

#include "cli/exit_code.h"
#include "cli/gscl_input.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/name_hash.h"
#include "cli/output_file.h"
#include "cli/read_file.h"

#define SHARD_KEY 6 /* of the hash; a change would give pictures to other shards */

static int open_run(picture_queue *queue) {
    const encode_batch *batch = queue->batch;
    if (!input_list_open(&queue->list, batch->inputs, batch->count, batch->files_from, batch->null))
        return EXIT_FAILURE;
    const int status = batch_report_open(&queue->report, batch->jsonl);
    queue->is_open = status == EXIT_SUCCESS;
    return status;
}

int picture_queue_open(picture_queue *queue, const encode_batch *batch) {
    int status = EXIT_SUCCESS;
    *queue = (picture_queue){.batch = batch,
                             .naming = {.output = encode_batch_is_piped(batch) ? "-" : batch->output,
                                        .out_dir = batch->out_dir,
                                        .keep_tree = batch->keep_tree,
                                        .suffix = encode_batch_has_packet_files(batch) ? FIRST_PACKET_SUFFIX
                                                  : batch->base64                      ? ".b64"
                                                                                       : ".gscl"},
                             .is_run = encode_batch_is_run(batch),
                             .list = {.file = -1},
                             .report = {.file = -1, .index = {.file = -1}}};
    if (queue->is_run)
        return open_run(queue);
    queue->names = output_names_make(&queue->naming, batch->inputs, batch->count, &status);
    return status;
}

/* ---- The next picture -------------------------------------------------------------------------- */

/* A picture of a command line whose names have been checked. */
static queue_state next_checked(picture_queue *queue, encode_job *job) {
    if (queue->taken == (uint64_t)queue->batch->count)
        return QUEUE_END;
    job->input = strdup(queue->batch->inputs[queue->taken]);
    job->output_name = strdup(queue->names[queue->taken]);
    return QUEUE_PICTURE;
}

/* Whether this run has a picture in its share, by the name of its output without --out-dir: this depends neither on the
 * order of the list nor on its other names, so that lists which machines make themselves, and lists that grow, give each
 * picture to one shard; and two pictures with the same output meet in one run, which finds that out. */
static bool is_in_shard(const picture_queue *queue, const char *input, const char *output) {
    const encode_batch *batch = queue->batch;
    const char *name = output ? output : input;
    if (batch->shard.count <= 1)
        return true;
    if (output && batch->out_dir && !batch->output)
        name += strlen(batch->out_dir) + 1;
    return name_hash(name, strlen(name), SHARD_KEY) % batch->shard.count == batch->shard.index - 1;
}

/* Records a picture that is not encoded: it is skipped, or it failed (`problem`). */
static queue_state record_unencoded(picture_queue *queue, const encode_job *job, int code, const char *problem,
                                    uint64_t bytes) {
    const picture_line line = {.id = job->id,
                               .status = problem ? PICTURE_FAILED : PICTURE_SKIPPED,
                               .input = job->input,
                               .output = job->output_name,
                               .code = code,
                               .message = problem,
                               .bytes = bytes};
    if (problem) {
        report_error(job->input, "%s", problem);
        queue->failed++;
        queue->status = EXIT_FAILURE;
    } else {
        queue->skipped++;
    }
    return batch_report_write(&queue->report, &line) ? QUEUE_HANDLED : QUEUE_ERROR;
}

/* Refuses a picture: it has no output of its own.  Then its input identifies it. */
static queue_state refuse(picture_queue *queue, encode_job *job, int code, const char *problem) {
    free(job->output_name);
    job->output_name = NULL;
    job->id = picture_identify(job->input, NULL);
    if (batch_report_find(&queue->report, &job->id) != PICTURE_IS_DONE)
        return record_unencoded(queue, job, code, problem, 0);
    queue->skipped++;
    return QUEUE_HANDLED;
}

/* Leaves out a picture whose output exists.  One that the report has already as done keeps its line. */
static queue_state skip(picture_queue *queue, const encode_job *job, picture_state state, uint64_t bytes) {
    output_remove_leftover(job->output_name);
    if (state != PICTURE_WAS_OK)
        return record_unencoded(queue, job, GSCL_OK, NULL, bytes);
    queue->skipped++;
    return batch_report_claim(&queue->report, &job->id) ? QUEUE_HANDLED : QUEUE_ERROR;
}

/* Whether an output is a whole file.  After a loss of power it may have its name, but not its bytes: waiting until they are
 * stored before an output gets its name would take 8 ms for each, while a file is read and checked in 0.1 to 1 ms. */
static bool is_whole(const encode_batch *batch, const char *name) {
    const gscl_form form = {.bare = batch->settings.bare, .base64 = batch->base64};
    const gscl_read_settings settings = read_settings_of(&form);
    gscl_info info = {.struct_size = sizeof info};
    uint8_t *bytes;
    size_t size;
    if (!read_gscl_file(name, &form, &bytes, &size))
        return false;
    const gscl_result result = gscl_inspect(bytes, size, &settings, &info);
    free(bytes);
    if (result != GSCL_OK && result != GSCL_ERROR_NEWER_VERSION)
        report_warning(name, "is no whole gscl file and is made again: %s", gscl_result_text(result));
    return result == GSCL_OK || result == GSCL_ERROR_NEWER_VERSION;
}

/* Leaves out a picture that crashed a run. */
static queue_state leave_out(picture_queue *queue, const encode_job *job) {
    report_error(job->input, "has crashed the library that reads it; remove its line from the report to try again");
    queue->failed++;
    queue->status = EXIT_FAILURE;
    return batch_report_claim(&queue->report, &job->id) ? QUEUE_HANDLED : QUEUE_ERROR;
}

/* Prepares a picture that is to be encoded. */
static queue_state hand_out(picture_queue *queue, encode_job *job) {
    const batch_report *report = &queue->report;
    job->crash = (crash_line){.file = report->is_regular ? report->file : -1,
                              .starts_again = report->is_regular && queue->list.can_restart};
    job->crash.text = batch_report_crash_line(&job->id, job->input, job->output_name, &job->crash.size);
    return batch_report_claim(&queue->report, &job->id) ? QUEUE_PICTURE : QUEUE_ERROR;
}

/* Decides what is to be done with the picture of a job. */
static queue_state decide(picture_queue *queue, encode_job *job) {
    uint64_t bytes;
    job->id = picture_identify(job->input, job->output_name);
    const picture_state state = batch_report_find(&queue->report, &job->id);
    if (state == PICTURE_ERROR)
        return QUEUE_ERROR;
    if (state == PICTURE_OUTPUT_TAKEN)
        return refuse(queue, job, PICTURE_TAKEN,
                      "has the same output as another input of this run or of the report; use --keep-tree, or encode "
                      "them into different folders");
    if (state == PICTURE_IS_DONE) { /* the input is named twice */
        queue->skipped++;
        return QUEUE_HANDLED;
    }
    if (queue->batch->skip_existing && output_exists(job->output_name, &bytes) &&
        is_whole(queue->batch, job->output_name))
        return skip(queue, job, state, bytes);
    if (!output_is_separate("encode", job->input, job->output_name))
        return refuse(queue, job, PICTURE_NAME, "would be overwritten by its output");
    return state == PICTURE_HAD_CRASHED ? leave_out(queue, job) : hand_out(queue, job);
}

static queue_state next_of_run(picture_queue *queue, encode_job *job) {
    const char *name, *problem, *naming_problem = NULL;
    const input_state state = input_list_next(&queue->list, &name, &problem);
    if (state != INPUT_NAME)
        return state == INPUT_WAIT ? QUEUE_WAIT : state == INPUT_END ? QUEUE_END : QUEUE_ERROR;
    job->input = strdup(name);
    if (!job->input) {
        report_error(name, "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        return QUEUE_ERROR;
    }
    job->output_name = problem ? NULL : output_name_make(&queue->naming, name, &naming_problem);
    if (!is_in_shard(queue, job->input, job->output_name))
        return QUEUE_HANDLED;
    if (!job->output_name)
        return refuse(queue, job, PICTURE_NAME, problem ? problem : naming_problem);
    return decide(queue, job);
}

queue_state picture_queue_next(picture_queue *queue, encode_job *job) {
    *job = (encode_job){.batch = queue->batch, .number = queue->taken, .in_use = true};
    queue_state state = queue->is_run ? next_of_run(queue, job) : next_checked(queue, job);
    if (state == QUEUE_PICTURE && !(job->input && job->output_name)) {
        report_error("encode", "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        state = QUEUE_ERROR;
    }
    if (state == QUEUE_PICTURE)
        queue->taken++;
    else
        encode_job_free(job);
    return state;
}

/* ---- Results ----------------------------------------------------------------------------------- */

bool picture_queue_record(picture_queue *queue, const encode_job *job) {
    const bool ok = job->status == EXIT_SUCCESS;
    if (job->status >= EXIT_SIGNAL || job->is_fatal) /* says nothing about the picture, which a later run encodes */
        return true;
    queue->encoded += ok;
    queue->failed += !ok;
    queue->status = ok ? queue->status : job->status;
    if (!queue->is_run)
        return true;
    const picture_line line = {.id = job->id,
                               .status = ok ? PICTURE_OK : PICTURE_FAILED,
                               .input = job->input,
                               .output = job->output_name,
                               .code = ok ? GSCL_OK : job->code,
                               .message = ok ? NULL : job->message,
                               .bytes = ok ? job->report.bytes : 0,
                               .image = job->image.pixels ? &job->image : NULL,
                               .encode = ok ? &job->report : NULL,
                               .device = ok ? gscl_context_device(job->worker->context)->id : NULL};
    return batch_report_write(&queue->report, &line);
}

static void print_summary(const picture_queue *queue, int stopped) {
    if (queue->batch->quiet && queue->failed == 0 && stopped == EXIT_SUCCESS)
        return;
    char skipped[40] = "";
    if (queue->is_run)
        snprintf(skipped, sizeof skipped, ", %llu skipped", (unsigned long long)queue->skipped);
    report_note("%llu encoded%s, %llu failed%s", (unsigned long long)queue->encoded, skipped,
                (unsigned long long)queue->failed, stopped == EXIT_SUCCESS ? "" : "; stopped before the end");
}

int picture_queue_close(picture_queue *queue, int stopped) {
    const bool is_single = !queue->is_run && queue->batch->count == 1;
    int status = stopped;
    if (status == EXIT_SUCCESS && queue->failed > 0) /* wrong settings fail for every picture */
        status = is_single || queue->status == EXIT_USAGE ? queue->status : EXIT_SOME;
    if (queue->names)
        output_names_free(queue->names, queue->batch->count);
    if (!queue->is_run && queue->encoded + queue->failed > 1 && !queue->batch->quiet)
        print_summary(queue, stopped);
    if (!queue->is_run)
        return status;
    input_list_close(&queue->list);
    if (queue->encoded > 0)
        system_store_below(queue->batch->out_dir); /* so that the summary holds after a loss of power */
    if (!batch_report_close(&queue->report))
        status = status >= EXIT_SIGNAL ? status : EXIT_FAILURE;
    if (queue->is_open)
        print_summary(queue, status == EXIT_SOME ? EXIT_SUCCESS : status);
    return status;
}
