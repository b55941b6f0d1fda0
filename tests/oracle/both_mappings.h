/* Contexts for tests of kernels, which run everything in both mappings of pixels to work-items: of the first OpenCL device, or
 * of the device that GSCL_TEST_DEVICE names; "host" has the CPU mapping alone.  For decodes there is a context of "host", too. */
#ifndef GSCL_BOTH_MAPPINGS_H
#define GSCL_BOTH_MAPPINGS_H

#include "devices.h"

enum { MAX_MAPPINGS = 2, MAX_DECODERS = 3 };

static gscl_context *contexts[MAX_DECODERS]; /* of each mapping; then "host", unless it is the first */
static const char *mapping_names[MAX_DECODERS];
static int mapping_count, decoder_count;

static bool add_context(const char *name, const char *device, gscl_mapping mapping) {
    mapping_names[decoder_count] = name;
    return open_on(&contexts[decoder_count++], device, mapping);
}

static int open_contexts(void **state) {
    (void)state;
    const char *device = kernel_test_device();
    const bool is_host = strcmp(device, GSCL_HOST_DEVICE) == 0;
    bool good =
        is_host || (add_context("cpu", device, GSCL_MAPPING_CPU) && add_context("gpu", device, GSCL_MAPPING_GPU));
    good = good && add_context("host", GSCL_HOST_DEVICE, GSCL_MAPPING_AUTO);
    mapping_count = is_host ? 1 : MAX_MAPPINGS;
    return good ? 0 : -1;
}

static int close_contexts(void **state) {
    (void)state;
    for (int i = 0; i < decoder_count; i++)
        gscl_context_free(&contexts[i]);
    return 0;
}

#endif
