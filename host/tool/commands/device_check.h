/* gscl devices --check: encodes and decodes a small picture on each device, with the kernels of both mappings. */
#ifndef GSCL_TOOL_DEVICE_CHECK_H
#define GSCL_TOOL_DEVICE_CHECK_H

#include <stdbool.h>
#include <stdint.h>

/* Checks all devices and prints a line for each, or JSON.  Each check is a process of its own, which ends after
 * `limit_s` seconds at the latest, because a broken OpenCL implementation may crash or never return.  Must be called before
 * the process uses OpenCL.  Returns the exit code of the program: EXIT_FAILURE if there is no device or one fails. */
int device_check_run(uint64_t limit_s, bool as_json);

#endif
