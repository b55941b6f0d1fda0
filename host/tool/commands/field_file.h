/* Files of splats, as 'gscl export' and other programs write them: CSV, PLY as text or binary, and gscl files. */
#ifndef GSCL_TOOL_FIELD_FILE_H
#define GSCL_TOOL_FIELD_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>

/* Reads the splats of a file and, where it has them in a comment that begins with "gscl", size, blend, background and steps; the
 * other fields keep their values.  field->splats is released with gscl_free.  Reports errors. */
bool field_read(const char *name, gscl_field *field);
/* The same from memory; `label` names the file in messages. */
bool field_parse(const char *label, const uint8_t *bytes, size_t size, gscl_field *field);

/* Sets background from "0.5,0.5,0.5" or "0.5,0.5,0.5,1"; one number is grey.  Returns false where the text is neither. */
bool field_parse_background(const char *text, float background[4]);

#endif
