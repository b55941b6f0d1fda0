/* Messages on standard error.  Every message is one line, whatever file names and library texts contain. */
#ifndef GSCL_TOOL_MESSAGE_H
#define GSCL_TOOL_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>

#include "host/system/printf_format.h"

/* Prints "gscl: SUBJECT: text".  The subject is a file or a command.  Returns false, as the result of the caller. */
bool report_error(const char *subject, const char *format, ...) GSCL_PRINTF(2, 3);

/* Prints the same for a wrong command line.  Returns EXIT_USAGE. */
int report_usage(const char *command, const char *format, ...) GSCL_PRINTF(2, 3);

/* Copies the text of the next error that is printed, without program and subject, while `text` is empty; NULL ends this.
 * For a program whose errors come from one thread. */
void message_keep_errors(char *text, size_t size);

/* Prints "gscl: SUBJECT: warning: text". */
void report_warning(const char *subject, const char *format, ...) GSCL_PRINTF(2, 3);

/* Prints a line of information without prefix. */
void report_note(const char *format, ...) GSCL_PRINTF(1, 2);

/* Closes standard output and reports a failure, for example a full disk.  Returns `status`, or EXIT_FAILURE when `status`
 * is EXIT_SUCCESS and the output failed. */
int finish_stdout(int status);

#endif
