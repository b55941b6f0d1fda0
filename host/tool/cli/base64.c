#include "cli/base64.h"

#include <stdlib.h>
#include <string.h>

static const char ALPHABET[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

char *base64_line(const uint8_t *bytes, size_t size, size_t *length) {
    char *line = malloc(size / 3 * 4 + 6);
    size_t used = 0;
    unsigned bits = 0, buffer = 0;
    if (!line)
        return NULL;
    for (size_t i = 0; i < size; i++) {
        buffer = (buffer << 8 | bytes[i]) & 0xFFFF;
        for (bits += 8; bits >= 6; bits -= 6)
            line[used++] = ALPHABET[buffer >> (bits - 6) & 63];
    }
    if (bits > 0)
        line[used++] = ALPHABET[buffer << (6 - bits) & 63];
    line[used++] = '\n';
    *length = used;
    return line;
}

/* The bits of a character of either alphabet; -1 for others. */
static int value_of(uint8_t character) {
    const char *symbol = character ? strchr(ALPHABET, character) : NULL;
    return character == '+' ? 62 : character == '/' ? 63 : symbol ? (int)(symbol - ALPHABET) : -1;
}

static bool is_white(uint8_t character) {
    return character == ' ' || (character >= '\t' && character <= '\r');
}

const char *base64_decode(uint8_t *text, size_t *size) {
    size_t end = *size, used = 0;
    unsigned bits = 0, buffer = 0;
    while (end > 0 && (is_white(text[end - 1]) || text[end - 1] == '='))
        end--;
    for (size_t i = 0; i < end; i++) {
        const int value = value_of(text[i]);
        if (is_white(text[i]))
            continue;
        if (value < 0)
            return "has a character that does not occur in base64 (A-Z a-z 0-9 and - _ or + /)";
        buffer = (buffer << 6 | (unsigned)value) & 0xFFF;
        bits += 6;
        if (bits < 8)
            continue;
        bits -= 8;
        text[used++] = (uint8_t)(buffer >> bits);
    }
    if (bits == 6 || (buffer & ((1u << bits) - 1)) != 0)
        return "ends within a byte: a character of its base64 is missing or wrong";
    *size = used;
    return NULL;
}
