/* Finding and choosing OpenCL devices. */
#ifndef GSCL_LIB_DEVICE_H
#define GSCL_LIB_DEVICE_H

#include "runtime/context.h"

/* Sets context->platform, ->device, ->info, ->quirks and ->own_builtins to the device that `selector` names ("P.D",
 * or part of a device's or platform's name, any case), or to the default device when it is NULL. */
gscl_result gscl_device_choose(gscl_context *context, const char *selector);

#endif
