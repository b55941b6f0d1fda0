/* The folder in which PoCL keeps built kernels, as the environment names it.  Without a folder that it can write to, PoCL
 * either offers no device or fails to build kernels, and does not say why. */
#ifndef GSCL_TOOL_POCL_CACHE_H
#define GSCL_TOOL_POCL_CACHE_H

#include <stdbool.h>
#include <stddef.h>

/* Whether the folder exists. */
bool pocl_cache_exists(void);

/* Where PoCL cannot write to its folder, and the variable POCL_CACHE_DIR does not name it, makes one in $TMPDIR or /tmp, which goes
 * when the program ends, and says so on standard error, unless `quiet`.  Must be called before PoCL is loaded. */
void pocl_cache_prepare(bool quiet);

/* Writes that PoCL cannot write to its folder, and returns true; returns false where it can, and where it does not seem to be
 * installed. */
bool pocl_cache_explain(char *text, size_t size);

#endif
