/* Contexts for tests that run everything in both mappings of pixels to work-items, and decode without OpenCL, too. */
#ifndef GSCL_BOTH_MAPPINGS_H
#define GSCL_BOTH_MAPPINGS_H

#include <gscl/gscl.h>

static gscl_context *contexts[3]; /* the CPU and the GPU mapping, and the device "host" */

static int open_contexts(void **state) {
    (void)state;
    const gscl_mapping mappings[3] = {GSCL_MAPPING_CPU, GSCL_MAPPING_GPU, GSCL_MAPPING_AUTO};
    for (int i = 0; i < 3; i++) {
        gscl_context_settings settings;
        gscl_context_settings_default(&settings);
        settings.mapping = mappings[i];
        settings.device = i == 2 ? GSCL_HOST_DEVICE : NULL;
        if (gscl_context_create(&contexts[i], &settings) != GSCL_OK)
            return -1;
    }
    return 0;
}

static int close_contexts(void **state) {
    (void)state;
    gscl_context_free(&contexts[0]);
    gscl_context_free(&contexts[1]);
    gscl_context_free(&contexts[2]);
    return 0;
}

#endif
