#include "cli/json.h"

#include <inttypes.h>
#include <math.h>

/* Length of the well-formed UTF-8 sequence at `text`, or 0. */
static int utf8_length(const unsigned char *text) {
    const unsigned char c = text[0];
    const int length = c < 0x80                ? 1
                       : c >= 0xC2 && c < 0xE0 ? 2
                       : c >= 0xE0 && c < 0xF0 ? 3
                       : c >= 0xF0 && c < 0xF5 ? 4
                                               : 0;
    for (int i = 1; i < length; i++) {
        if ((text[i] & 0xC0) != 0x80)
            return 0;
    }
    /* The second byte distinguishes overlong forms, surrogates and codes beyond U+10FFFF from valid ones. */
    if ((c == 0xE0 && text[1] < 0xA0) || (c == 0xED && text[1] > 0x9F) || (c == 0xF0 && text[1] < 0x90) ||
        (c == 0xF4 && text[1] > 0x8F))
        return 0;
    return length;
}

static void write_string(FILE *stream, const char *value) {
    const unsigned char *text = (const unsigned char *)value;
    fputc('"', stream);
    while (*text) {
        const int length = utf8_length(text);
        if (length == 0)
            fputs("\\ufffd", stream);
        else if (*text == '"' || *text == '\\')
            fprintf(stream, "\\%c", *text);
        else if (*text < 0x20)
            fprintf(stream, "\\u%04x", *text);
        else
            fwrite(text, 1, (size_t)length, stream);
        text += length ? length : 1;
    }
    fputc('"', stream);
}

static void new_line(json_writer *json) {
    if (!json->is_line)
        fprintf(json->stream, "\n%*s", 2 * json->depth, "");
}

/* Writes the comma after the previous value, and the key. */
static void begin_value(json_writer *json, const char *key) {
    if (json->has_member)
        fputc(',', json->stream);
    if (json->depth > 0)
        new_line(json);
    if (key) {
        write_string(json->stream, key);
        fputs(json->is_line ? ":" : ": ", json->stream);
    }
    json->has_member = true;
}

static void open_group(json_writer *json, const char *key, char bracket) {
    begin_value(json, key);
    fputc(bracket, json->stream);
    json->depth++;
    json->has_member = false;
}

static void close_group(json_writer *json, char bracket) {
    json->depth--;
    if (json->has_member)
        new_line(json);
    fputc(bracket, json->stream);
    json->has_member = true;
    if (json->depth == 0)
        fputc('\n', json->stream);
}

void json_start(json_writer *json, FILE *stream) {
    *json = (json_writer){.stream = stream};
}

void json_start_line(json_writer *json, FILE *stream) {
    *json = (json_writer){.stream = stream, .is_line = true};
}

void json_open_object(json_writer *json, const char *key) {
    open_group(json, key, '{');
}

void json_close_object(json_writer *json) {
    close_group(json, '}');
}

void json_open_array(json_writer *json, const char *key) {
    open_group(json, key, '[');
}

void json_close_array(json_writer *json) {
    close_group(json, ']');
}

void json_string(json_writer *json, const char *key, const char *value) {
    begin_value(json, key);
    write_string(json->stream, value);
}

void json_integer(json_writer *json, const char *key, uint64_t value) {
    begin_value(json, key);
    fprintf(json->stream, "%" PRIu64, value);
}

void json_real(json_writer *json, const char *key, double value) {
    begin_value(json, key);
    if (isfinite(value))
        fprintf(json->stream, "%.15g", value);
    else
        fputs("null", json->stream);
}

void json_bool(json_writer *json, const char *key, bool value) {
    begin_value(json, key);
    fputs(value ? "true" : "false", json->stream);
}

void json_null(json_writer *json, const char *key) {
    begin_value(json, key);
    fputs("null", json->stream);
}
