/* Signals: removal of unfinished files, and an orderly end of long computations. */
#ifndef GSCL_TOOL_INTERRUPT_H
#define GSCL_TOOL_INTERRUPT_H

#include <stdbool.h>

/* After this call the signals of host/system/signals.h remove the guarded files and end the program with EXIT_SIGNAL plus the
 * signal.  Must be called before any other thread starts. */
void interrupt_install(void);

/* Sets what a signal does besides, before it ends the program; SIGPIPE does not. */
void interrupt_set_cleanup(void (*cleanup)(void));

/* Makes and opens a temporary file with `make`, which may change its name, and returns the descriptor, or -1.  A signal removes the
 * file from then on.  At most 256 at a time. */
#define MAX_GUARDED_FILES 256
int interrupt_make_guarded(char *pattern, int (*make)(char *pattern));

/* Ends the guard of a file that is finished or removed. */
void interrupt_release_guarded(const char *path);

/* While deferring, the first signal is only recorded, and the running computation polls interrupt_pending() and stops;
 * a second signal ends the program at once. */
void interrupt_set_deferring(bool deferring);

/* The recorded signal, or 0. */
int interrupt_pending(void);

#endif
