/* Text in arrays of fixed size: text that does not fit is detected or shortened. */
#ifndef GSCL_LIB_TEXT_H
#define GSCL_LIB_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "host/system/printf_format.h"

/* A text that is appended to; always ends with a NUL. */
typedef struct gscl_text {
    char *bytes;
    size_t capacity; /* bytes, the NUL included; at least 1 */
    size_t length;   /* without the NUL */
    bool overflow;   /* something that did not fit was left out */
} gscl_text;

/* An empty text in `bytes`. */
gscl_text gscl_text_begin(char *bytes, size_t capacity);

/* Appends printf-style.  Text that does not fit as a whole is not appended, nor is any after it. */
GSCL_PRINTF(2, 3)
void gscl_text_append(gscl_text *text, const char *format, ...);

/* Copies `from`, and where it is too long its beginning and "...", in UTF-8 cut between characters.  `capacity` counts
 * the NUL; at least 4. */
void gscl_text_shorten(char *to, size_t capacity, const char *from);

#endif
