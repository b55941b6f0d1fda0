/* The folder in which PoCL keeps built kernels, as the environment names it.  Without a folder that it can write to, PoCL
 * either offers no device or fails to build kernels, and does not say why. */
#ifndef GSCL_TOOL_POCL_CACHE_H
#define GSCL_TOOL_POCL_CACHE_H

#include <stdbool.h>

#define POCL_CACHE_MAX_PATH 1024 /* bytes, the NUL included */

/* Whether the folder exists. */
bool pocl_cache_exists(void);

/* Returns 0 when PoCL can write to its folder, and when its name is too long to tell.  Otherwise returns the errno of a
 * trial and the folder's name. */
int pocl_cache_error(char folder[POCL_CACHE_MAX_PATH]);

/* Prints about `subject` that PoCL cannot write to its folder, and returns true; returns false where it can. */
bool pocl_cache_report(const char *subject);

#endif
