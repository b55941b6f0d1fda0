/* Choosing, opening and closing the device of a context. */
#ifndef GSCL_LIB_OPEN_DEVICE_H
#define GSCL_LIB_OPEN_DEVICE_H

#include "runtime/context.h"

/* Opens the device that the settings name ("host", "P.D", or part of a device's or platform's name, any case), or the default
 * device where they name none, with its mapping and what timings need. */
gscl_result gscl_device_open(gscl_context *context, const gscl_context_settings *settings);
/* Releases everything of the device; accepts a context that was not opened, or not wholly. */
void gscl_device_close(gscl_context *context);

#endif
