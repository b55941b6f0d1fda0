#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "host/system/text_stream.h"

#include <stdlib.h>

bool text_stream_open(text_stream *stream) {
    *stream = (text_stream){0};
    stream->stream = open_memstream(&stream->text, &stream->size);
    return stream->stream != NULL;
}

bool text_stream_close(text_stream *stream, char **text, size_t *size) {
    const bool ok = !ferror(stream->stream);
    if (fclose(stream->stream) == 0 && ok) {
        *text = stream->text;
        *size = stream->size;
        return true;
    }
    free(stream->text);
    return false;
}
