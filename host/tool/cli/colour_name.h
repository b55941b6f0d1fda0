/* Colours as people write them. */
#ifndef GSCL_TOOL_COLOUR_NAME_H
#define GSCL_TOOL_COLOUR_NAME_H

#include <stdbool.h>
#include <stdint.h>

/* Reads #rgb, #rrggbb, either without #, which shells take for the start of a comment, or a colour name of CSS, in capital
 * letters or small ones.  Returns false for other text. */
bool colour_parse(const char *text, uint8_t rgb[3]);

#endif
