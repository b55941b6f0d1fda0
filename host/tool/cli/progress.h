/* The progress line of a long computation, on a terminal only.  Of several computations one is shown at a time. */
#ifndef GSCL_TOOL_PROGRESS_H
#define GSCL_TOOL_PROGRESS_H

#include <stdbool.h>

#include <gscl/gscl.h>

typedef struct progress_line {
    const char *label; /* name of the computation */
    bool visible;
    bool drawn;      /* the line is on the terminal */
    double drawn_at; /* elapsed seconds of the last update */
} progress_line;

/* Starts a line, which stays invisible when standard error is not a terminal or `quiet` is set. */
void progress_start(progress_line *line, const char *label, bool quiet);

/* A gscl_progress_callback whose opaque pointer is a progress_line.  Updates the line, and cancels the computation after
 * a signal. */
bool progress_update(void *line, const gscl_progress *progress);

/* Erases the line. */
void progress_finish(progress_line *line);

#endif
