/* Shared libraries that are opened at run time. */
#ifndef GSCL_SYSTEM_LIBRARY_H
#define GSCL_SYSTEM_LIBRARY_H

#include <stdbool.h>
#include <stddef.h>

/* Opens a library and does not close it.  A name without a slash is looked for where the system looks, and on Windows beside the
 * program, too.  NULL on failure, with the reason in `why` (bytes of size). */
void *gscl_library_open(const char *name, char *why, size_t size);

/* The process itself as a library, whose functions may come from libraries that were loaded before it; NULL: none. */
void *gscl_library_of_process(void);

/* Sets the pointer at `address` to a symbol of a library.  Returns false, and sets NULL, when it has none of this name. */
bool gscl_library_find(void *library, const char *name, void *address);

#endif
