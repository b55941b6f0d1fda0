#include "device/backends.h"

#include <stddef.h>

#ifdef GSCL_WITH_OPENCL
#include "opencl/backend.h"
#endif
#ifdef GSCL_WITH_NATIVE
#include "native/backend.h"
#endif

const gscl_backend *const gscl_backends[] = {
#ifdef GSCL_WITH_OPENCL
    &gscl_opencl_backend,
#endif
#ifdef GSCL_WITH_NATIVE
    &gscl_native_backend,
#endif
    NULL,
};
