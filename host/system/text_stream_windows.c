#include "host/system/text_stream.h"

#include <io.h>
#include <stdlib.h>

#include "host/system/files.h"

/* Through a temporary file. */
bool text_stream_open(text_stream *stream) {
    *stream = (text_stream){0};
    const int file = system_make_scratch();
    stream->stream = file >= 0 ? _fdopen(file, "w+b") : NULL;
    if (file >= 0 && !stream->stream)
        _close(file);
    return stream->stream != NULL;
}

bool text_stream_close(text_stream *stream, char **text, size_t *size) {
    const long end = fflush(stream->stream) == 0 && !ferror(stream->stream) ? ftell(stream->stream) : -1;
    char *bytes = end >= 0 ? malloc((size_t)end + 1) : NULL;
    rewind(stream->stream);
    if (bytes && fread(bytes, 1, (size_t)end, stream->stream) != (size_t)end) {
        free(bytes);
        bytes = NULL;
    }
    fclose(stream->stream);
    if (!bytes)
        return false;
    bytes[end] = '\0';
    *text = bytes;
    *size = (size_t)end;
    return true;
}
