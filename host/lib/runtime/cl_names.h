/* Names of OpenCL's errors and kernels, for messages. */
#ifndef GSCL_LIB_CL_NAMES_H
#define GSCL_LIB_CL_NAMES_H

#include <CL/cl.h>

#define GSCL_MAX_KERNEL_NAME 32 /* bytes, the NUL included */

/* The name of an error code of OpenCL 1.2, "CL_..."; never NULL. */
const char *gscl_cl_error_name(cl_int error);

/* The name of a kernel's function; never empty. */
void gscl_kernel_name(cl_kernel kernel, char name[GSCL_MAX_KERNEL_NAME]);

#endif
