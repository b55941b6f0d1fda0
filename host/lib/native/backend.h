/* The processor as an implementation of devices. */
#ifndef GSCL_LIB_NATIVE_BACKEND_H
#define GSCL_LIB_NATIVE_BACKEND_H

#include "runtime/backend.h"

extern const gscl_backend gscl_native_backend;

#endif
