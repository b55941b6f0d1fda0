#include "host/system/crash_guard.h"

/* A crash ends the program, and a later run meets the image again. */
void crash_guard_begin(const char *label, const crash_line *line) {
    (void)label, (void)line;
}

void crash_guard_end(void) {
}
