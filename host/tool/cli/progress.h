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
    double delay;    /* elapsed seconds of the first update; 0: at once */
} progress_line;

/* Starts a line, which stays invisible when standard error is not a terminal or `quiet` is set. */
void progress_start(progress_line *line, const char *label, bool quiet);

/* A gscl_progress_callback whose opaque pointer is a progress_line.  Updates the line, and cancels the computation after
 * a signal. */
bool progress_update(void *line, const gscl_progress *progress);

/* gscl_decode with a progress line, which appears after a second, and an end after a signal.  Sets the callback of the
 * settings. */
gscl_result progress_decode(gscl_context *context, const char *label, const uint8_t *bytes, size_t size,
                            gscl_decode_settings *settings, gscl_image *image);

/* Erases the line. */
void progress_finish(progress_line *line);

#endif
