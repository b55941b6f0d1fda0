#include "cli/read_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/message.h"
#include "host/system/files.h"

#define FIRST_CAPACITY ((size_t)64 << 10)

const char *input_label(const char *name) {
    return strcmp(name, "-") ? name : "standard input";
}

static FILE *open_file(const char *name) {
    FILE *stream = system_open_stream(name);
    if (!stream)
        report_error(name, "cannot be opened: %s", system_error_text(errno));
    return stream;
}

/* Doubles the buffer up to one byte more than the limit, so that a larger file is detected. */
static bool grow_buffer(uint8_t **bytes, size_t *capacity, uint64_t limit) {
    const uint64_t doubled = *capacity ? 2 * (uint64_t)*capacity : FIRST_CAPACITY;
    const size_t larger = (size_t)(doubled > limit ? limit + 1 : doubled);
    uint8_t *moved = realloc(*bytes, larger);
    if (!moved)
        return false;
    *bytes = moved;
    *capacity = larger;
    return true;
}

static bool report_unreadable(const char *label, int error) {
    return error == EISDIR ? report_error(label, "is a folder; name its files, as %s/*", label)
                           : report_error(label, "cannot be read: %s", system_error_text(error));
}

static bool read_stream(FILE *stream, const char *label, uint64_t limit, uint8_t **bytes, size_t *size) {
    size_t capacity = 0;
    do {
        if (*size == capacity && !grow_buffer(bytes, &capacity, limit))
            return report_error(label, "is too large for the available memory");
        *size += fread(*bytes + *size, 1, capacity - *size, stream);
        if (*size > limit)
            return report_error(label, "is larger than %llu MiB, the limit for this kind of file",
                                (unsigned long long)(limit >> 20));
        if (ferror(stream))
            return report_unreadable(label, errno);
    } while (!feof(stream));
    return true;
}

bool read_file(const char *name, uint64_t limit, uint8_t **bytes, size_t *size) {
    uint8_t *buffer = NULL;
    size_t used = 0;
    const bool is_file = strcmp(name, "-") != 0;
    FILE *stream = is_file ? open_file(name) : stdin;
    const bool ok = stream && read_stream(stream, input_label(name), limit, &buffer, &used);
    if (is_file && stream)
        fclose(stream);
    if (!ok) {
        free(buffer);
        return false;
    }
    *bytes = buffer;
    *size = used;
    return true;
}

bool read_file_start(const char *name, uint8_t *bytes, size_t capacity, size_t *count) {
    FILE *stream = open_file(name);
    if (!stream)
        return false;
    *count = fread(bytes, 1, capacity, stream);
    const int error = ferror(stream) ? errno : 0;
    fclose(stream);
    return error == 0 || report_unreadable(name, error);
}
