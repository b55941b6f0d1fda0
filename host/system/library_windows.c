#include "host/system/library.h"

#include <stdio.h>
#include <string.h>
#include <windows.h>

/* Not from the current folder, which may be anybody's. */
void *gscl_library_open(const char *name, char *why, size_t size) {
    const HMODULE opened =
        LoadLibraryExA(name, NULL, LOAD_LIBRARY_SEARCH_APPLICATION_DIR | LOAD_LIBRARY_SEARCH_SYSTEM32);
    if (!opened)
        snprintf(why, size, "%s cannot be loaded: error %lu", name, (unsigned long)GetLastError());
    return (void *)opened;
}

void *gscl_library_of_process(void) {
    return NULL;
}

bool gscl_library_find(void *library, const char *name, void *address) {
    const FARPROC found = GetProcAddress((HMODULE)library, name);
    memcpy(address, &found, sizeof found);
    return found != NULL;
}
