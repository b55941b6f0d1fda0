/* Reading an image of a run, whose library may crash.  The report then gets the line of that image, and the program starts
 * again with the same command line, so that the other images are encoded; a later run leaves the image out. */
#ifndef GSCL_SYSTEM_CRASH_GUARD_H
#define GSCL_SYSTEM_CRASH_GUARD_H

#include <stdbool.h>
#include <stddef.h>

typedef struct crash_line {
    int file; /* of the report; -1: none */
    char *text;
    size_t size;
    bool starts_again; /* else the program ends by its signal */
} crash_line;

/* From here on a crash of this thread is one of the image `label`; `line` stays until the end. */
void crash_guard_begin(const char *label, const crash_line *line);
void crash_guard_end(void);

#endif
