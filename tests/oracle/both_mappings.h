/* Two contexts for tests that run everything in both mappings of pixels to work-items. */
#ifndef GSCL_BOTH_MAPPINGS_H
#define GSCL_BOTH_MAPPINGS_H

#include <gscl/gscl.h>

static gscl_context *contexts[2]; /* the CPU and the GPU mapping */

static int open_contexts(void **state) {
    (void)state;
    const gscl_mapping mappings[2] = {GSCL_MAPPING_CPU, GSCL_MAPPING_GPU};
    for (int i = 0; i < 2; i++) {
        gscl_context_settings settings;
        gscl_context_settings_default(&settings);
        settings.mapping = mappings[i];
        if (gscl_context_create(&contexts[i], &settings) != GSCL_OK)
            return -1;
    }
    return 0;
}

static int close_contexts(void **state) {
    (void)state;
    gscl_context_free(&contexts[0]);
    gscl_context_free(&contexts[1]);
    return 0;
}

#endif
