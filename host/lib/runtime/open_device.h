/* Opening and closing the OpenCL device of a context. */
#ifndef GSCL_LIB_OPEN_DEVICE_H
#define GSCL_LIB_OPEN_DEVICE_H

#include "runtime/context.h"

/* The device of settings that name none; NULL: the first GPU and so on. */
extern const char *const gscl_default_device;

/* Chooses the device by the settings, with its mapping, and creates its queue and what timings need. */
gscl_result gscl_device_open(gscl_context *context, const gscl_context_settings *settings);
/* Releases everything of the device; accepts a context that was not opened, or not wholly. */
void gscl_device_close(gscl_context *context);

#endif
