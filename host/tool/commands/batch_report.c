#define _DEFAULT_SOURCE /* fdopen, lseek */
#include "commands/batch_report.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/exit_code.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/name_hash.h"
#include "cli/output_file.h"
#include "host/system/files.h"
#include "host/system/output_target.h"
#include "host/system/text_stream.h"

/* The state of an entry: where its line begins, whether it is of this run, and its status. */
#define STATE_STATUS 7u   /* mask; 0: being encoded */
#define STATE_THIS_RUN 8u /* flag */
#define STATE_IN_USE 16u  /* flag, always set */
#define STATE_LINE 32u    /* factor of the offset of the line plus 1; 0: none */

#define LINE_SIZE ((size_t)256 << 10) /* bytes; two names, escaped, and a message are shorter */

static const char *const status_words[] =
    {[PICTURE_OK] = "ok", [PICTURE_SKIPPED] = "skipped", [PICTURE_FAILED] = "failed", [PICTURE_CRASHED] = "crashed"};

picture_id picture_identify(const char *input, const char *output) {
    const char *name = output ? output : input;
    const size_t size = strlen(name);
    const uint64_t first_key = output ? 1 : 3;
    return (picture_id){.key = {name_hash(name, size, first_key), name_hash(name, size, first_key + 1)},
                        .input = name_hash(input, strlen(input), 5)};
}

static bool report_index_error(void) {
    return report_error("the index of the batch", "cannot be written to $TMPDIR or /tmp: %s", system_error_text(errno));
}

/* ---- Lines ------------------------------------------------------------------------------------- */

static void write_number(json_writer *json, const char *key, bool is_known, uint64_t value) {
    if (is_known)
        json_integer(json, key, value);
    else
        json_null(json, key);
}

static void write_text(json_writer *json, const char *key, const char *value) {
    if (value)
        json_string(json, key, value);
    else
        json_null(json, key);
}

/* The same members in every line; what is not known is null. */
static void write_members(json_writer *json, const picture_line *line) {
    char id[3 * 16 + 1];
    snprintf(id, sizeof id, "%016" PRIx64 "%016" PRIx64 "%016" PRIx64, line->id.key[0], line->id.key[1],
             line->id.input);
    json_string(json, "id", id);
    json_string(json, "status", status_words[line->status]);
    json_string(json, "input", line->input);
    write_text(json, "output", line->output);
    json_integer(json, "code", (uint64_t)line->code);
    write_text(json, "message", line->message);
    write_number(json, "bytes", line->bytes > 0, line->bytes);
    write_number(json, "width", line->image, line->image ? line->image->width : 0);
    write_number(json, "height", line->image, line->image ? line->image->height : 0);
    write_number(json, "splats", line->encode, line->encode ? line->encode->splats : 0);
    if (line->encode) {
        json_real(json, "psnr", line->encode->psnr);
        json_real(json, "ssimulacra2", line->encode->ssimulacra2);
        json_real(json, "seconds", line->encode->seconds);
    } else {
        json_null(json, "psnr");
        json_null(json, "ssimulacra2");
        json_null(json, "seconds");
    }
    write_text(json, "device", line->device);
}

/* The line with its line break, to be released with free; NULL when out of memory. */
static char *make_line(const picture_line *line, size_t *size) {
    char *text;
    text_stream memory;
    json_writer json;
    if (!text_stream_open(&memory))
        return NULL;
    json_start_line(&json, memory.stream);
    json_open_object(&json, NULL);
    write_members(&json, line);
    json_close_object(&json);
    return text_stream_close(&memory, &text, size) ? text : NULL;
}

char *batch_report_crash_line(const picture_id *id, const char *input, const char *output, size_t *size) {
    const picture_line line = {.id = *id,
                               .status = PICTURE_CRASHED,
                               .input = input,
                               .output = output,
                               .code = PICTURE_CRASH,
                               .message = "the library that reads it has crashed"};
    return make_line(&line, size);
}

/* Reads the start of a line.  Returns false for a line that is none of a report. */
static bool parse_line(const char *line, picture_id *id, picture_status *status) {
    static const char start[] =
        "{\"id\":\"%16" SCNx64 "%16" SCNx64 "%16" SCNx64 "\",\"status\":\"%7[a-z]\",\"input\":%n";
    char word[8];
    int used = 0;
    if (sscanf(line, start, &id->key[0], &id->key[1], &id->input, word, &used) != 4 || used == 0)
        return false;
    for (picture_status i = PICTURE_OK; i <= PICTURE_CRASHED; i++) {
        if (strcmp(word, status_words[i]) == 0) {
            *status = i;
            return true;
        }
    }
    return false;
}

/* ---- The index --------------------------------------------------------------------------------- */

static bool index_line(batch_report *report, const picture_id *id, uint64_t state) {
    name_entry entry;
    if (!name_index_get(&report->index, id->key, &entry))
        return report_index_error();
    report->has_old_lines = report->has_old_lines || (entry.state / STATE_LINE > 0 && state / STATE_LINE > 0);
    if (state < STATE_LINE) /* no line yet: an old one remains the last */
        state |= entry.state / STATE_LINE * STATE_LINE;
    entry = (name_entry){{id->key[0], id->key[1]}, id->input, state};
    return name_index_put(&report->index, &entry) || report_index_error();
}

picture_state batch_report_find(const batch_report *report, const picture_id *id) {
    name_entry entry;
    if (!name_index_get(&report->index, id->key, &entry)) {
        report_index_error();
        return PICTURE_ERROR;
    }
    if (entry.state == 0)
        return PICTURE_IS_NEW;
    if (entry.input != id->input)
        return PICTURE_OUTPUT_TAKEN;
    if (entry.state & STATE_THIS_RUN)
        return PICTURE_IS_DONE;
    const picture_status status = (picture_status)(entry.state & STATE_STATUS);
    return status == PICTURE_CRASHED  ? PICTURE_HAD_CRASHED
           : status == PICTURE_FAILED ? PICTURE_HAD_FAILED
                                      : PICTURE_WAS_OK;
}

bool batch_report_claim(batch_report *report, const picture_id *id) {
    return index_line(report, id, STATE_IN_USE | STATE_THIS_RUN);
}

/* ---- The file of earlier runs ------------------------------------------------------------------ */

static int report_foreign(const batch_report *report, uint64_t number) {
    return report_usage("encode", "%s is no report of gscl encode --jsonl: see its line %" PRIu64 "; name another file",
                        report->name, number);
}

/* Reads all lines into the index, and finds the end of the last whole one.  The rest is what a killed process had begun to
 * write, if it begins as a line does. */
static int read_lines(batch_report *report, FILE *stream, char *line) {
    static const char first[] = "{\"id\":\"";
    const size_t start_size = sizeof first - 1;
    picture_id id;
    picture_status status;
    for (uint64_t number = 1; fgets(line, (int)LINE_SIZE, stream); number++) {
        const size_t length = strlen(line);
        if (length == 0) /* zeros, which a loss of power leaves where lines had begun to be stored */
            return number > 1 ? EXIT_SUCCESS : report_foreign(report, number);
        const bool is_whole = length > 0 && line[length - 1] == '\n';
        if (!is_whole && feof(stream) && strncmp(line, first, length < start_size ? length : start_size) == 0)
            return EXIT_SUCCESS;
        if (!is_whole || !parse_line(line, &id, &status))
            return report_foreign(report, number);
        if (!index_line(report, &id, STATE_IN_USE | status | (report->size + 1) * STATE_LINE))
            return EXIT_FAILURE;
        report->size += length;
    }
    if (!ferror(stream))
        return EXIT_SUCCESS;
    report_error(report->name, "cannot be read: %s", system_error_text(errno));
    return EXIT_FAILURE;
}

/* A stream of the file of its own, at the start. */
static FILE *open_lines(const batch_report *report) {
    const int copy = system_duplicate(report->file);
    FILE *stream = copy >= 0 && lseek(copy, 0, SEEK_SET) == 0 ? fdopen(copy, "r") : NULL;
    if (!stream) {
        report_error(report->name, "cannot be read: %s", system_error_text(errno));
        if (copy >= 0)
            close(copy);
    }
    return stream;
}

static int read_report(batch_report *report) {
    FILE *stream = open_lines(report);
    char *line = stream ? malloc(LINE_SIZE) : NULL;
    int status = EXIT_FAILURE;
    if (line)
        status = read_lines(report, stream, line);
    else if (stream)
        report_error(report->name, "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
    free(line);
    if (stream)
        fclose(stream);
    if (status == EXIT_SUCCESS && !system_set_size(report->file, report->size)) {
        report_error(report->name, "cannot be written: %s", system_error_text(errno));
        status = EXIT_FAILURE;
    }
    return status;
}

/* Locks the report, so that two runs do not write into one.  A run that ends may replace the file meanwhile. */
static int lock_report(batch_report *report) {
    system_status opened, named;
    if (!system_status_of_open(report->file, &opened) || !opened.is_regular)
        return EXIT_SUCCESS;
    report->is_regular = true;
    if (!system_lock(report->file) && errno == EWOULDBLOCK)
        return report_usage("encode", "another run is writing %s; give each run, or each shard, a report of its own",
                            report->name);
    if (!system_status_of(report->name, &named) || !system_is_same(&named, &opened))
        return report_usage("encode", "%s has just been replaced by another run; try again", report->name);
    return read_report(report);
}

int batch_report_open(batch_report *report, const char *name) {
    *report = (batch_report){.name = name, .file = -1};
    if (!name_index_create(&report->index)) {
        report_index_error();
        return EXIT_FAILURE;
    }
    if (!name)
        return EXIT_SUCCESS;
    const bool is_in_place = output_is_in_place(name);
    if (strcmp(name, "-") == 0)
        report->name = "standard output";
    report->file = is_in_place ? output_open_in_place(name) : system_open_to_append(name);
    if (report->file < 0) {
        report_error(report->name, "cannot be written: %s", system_error_text(errno));
        return EXIT_FAILURE;
    }
    return is_in_place ? EXIT_SUCCESS : lock_report(report);
}

/* ---- Writing ----------------------------------------------------------------------------------- */

/* Writes all bytes.  What a full disk cuts off is removed again. */
static bool append_bytes(batch_report *report, const char *bytes, size_t size) {
    size_t done = 0;
    errno = 0;
    while (done < size) {
        const ssize_t count = write(report->file, bytes + done, size - done);
        if (count < 0 && errno != EINTR)
            break;
        done += count > 0 ? (size_t)count : 0;
    }
    if (done == size)
        return true;
    const int error = errno;
    if (report->is_regular && !system_set_size(report->file, report->size))
        report_warning(report->name, "ends with a cut line, which the next run removes");
    return report_error(report->name, "cannot be written: %s", system_error_text(error));
}

bool batch_report_write(batch_report *report, const picture_line *line) {
    size_t size = 0;
    uint64_t state = STATE_IN_USE | STATE_THIS_RUN | line->status;
    if (report->file >= 0) {
        char *text = make_line(line, &size);
        const bool ok = text ? append_bytes(report, text, size)
                             : report_error(report->name, "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
        free(text);
        if (!ok)
            return false;
        if (report->is_regular)
            state += (report->size + 1) * STATE_LINE;
        report->size += size;
    }
    return index_line(report, &line->id, state);
}

/* ---- The end of a run -------------------------------------------------------------------------- */

/* Copies the last line of each picture. */
static bool copy_last_lines(batch_report *report, FILE *stream, char *line, output_file *copy) {
    name_entry entry;
    picture_id id;
    picture_status status;
    for (uint64_t at = 0; fgets(line, (int)LINE_SIZE, stream); at += strlen(line)) {
        if (!parse_line(line, &id, &status))
            return report_error(report->name, "has been changed by another program");
        if (!name_index_get(&report->index, id.key, &entry))
            return report_index_error();
        if (entry.state / STATE_LINE == at + 1)
            output_write(copy, line, strlen(line));
    }
    return !ferror(stream) || report_error(report->name, "cannot be read: %s", system_error_text(errno));
}

/* Replaces the report by one without old lines. */
static bool remove_old_lines(batch_report *report) {
    output_file copy;
    FILE *stream = open_lines(report);
    char *line = stream ? malloc(LINE_SIZE) : NULL;
    bool ok = line && output_open_text(&copy, report->name);
    if (ok) {
        ok = copy_last_lines(report, stream, line, &copy) && output_store(&copy) && output_commit(&copy);
        output_discard(&copy);
    }
    free(line);
    if (stream)
        fclose(stream);
    return ok;
}

bool batch_report_close(batch_report *report) {
    bool ok = !report->has_old_lines || remove_old_lines(report);
    name_index_free(&report->index);
    if (report->is_regular && !system_store(report->file))
        ok = report_error(report->name, "cannot be written: %s", system_error_text(errno));
    if (report->file >= 0 && close(report->file) != 0)
        ok = report_error(report->name, "cannot be written: %s", system_error_text(errno));
    report->file = -1;
    return ok;
}
