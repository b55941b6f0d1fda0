/* OpenCL as an implementation of devices. */
#ifndef GSCL_LIB_OPENCL_BACKEND_H
#define GSCL_LIB_OPENCL_BACKEND_H

#include "runtime/backend.h"

extern const gscl_backend gscl_opencl_backend;

#endif
