#include "cli/message.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/exit_code.h"
#include "host/system/files.h"

#define MAX_LINE 2048 /* bytes; a longer message is cut */

static char *kept_error; /* of message_keep_errors; NULL: none */
static size_t kept_size;

/* Replaces line breaks and other control characters by blanks, so that a message stays on its line and a file name
 * sends no escape sequences to the terminal. */
static void make_one_line(char *text) {
    for (unsigned char *c = (unsigned char *)text; *c; c++) {
        if (*c < 0x20 || *c == 0x7F)
            *c = ' ';
    }
    size_t length = strlen(text);
    while (length > 0 && text[length - 1] == ' ')
        text[--length] = '\0';
}

/* Prints "gscl: SUBJECT: KIND" and the text; SUBJECT may be NULL, and '' stands for one that is empty.  On a
 * terminal it takes the place of a progress line, which its next update draws again. */
static void print_line(const char *subject, const char *kind, const char *format, va_list arguments) {
    char line[MAX_LINE];
    int used = 0;
    if (subject)
        used = snprintf(line, sizeof line, "gscl: %.1024s: %s", *subject ? subject : "''", kind);
    vsnprintf(line + used, sizeof line - (size_t)used, format, arguments);
    make_one_line(line);
    if (subject && !*kind && kept_error && !*kept_error)
        snprintf(kept_error, kept_size, "%s", line + used);
    fprintf(stderr, "%s%s\n", system_is_terminal(STDERR_FILENO) ? "\r\033[K" : "", line);
}

void message_keep_errors(char *text, size_t size) {
    kept_error = text;
    kept_size = size;
}

bool report_error(const char *subject, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    print_line(subject, "", format, arguments);
    va_end(arguments);
    return false;
}

int report_usage(const char *command, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    print_line(command, "", format, arguments);
    va_end(arguments);
    return EXIT_USAGE;
}

void report_warning(const char *subject, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    print_line(subject, "warning: ", format, arguments);
    va_end(arguments);
}

void report_note(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    print_line(NULL, "", format, arguments);
    va_end(arguments);
}

int finish_stdout(int status) {
    errno = 0;
    const bool failed = ferror(stdout) != 0;
    if ((fclose(stdout) == 0 && !failed) || status != EXIT_SUCCESS)
        return status;
    report_error("standard output", "cannot be written: %s",
                 errno ? system_error_text(errno) : "an earlier write failed");
    return EXIT_FAILURE;
}
