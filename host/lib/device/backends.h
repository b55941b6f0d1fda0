/* The implementations of devices that this library was built with. */
#ifndef GSCL_LIB_DEVICE_BACKENDS_H
#define GSCL_LIB_DEVICE_BACKENDS_H

#include "runtime/backend.h"

/* In the order in which their devices are listed; NULL behind the last. */
extern const gscl_backend *const gscl_backends[];

#endif
