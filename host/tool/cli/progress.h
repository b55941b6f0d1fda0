/* The progress line of a long computation, on a terminal only.  Of several at a time one is shown. */
#ifndef GSCL_TOOL_PROGRESS_H
#define GSCL_TOOL_PROGRESS_H

#include <stdbool.h>

#include <gscl/gscl.h>

typedef struct progress_line {
    const char *label; /* what is being worked on */
    bool visible;
    bool drawn;      /* something stands on the line now */
    double drawn_at; /* elapsed seconds then */
} progress_line;

/* Shows nothing when stderr is not a terminal or `quiet`. */
void progress_start(progress_line *line, const char *label, bool quiet);

/* A gscl_progress_callback with a progress_line behind it: draws the line, and cancels the computation
 * after a signal. */
bool progress_update(void *line, const gscl_progress *progress);

/* Erases the line. */
void progress_finish(progress_line *line);

#endif
