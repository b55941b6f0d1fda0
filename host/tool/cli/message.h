/* What gscl says on stderr.  Every message is one line, whatever file names and library texts hold. */
#ifndef GSCL_TOOL_MESSAGE_H
#define GSCL_TOOL_MESSAGE_H

#include <stdbool.h>

#if defined(__GNUC__)
#define MESSAGE_FORMAT(string, first) __attribute__((format(printf, string, first)))
#else
#define MESSAGE_FORMAT(string, first)
#endif

/* "gscl: SUBJECT: text".  The subject is a file or a command.  Returns false, so that a failing function can
 * end with it. */
bool report_error(const char *subject, const char *format, ...) MESSAGE_FORMAT(2, 3);

/* The same for a wrong command line; returns EXIT_USAGE. */
int report_usage(const char *command, const char *format, ...) MESSAGE_FORMAT(2, 3);

/* A line of information without prefix. */
void report_note(const char *format, ...) MESSAGE_FORMAT(1, 2);

/* Closes stdout and turns a failure (a full disk, say) into an error.  Returns `status`, or EXIT_FAILURE when
 * only this went wrong. */
int finish_stdout(int status);

#endif
