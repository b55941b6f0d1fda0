#include "cli/progress.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "cli/interrupt.h"
#include "host/system/files.h"

#define REDRAW_SECONDS 0.1
#define LABEL_WIDTH 28
#define DECODE_DELAY 1.0 /* seconds: most decodes are shorter */

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* guards the terminal line */
static const progress_line *shown;                       /* line on the terminal; NULL: none */

void progress_start(progress_line *line, const char *label, bool quiet) {
    const char *slash = strrchr(label, '/');
    *line = (progress_line){.label = slash ? slash + 1 : label, .visible = !quiet && system_is_terminal(STDERR_FILENO)};
}

static void print_progress(const progress_line *line, const gscl_progress *progress) {
    fprintf(stderr, "\r\033[K%.*s  %3.0f %%", LABEL_WIDTH, line->label, 100.0 * progress->fraction);
    if (progress->psnr > 0.0)
        fprintf(stderr, "  %.2f dB", progress->psnr);
    fprintf(stderr, "  %u splats", progress->splats);
    if (isfinite(progress->remaining_s))
        fprintf(stderr, "  %.1f s left", progress->remaining_s);
    fflush(stderr);
}

/* The first of several lines occupies the terminal until it is finished. */
static void show_line(progress_line *line, const gscl_progress *progress) {
    pthread_mutex_lock(&lock);
    if (!shown)
        shown = line;
    if (shown == line && progress->elapsed_s >= line->delay &&
        (!line->drawn || progress->elapsed_s >= line->drawn_at + REDRAW_SECONDS)) {
        print_progress(line, progress);
        line->drawn = true;
        line->drawn_at = progress->elapsed_s;
    }
    pthread_mutex_unlock(&lock);
}

bool progress_update(void *opaque, const gscl_progress *progress) {
    progress_line *line = opaque;
    if (line->visible)
        show_line(line, progress);
    return interrupt_pending() == 0;
}

void progress_finish(progress_line *line) {
    pthread_mutex_lock(&lock);
    if (line->drawn)
        fputs("\r\033[K", stderr);
    line->drawn = false;
    if (shown == line)
        shown = NULL;
    pthread_mutex_unlock(&lock);
}

gscl_result progress_decode(gscl_context *context, const char *label, const uint8_t *bytes, size_t size,
                            gscl_decode_settings *settings, gscl_image *image) {
    progress_line line;
    progress_start(&line, label, false);
    line.delay = DECODE_DELAY;
    settings->progress = progress_update;
    settings->progress_opaque = &line;
    interrupt_set_deferring(true);
    gscl_result result = gscl_decode(context, bytes, size, settings, image);
    interrupt_set_deferring(false);
    progress_finish(&line);
    settings->progress = NULL;
    settings->progress_opaque = NULL;
    /* The library does not see a signal that comes after its last check. */
    if (result == GSCL_OK && interrupt_pending()) {
        gscl_free(image->pixels);
        image->pixels = NULL;
        result = GSCL_ERROR_CANCELLED;
    }
    return result;
}
