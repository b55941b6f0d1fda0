/* Rate of a file. */
#ifndef GSCL_TOOL_RATE_H
#define GSCL_TOOL_RATE_H

#include <stdint.h>

static inline double bits_per_pixel(uint64_t bytes, uint32_t width, uint32_t height) {
    return 8.0 * (double)bytes / ((double)width * height);
}

#endif
