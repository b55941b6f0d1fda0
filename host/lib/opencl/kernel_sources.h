/* The kernels of cl/, embedded at build time by cl/embed.py. */
#ifndef GSCL_LIB_KERNEL_SOURCES_H
#define GSCL_LIB_KERNEL_SOURCES_H

#include <stddef.h>

#include "runtime/kernel_options.h"

#define GSCL_MAX_PROGRAM_FILES 20

struct gscl_kernel_source {
    const char *name; /* of the file in cl/, such as "raster.cl" */
    const char *text; /* OpenCL C, ends with a NUL; begins with a #line directive that names the file */
    size_t length;    /* without the NUL */
};

extern const struct gscl_kernel_source gscl_kernel_sources[];
extern const size_t gscl_kernel_source_count;

/* The names of the source files of each kind of program (cl/programs.py), in the order in which the compiler reads them; a NULL
 * ends each list. */
extern const char *const gscl_program_files[GSCL_PROGRAM_KINDS][GSCL_MAX_PROGRAM_FILES + 1];

#endif
