/* Base64url without padding (RFC 4648, section 5): bytes as text that needs no escaping in URLs and file names. */
#ifndef GSCL_TOOL_BASE64_H
#define GSCL_TOOL_BASE64_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Returns one line of text with a newline at its end, *length characters, to be released with free; NULL when out of
 * memory. */
char *base64_line(const uint8_t *bytes, size_t size, size_t *length);

/* Decodes text in its own memory; *size is the number of bytes afterwards.  It may have + and / in place of - and _, as
 * other programs write them, white space anywhere and padding (=) at the end.  Returns NULL, or what is wrong with the text, which is then lost. */
const char *base64_decode(uint8_t *text, size_t *size);

#endif
