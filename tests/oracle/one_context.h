/* A context for all tests of a program, on the default device. */
#ifndef GSCL_ONE_CONTEXT_H
#define GSCL_ONE_CONTEXT_H

#include <gscl/gscl.h>

static gscl_context *context;

static int open_context(void **state) {
    (void)state;
    return gscl_context_create(&context, NULL) == GSCL_OK ? 0 : -1;
}

static int close_context(void **state) {
    (void)state;
    gscl_context_free(&context);
    return context ? -1 : 0;
}

#endif
