#include "cli/module.h"

#include <stdio.h>

#include "host/system/library.h"

static char reason[256];

/* The name has no slash, so that the loader searches the run path of the tool. */
const void *module_load(const char *file, const char *symbol) {
    void *address = NULL, *library = gscl_library_open(file, reason, sizeof reason);
    if (library && !gscl_library_find(library, symbol, &address))
        snprintf(reason, sizeof reason, "%s has no symbol %s", file, symbol);
    return address;
}

const char *module_error(void) {
    return reason;
}
