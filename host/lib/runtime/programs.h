/* Programs and their kernels.  A program is built when it is first needed, one for each combination of source files and
 * build options, and kept in the context. */
#ifndef GSCL_LIB_KERNELS_H
#define GSCL_LIB_KERNELS_H

#include "runtime/context.h"
#include "runtime/kernel_options.h"

/* Looks a kernel up, and builds its program when it is the first of it.  The context owns the kernel.  `name` must
 * outlive the context.  Arguments that are set on the kernel count until its next launch: one context, one thread. */
gscl_result gscl_kernel(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                        const char *name, cl_kernel *kernel);

/* Frees all programs of a context. */
void gscl_programs_free(gscl_context *context);

#endif
