/* Errors of OpenCL: their names, and messages. */
#ifndef GSCL_LIB_CL_ERROR_H
#define GSCL_LIB_CL_ERROR_H

#include "opencl/library.h"
#include "runtime/context.h"

/* The name of an error code of OpenCL 1.2, "CL_..."; never NULL. */
const char *gscl_cl_error_name(cl_int error);

/* Stores "FUNCTION SUBJECT on DEVICE: ERROR" as the message and returns the result that fits the error.  `subject`: the object
 * of the call, such as " of kernel bin", or "". */
gscl_result gscl_cl_fail(gscl_context *context, cl_int error, const char *function, const char *subject);

/* Calls a function of OpenCL; returns from the function when it fails. */
#define GSCL_CL(context, function, ...)                             \
    do {                                                            \
        const cl_int cl_error_ = gscl_cl.function(__VA_ARGS__);     \
        if (cl_error_ != CL_SUCCESS)                                \
            return gscl_cl_fail(context, cl_error_, #function, ""); \
    } while (0)

#endif
