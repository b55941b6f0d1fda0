/* A small JSON writer.  Members come out one per line, indented; commas are kept track of. */
#ifndef GSCL_TOOL_JSON_H
#define GSCL_TOOL_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct json_writer {
    FILE *stream;
    int depth;
    bool has_member; /* in the innermost open object or array */
} json_writer;

void json_start(json_writer *json, FILE *stream);
/* In all of these `key` is NULL for an element of an array and for the outermost value. */
void json_open_object(json_writer *json, const char *key);
void json_close_object(json_writer *json);
void json_open_array(json_writer *json, const char *key);
void json_close_array(json_writer *json);
/* Bytes that are not UTF-8 are replaced, so that the output stays valid whatever a file is called. */
void json_string(json_writer *json, const char *key, const char *value);
void json_integer(json_writer *json, const char *key, uint64_t value);
/* NaN and infinity, which JSON lacks, become null. */
void json_real(json_writer *json, const char *key, double value);
void json_bool(json_writer *json, const char *key, bool value);

#endif
