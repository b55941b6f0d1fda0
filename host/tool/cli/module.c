#include "cli/module.h"

#include <dlfcn.h>
#include <stddef.h>

/* The name has no slash, so that the loader searches the run path of the tool. */
const void *module_load(const char *file, const char *symbol) {
    void *library = dlopen(file, RTLD_LAZY | RTLD_LOCAL);
    return library ? dlsym(library, symbol) : NULL;
}
