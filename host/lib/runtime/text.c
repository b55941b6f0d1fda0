#include "runtime/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char ellipsis[] = "...";

gscl_text gscl_text_begin(char *bytes, size_t capacity) {
    bytes[0] = 0;
    return (gscl_text){.bytes = bytes, .capacity = capacity};
}

void gscl_text_append(gscl_text *text, const char *format, ...) {
    if (text->overflow)
        return;
    const size_t space = text->capacity - text->length;
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(text->bytes + text->length, space, format, arguments);
    va_end(arguments);
    if (length >= 0 && (size_t)length < space) {
        text->length += (size_t)length;
        return;
    }
    text->overflow = true;
    text->bytes[text->length] = 0;
}

/* Bytes 10xxxxxx continue a character of UTF-8. */
static bool continues_character(char byte) {
    return ((unsigned char)byte & 0xC0) == 0x80;
}

void gscl_text_shorten(char *to, size_t capacity, const char *from) {
    size_t length = strlen(from);
    if (length < capacity) {
        memcpy(to, from, length + 1);
        return;
    }
    length = capacity - sizeof ellipsis;
    while (length > 0 && continues_character(from[length]))
        length--;
    memcpy(to, from, length);
    memcpy(to + length, ellipsis, sizeof ellipsis);
}
