#define _DEFAULT_SOURCE /* strdup, access */
#include "encode_batch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "command.h"
#include "image_file.h"
#include "interrupt.h"
#include "json.h"
#include "message.h"
#include "output_file.h"
#include "progress.h"
#include "read_file.h"

#define SUFFIX ".gscl"

/* What changes while a batch runs. */
typedef struct batch_state {
    const encode_batch *batch;
    gscl_context *context; /* opened for the first image that can be read */
    json_writer json;
    bool stop; /* a failure that all further inputs would share, or a signal */
} batch_state;

/* ---- Names of outputs -------------------------------------------------------------------------- */

/* DIR/NAME.gscl for PATH/NAME.png; without DIR, PATH/NAME.gscl.  NULL when out of memory. */
static char *make_output_name(const char *input, const char *out_dir) {
    const char *slash = strrchr(input, '/');
    const char *start = out_dir && slash ? slash + 1 : input;
    const int stem = (int)(name_suffix(input) - start);
    const size_t capacity = (out_dir ? strlen(out_dir) + 1 : 0) + (size_t)stem + sizeof SUFFIX;
    char *name = malloc(capacity);
    if (name)
        snprintf(name, capacity, "%s%s%.*s" SUFFIX, out_dir ? out_dir : "", out_dir ? "/" : "", stem, start);
    return name;
}

static void free_names(char **names, int count) {
    for (int i = 0; names && i < count; i++)
        free(names[i]);
    free(names);
}

/* One name for each input; NULL when out of memory. */
static char **make_output_names(const encode_batch *batch) {
    char **names = calloc((size_t)batch->count, sizeof *names);
    for (int i = 0; names && i < batch->count; i++) {
        names[i] = batch->output ? strdup(batch->output) : make_output_name(batch->inputs[i], batch->out_dir);
        if (!names[i]) {
            free_names(names, batch->count);
            return NULL;
        }
    }
    return names;
}

static bool overwrites_input(const encode_batch *batch, const char *name) {
    for (int i = 0; access(name, F_OK) == 0 && i < batch->count; i++) {
        if (!output_is_separate("encode", batch->inputs[i], name))
            return true;
    }
    return false;
}

/* Refuses outputs that would overwrite an input or each other. */
static bool check_output_names(const encode_batch *batch, char *const *names) {
    for (int i = 0; i < batch->count; i++) {
        if (overwrites_input(batch, names[i]))
            return false;
        for (int j = 0; j < i; j++) {
            if (strcmp(names[i], names[j]) == 0) {
                report_usage("encode", "%s and %s would both be written to %s; encode them into different folders",
                             batch->inputs[j], batch->inputs[i], names[i]);
                return false;
            }
        }
    }
    return true;
}

/* ---- One image --------------------------------------------------------------------------------- */

static double bits_per_pixel(const gscl_image *image, uint64_t bytes) {
    return 8.0 * (double)bytes / ((double)image->width * image->height);
}

static void print_report(batch_state *state, const char *input, const char *output, const gscl_image *image,
                         const gscl_encode_report *report) {
    const double bpp = bits_per_pixel(image, report->bytes);
    json_writer *json = &state->json;
    if (!state->batch->json) {
        if (!state->batch->quiet)
            report_note("%s: %llu bytes, %.4f bpp, %u splats, %.2f dB, %.2f s", output,
                        (unsigned long long)report->bytes, bpp, report->splats, report->psnr, report->seconds);
        return;
    }
    json_open_object(json, NULL);
    json_string(json, "input", input);
    json_string(json, "output", output);
    json_integer(json, "width", image->width);
    json_integer(json, "height", image->height);
    json_integer(json, "channels", image->channels);
    json_integer(json, "bytes", report->bytes);
    json_real(json, "bpp", bpp);
    json_integer(json, "splats", report->splats);
    json_real(json, "psnr", report->psnr);
    json_real(json, "seconds", report->seconds);
    json_integer(json, "trials", report->trials);
    json_close_object(json);
}

/* Encodes with a progress line; the signal handler leaves winding up to the library meanwhile. */
static gscl_result encode_image(batch_state *state, const char *input, const gscl_image *image, uint8_t **bytes,
                                size_t *size, gscl_encode_report *report) {
    const encode_batch *batch = state->batch;
    gscl_encode_settings settings = batch->settings;
    progress_line line;
    progress_start(&line, input, batch->quiet || batch->choice.verbose);
    settings.progress = progress_update;
    settings.progress_opaque = &line;
    interrupt_set_patient(true);
    const gscl_result result = gscl_encode(state->context, image, &settings, bytes, size, report);
    interrupt_set_patient(false);
    progress_finish(&line);
    /* A signal may come too late for the library to see it. */
    if (result == GSCL_OK && interrupt_pending()) {
        gscl_free(*bytes);
        return GSCL_ERROR_CANCELLED;
    }
    return result;
}

/* Encodes into `output`, which is closed in any case.  Returns the exit code. */
static int encode_to(batch_state *state, const char *input, const gscl_image *image, output_file *output) {
    uint8_t *bytes;
    size_t size;
    gscl_encode_report report;
    const gscl_result result = encode_image(state, input_label(input), image, &bytes, &size, &report);
    if (result != GSCL_OK) {
        output_discard(output);
        state->stop = interrupt_pending() != 0;
        return report_result(state->context, input_label(input), result);
    }
    output_write(output, bytes, size);
    gscl_free(bytes);
    if (!output_commit(output))
        return EXIT_FAILURE;
    print_report(state, input_label(input), output->label, image, &report);
    return EXIT_SUCCESS;
}

static int encode_file(batch_state *state, const char *input, const char *output_name) {
    gscl_image image;
    output_file output;
    int status = EXIT_FAILURE;
    if (!image_read(input, &image))
        return EXIT_FAILURE;
    if (!state->context) {
        status = open_device(&state->batch->choice, &state->context);
        state->stop = status != EXIT_SUCCESS;
    }
    if (state->context)
        status = output_open(&output, output_name) ? encode_to(state, input, &image, &output) : EXIT_FAILURE;
    free(image.pixels);
    return status;
}

/* ---- All images -------------------------------------------------------------------------------- */

static int encode_files(batch_state *state, char *const *names) {
    const encode_batch *batch = state->batch;
    int status = EXIT_SUCCESS;
    for (int i = 0; i < batch->count && !state->stop; i++) {
        const int one = encode_file(state, batch->inputs[i], names[i]);
        status = one != EXIT_SUCCESS ? one : status;
    }
    return status;
}

int encode_batch_run(const encode_batch *batch) {
    batch_state state = {.batch = batch};
    char **names = make_output_names(batch);
    if (!names) {
        report_error(batch->inputs[0], "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        return EXIT_FAILURE;
    }
    int status = EXIT_USAGE;
    if (check_output_names(batch, names)) {
        const bool as_array = batch->json && batch->count > 1;
        json_start(&state.json, stdout);
        if (as_array)
            json_open_array(&state.json, NULL);
        status = encode_files(&state, names);
        if (as_array)
            json_close_array(&state.json);
    }
    gscl_context_free(&state.context);
    free_names(names, batch->count);
    return status;
}
