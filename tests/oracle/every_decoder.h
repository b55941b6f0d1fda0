/* Contexts for tests that decode in each way that the library has: on the device "host" and, unless it was built without
 * OpenCL, in both mappings of pixels to work-items. */
#ifndef GSCL_EVERY_DECODER_H
#define GSCL_EVERY_DECODER_H

#include "devices.h"

enum { HOST, CPU_MAPPING, GPU_MAPPING, MAX_DECODERS };
static const char *const decoder_names[MAX_DECODERS] = {"host", "cpu", "gpu"};

static gscl_context *contexts[MAX_DECODERS];
static int decoder_count;

static int open_contexts(void **state) {
    (void)state;
    const gscl_mapping mappings[MAX_DECODERS] = {GSCL_MAPPING_AUTO, GSCL_MAPPING_CPU, GSCL_MAPPING_GPU};
    decoder_count = has_opencl() ? MAX_DECODERS : 1;
    for (int i = 0; i < decoder_count; i++)
        if (!open_on(&contexts[i], i == HOST ? GSCL_HOST_DEVICE : first_opencl_device(), mappings[i]))
            return -1;
    return 0;
}

static int close_contexts(void **state) {
    (void)state;
    for (int i = 0; i < decoder_count; i++)
        gscl_context_free(&contexts[i]);
    return 0;
}

#endif
