/* Opening and closing an OpenCL device: these functions of gscl_backend. */
#ifndef GSCL_LIB_OPENCL_OPEN_H
#define GSCL_LIB_OPENCL_OPEN_H

#include "runtime/backend.h"

gscl_result gscl_opencl_open(gscl_context *context, const gscl_listed_device *listed,
                             const gscl_context_settings *settings);
void gscl_opencl_close(gscl_context *context);
bool gscl_opencl_has_double(gscl_context *context);

#endif
