/* The caller's scratch memory, divided up. */
#ifndef GSCL_FORMAT_WORKSPACE_H
#define GSCL_FORMAT_WORKSPACE_H

#include "attributes.h"
#include "set.h"

#define GSF_MAX_CLASSES GSF_MAX_CODEBOOK

typedef struct gsf_workspace {
    uint32_t counts[GSF_MAX_CLASSES]; /* splats, by class */
    gsf_grid grids[GSF_MAX_CLASSES];
    gsf_attributes attributes;
    gsf_model colour_index;
    gsf_point *points; /* one for every splat, at least GSF_MAX_CODEBOOK */
    gsf_prior *priors;
    void *rest; /* what gsf_order_size wants; shares memory with the lists above */
} gsf_workspace;

#endif
