/* Effects as the value of a command-line option. */
#ifndef GSCL_TOOL_EFFECT_LIST_H
#define GSCL_TOOL_EFFECT_LIST_H

#include <stdbool.h>
#include <stdint.h>

/* Reads "+opacity,-chroma" into sets of gscl_effect.  Returns false after reporting an error. */
bool effect_list_parse(const char *text, uint32_t *on, uint32_t *off);

#endif
