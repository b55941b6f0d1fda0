/* A stream into memory. */
#ifndef GSCL_SYSTEM_TEXT_STREAM_H
#define GSCL_SYSTEM_TEXT_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct text_stream {
    FILE *stream;
    char *text; /* of text_stream_close */
    size_t size;
} text_stream;

/* Opens stream->stream.  Returns false on failure. */
bool text_stream_open(text_stream *stream);

/* Closes it.  *text, with a NUL behind its bytes, is to be released with free.  Returns false, without a text, when a write has
 * failed. */
bool text_stream_close(text_stream *stream, char **text, size_t *size);

#endif
