/* Programs and their kernels.  A program is built when it is first needed, one for each combination of source files and
 * build options, and kept in the context. */
#ifndef GSCL_LIB_PROGRAMS_H
#define GSCL_LIB_PROGRAMS_H

#include <CL/cl.h>

#include "runtime/context.h"
#include "runtime/kernel_options.h"

/* Looks a kernel up and, when it is the first kernel of its program, builds the program.  The context owns the kernel.
 * `name` must outlive the context.  Kernels keep their arguments, so that a context serves one thread only. */
gscl_result gscl_kernel(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                        const char *name, cl_kernel *kernel);

/* Frees all programs of a context. */
void gscl_programs_free(gscl_context *context);

#endif
