/* The device "host" of a library that has no kernels for this processor: it draws in software (room `software`). */
#ifndef GSCL_LIB_HOST_DEVICE_H
#define GSCL_LIB_HOST_DEVICE_H

#include "runtime/context.h"

gscl_result gscl_host_open(gscl_context *context, const gscl_context_settings *settings);

#endif
