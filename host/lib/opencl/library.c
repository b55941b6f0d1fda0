#define _POSIX_C_SOURCE 200112L
#include "opencl/library.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

gscl_cl_functions gscl_cl;

static char absence[128]; /* why there is no library, or "" */

#ifdef _WIN32
#include <windows.h>

#define LIBRARY "OpenCL.dll"

typedef HMODULE library;

static library library_open(void) {
    const library opened = LoadLibraryExA(LIBRARY, NULL, LOAD_LIBRARY_SEARCH_SYSTEM32);
    if (!opened)
        snprintf(absence, sizeof absence, LIBRARY " cannot be loaded: error %lu", (unsigned long)GetLastError());
    return opened;
}

static bool library_find(library opened, const char *name, void *address) {
    const FARPROC found = GetProcAddress(opened, name);
    memcpy(address, &found, sizeof found);
    return found != NULL;
}
#else
#include <dlfcn.h>

#define LIBRARY "libOpenCL.so.1"

typedef void *library;

/* The process itself comes first: its program may be linked with the library, and tools that look at calls of OpenCL, such as
 * Oclgrind, are loaded before the program. */
static library library_open(void) {
    void *process = dlopen(NULL, RTLD_LAZY);
    if (process && dlsym(process, "clGetPlatformIDs"))
        return process;
    void *opened = dlopen(LIBRARY, RTLD_LAZY | RTLD_LOCAL);
    if (!opened)
        snprintf(absence, sizeof absence, "%s", dlerror());
    return opened;
}

static bool library_find(library opened, const char *name, void *address) {
    void *found = dlsym(opened, name);
    memcpy(address, &found, sizeof found);
    return found != NULL;
}
#endif

static void find_function(library opened, const char *name, void *address) {
    if (!absence[0] && !library_find(opened, name, address))
        snprintf(absence, sizeof absence, LIBRARY " has no function %s", name);
}

/* It stays open: drivers do not stand to be closed. */
static void find_functions(void) {
    const library opened = library_open();
    if (!opened)
        return;
#define FIND(function) find_function(opened, #function, &gscl_cl.function);
    GSCL_CL_FUNCTIONS(FIND)
#undef FIND
}

const char *gscl_opencl_library(void) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, find_functions);
    return absence[0] ? absence : NULL;
}
