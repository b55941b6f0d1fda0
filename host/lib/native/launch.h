/* Kernels and their launches: these functions of gscl_backend.  A launch has ended when it returns. */
#ifndef GSCL_LIB_NATIVE_LAUNCH_H
#define GSCL_LIB_NATIVE_LAUNCH_H

#include "runtime/backend.h"

gscl_result gscl_native_kernel_find(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                                    const char *name, gscl_kernel **kernel);
gscl_result gscl_native_launch(gscl_context *context, const gscl_launch *launch);
void gscl_native_kernels_free(gscl_context *context);

/* For tests: launches use all threads, however short they are. */
extern bool gscl_native_all_threads;

#endif
