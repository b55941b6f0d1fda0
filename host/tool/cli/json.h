/* A small JSON writer: one member per line, indented, or all on one line. */
#ifndef GSCL_TOOL_JSON_H
#define GSCL_TOOL_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct json_writer {
    FILE *stream;
    int depth;
    bool has_member; /* of the innermost open object or array */
    bool is_line;    /* no line breaks and blanks between members */
} json_writer;

void json_start(json_writer *json, FILE *stream);
/* The same on one line, which ends with the outermost value. */
void json_start_line(json_writer *json, FILE *stream);

/* In all of these, `key` is NULL for an element of an array and for the outermost value. */
void json_open_object(json_writer *json, const char *key);
void json_close_object(json_writer *json);
void json_open_array(json_writer *json, const char *key);
void json_close_array(json_writer *json);
/* Replaces bytes that are not UTF-8, so that the output stays valid for any file name. */
void json_string(json_writer *json, const char *key, const char *value);
void json_integer(json_writer *json, const char *key, uint64_t value);
/* Writes null for NaN and infinity, which JSON lacks. */
void json_real(json_writer *json, const char *key, double value);
void json_bool(json_writer *json, const char *key, bool value);
void json_null(json_writer *json, const char *key);

#endif
