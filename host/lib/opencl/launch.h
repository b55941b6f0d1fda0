/* Launches, beginning them, and waiting for them: these functions of gscl_backend. */
#ifndef GSCL_LIB_OPENCL_LAUNCH_H
#define GSCL_LIB_OPENCL_LAUNCH_H

#include "runtime/backend.h"

gscl_result gscl_opencl_launch(gscl_context *context, const gscl_launch *launch);
void gscl_opencl_flush(gscl_context *context);
gscl_result gscl_opencl_finish(gscl_context *context);

#endif
