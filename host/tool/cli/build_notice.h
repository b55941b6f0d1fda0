/* A note to the user while kernels are being built for long. */
#ifndef GSCL_TOOL_BUILD_NOTICE_H
#define GSCL_TOOL_BUILD_NOTICE_H

#include <stdbool.h>

#define BUILD_NOTICE "building kernels for the OpenCL device, which takes a while"
#define BUILD_NOTICE_SECONDS 1.0 /* of building, in all contexts together, before the note */

/* As `build` of gscl_context_settings: prints the note once in the process, while kernels are being built. */
void build_notice(void *unused, bool begins);

#endif
