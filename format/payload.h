/* The payload: everything after the header of a picture (FORMAT.md, "Splats"). */
#ifndef GSCL_FORMAT_PAYLOAD_H
#define GSCL_FORMAT_PAYLOAD_H

#include "format/attributes.h"
#include "format/classes.h"
#include "format/coder.h"
#include "format/model.h"
#include "format/set.h"
#include "format/types.h"

/* Working memory of gsf_code_payload, with the lists behind it. */
typedef struct gsf_workspace {
    gsf_set set;
    union {
        gsf_attributes attributes; /* scalar coding */
        struct {
            gsf_model model;
            uint16_t freq[GSF_MAX_CODEBOOK];
        } colour_index; /* codebook coding */
    } models;
    uint32_t certain;  /* splats decoded without a byte beyond the end (reader) */
    uint32_t *counts;  /* splats, by class */
    gsf_grid *grids;   /* by class */
    gsf_point *points; /* one for every splat, with codebooks at least GSF_MAX_CODEBOOK */
    gsf_prior *priors; /* one for every splat, at most GSF_MAX_PRIORS */
} gsf_workspace;

/* Bytes of a workspace and its lists, for a file with this header. */
size_t gsf_workspace_size(const gsf_header *header);

/* The workspace at the start of so much memory, aligned as malloc does; its lists are set, and all else is as it was. */
gsf_workspace *gsf_workspace_in(const gsf_header *header, void *memory);

/* Codes the payload in the direction of the coder.  Returns false when the input ran out or the splats cover
 * too many pixels (FORMAT.md, "Limits"). */
bool gsf_code_payload(gsf_coder *coder, gsf_coded_image *image, gsf_workspace *workspace);

#endif
