/* What has become of each picture of a batch: a file with a line of JSON for each one, and an index of the pictures.
 *
 * A line is written when the output of its picture is in place, with one call of the system, so that a killed process
 * leaves whole lines and at most one cut line at the end, which the next run removes.  A picture that is encoded again gets
 * another line; its old one is removed when the run ends. */
#ifndef GSCL_TOOL_BATCH_REPORT_H
#define GSCL_TOOL_BATCH_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>

#include "commands/name_index.h"

/* Values of "code" beside those of gscl_result. */
#define PICTURE_NAME 100   /* no output has been found for the name */
#define PICTURE_INPUT 101  /* the input cannot be read as an image */
#define PICTURE_OUTPUT 102 /* the output cannot be written */
#define PICTURE_TAKEN 103  /* another input has the same output */
#define PICTURE_CRASH 104  /* the library that reads the input has crashed */

/* Which picture a line is about: hashes of the names of its output and input. */
typedef struct picture_id {
    uint64_t key[2], input;
} picture_id;

typedef enum picture_status { PICTURE_OK = 1, PICTURE_SKIPPED, PICTURE_FAILED, PICTURE_CRASHED } picture_status;

/* What is known of a picture. */
typedef enum picture_state {
    PICTURE_IS_NEW,
    PICTURE_WAS_OK,       /* encoded or skipped in an earlier run, by the report */
    PICTURE_HAD_FAILED,   /* in an earlier run, by the report */
    PICTURE_HAD_CRASHED,  /* likewise */
    PICTURE_IS_DONE,      /* in this run, or is being encoded */
    PICTURE_OUTPUT_TAKEN, /* by another input, in this run or by the report */
    PICTURE_ERROR         /* the index cannot be read; has been reported */
} picture_state;

typedef struct picture_line {
    picture_id id;
    picture_status status;
    const char *input, *output; /* output is NULL where there is none */
    int code;                   /* a gscl_result or PICTURE_... */
    const char *message;        /* of the error */
    uint64_t bytes;             /* of the output; 0: none */
    const gscl_image *image;    /* these are NULL where they are not known */
    const gscl_encode_report *encode;
    const char *device;
} picture_line;

typedef struct batch_report {
    const char *name; /* NULL: no file */
    int file;
    bool is_regular;    /* it is read and continued; else lines are only written */
    bool has_old_lines; /* of pictures that have newer ones */
    uint64_t size;      /* bytes of whole lines */
    name_index index;
} batch_report;

/* The id of a picture; output is NULL where it has none. */
picture_id picture_identify(const char *input, const char *output);

/* Opens the report, or with "-" standard output, and reads what earlier runs wrote.  A file that is something else is not
 * touched.  Without a name there is the index only.  Reports errors and returns the exit code of the program; the caller
 * closes in either case. */
int batch_report_open(batch_report *report, const char *name);

picture_state batch_report_find(const batch_report *report, const picture_id *id);

/* Marks a picture as one of this run.  These report errors. */
bool batch_report_claim(batch_report *report, const picture_id *id);
/* Marks it and writes its line. */
bool batch_report_write(batch_report *report, const picture_line *line);

/* The line of a picture that crashes while it is read, to be released with free; NULL when out of memory. */
char *batch_report_crash_line(const picture_id *id, const char *input, const char *output, size_t *size);

/* Removes old lines, and closes. */
bool batch_report_close(batch_report *report);

#endif
