#define _POSIX_C_SOURCE 200112L
#include "host/system/library.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

void *gscl_library_open(const char *name, char *why, size_t size) {
    void *opened = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
    if (!opened)
        snprintf(why, size, "%s", dlerror());
    return opened;
}

void *gscl_library_of_process(void) {
    return dlopen(NULL, RTLD_LAZY);
}

bool gscl_library_find(void *library, const char *name, void *address) {
    void *found = dlsym(library, name);
    memcpy(address, &found, sizeof found);
    return found != NULL;
}
