#define _POSIX_C_SOURCE 200112L
#include "opencl/library.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>

#include "host/system/library.h"

gscl_cl_functions gscl_cl;

static char absence[128]; /* why there is no library, or "" */

/* The process itself comes first: its program may be linked with the library, and tools that look at calls of OpenCL, such as
 * Oclgrind, are loaded before the program. */
static void *open_library(void) {
    void *function, *process = gscl_library_of_process();
    if (process && gscl_library_find(process, "clGetPlatformIDs", &function))
        return process;
    return gscl_library_open(OPENCL_LIBRARY, absence, sizeof absence);
}

static void find_function(void *opened, const char *name, void *address) {
    if (!absence[0] && !gscl_library_find(opened, name, address))
        snprintf(absence, sizeof absence, OPENCL_LIBRARY " has no function %s", name);
}

/* It stays open: drivers do not stand to be closed. */
static void find_functions(void) {
    void *opened = open_library();
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
