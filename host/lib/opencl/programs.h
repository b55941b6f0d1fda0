/* Programs and their kernels.  A program is built when it is first needed, one for each combination of source files and
 * build options, and kept in the context. */
#ifndef GSCL_LIB_PROGRAMS_H
#define GSCL_LIB_PROGRAMS_H

#include "runtime/backend.h"

gscl_result gscl_opencl_kernel_find(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                                    const char *name, gscl_kernel **kernel);

/* Frees all programs of a context. */
void gscl_programs_free(gscl_context *context);

#endif
