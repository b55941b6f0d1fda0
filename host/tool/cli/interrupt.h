/* Ctrl-C and friends: what a signal does while gscl works. */
#ifndef GSCL_TOOL_INTERRUPT_H
#define GSCL_TOOL_INTERRUPT_H

#include <stdbool.h>

/* From here on SIGINT, SIGTERM, SIGHUP and SIGPIPE remove the guarded files and end the program with 128 + signal;
 * a file that grows beyond the process's limit is an error of the write.  To be called before any other thread
 * starts. */
void interrupt_install(void);

/* Makes and opens a temporary file as mkstemp() does, which a signal removes from then on: up to 16 at a time. */
int interrupt_make_guarded(char *pattern);

/* The file is finished, or gone: it is guarded no more. */
void interrupt_release_guarded(const char *path);

/* While patient, the first signal is only noted, for a long computation to see and wind up by itself;
 * a second one ends the program at once. */
void interrupt_set_patient(bool patient);

/* The signal noted so far, or 0. */
int interrupt_pending(void);

#endif
