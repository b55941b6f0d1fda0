/* The compiler's options for a program: -D macros that its kernels are specialised by. */
#ifndef GSCL_LIB_BUILD_OPTIONS_H
#define GSCL_LIB_BUILD_OPTIONS_H

#include "runtime/context.h"
#include "runtime/kernel_options.h"

#define GSCL_MAX_BUILD_OPTIONS 384 /* bytes, the NUL included */

/* Fails with GSCL_ERROR_KERNEL_BUILD when the text would be longer. */
gscl_result gscl_build_options(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                               char text[GSCL_MAX_BUILD_OPTIONS]);

#endif
