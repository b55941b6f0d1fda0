/* Ctrl-C and friends: what a signal does while gscl works. */
#ifndef GSCL_TOOL_INTERRUPT_H
#define GSCL_TOOL_INTERRUPT_H

#include <stdbool.h>

/* From here on SIGINT, SIGTERM, SIGHUP and SIGPIPE remove the guarded file and end the program with
 * 128 + signal; a file that grows beyond the process's limit is an error of the write. */
void interrupt_install(void);

/* The unfinished file that a signal removes; NULL: none (any more).  The text is copied. */
void interrupt_guard(const char *path);

/* While patient, the first signal is only noted, for a long computation to see and wind up by itself;
 * a second one (and SIGPIPE) ends the program at once. */
void interrupt_set_patient(bool patient);

/* The signal noted so far, or 0. */
int interrupt_pending(void);

#endif
