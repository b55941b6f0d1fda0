/* Groups of splats that a rate-distortion pass can change at once, because none touches another's pixels. */
#ifndef GSCL_LIB_RDO_GROUPS_H
#define GSCL_LIB_RDO_GROUPS_H

#include <stdint.h>

#include "cl/structs.h"
#include "decode/renderer.h"

#define GSCL_RDO_GROUPS 64 /* one bit each in the map of cells */

typedef struct gscl_rdo_groups {
    size_t capacity;      /* splats that fit in `tasks` and `keys` */
    gscl_rdo_task *tasks; /* by group */
    struct gscl_rdo_key *keys;
    size_t start[GSCL_RDO_GROUPS + 1]; /* tasks of each group; the last is the number of all */
    size_t cell_capacity;
    uint64_t *cells; /* groups that have a splat in each cell of the image */
} gscl_rdo_groups;

/* Accepts zeroed groups.  The tasks may be in a copy that was not waited for. */
void gscl_rdo_groups_free(gscl_rdo_groups *groups, gscl_context *context);

/* Distributes `count` splats (GSCL_PARAMS floats each) over the groups, but for the first `fixed`, which do not change.
 * Splats that fit in none are left to the next pass. */
gscl_result gscl_rdo_groups_make(gscl_rdo_groups *groups, const gscl_renderer *renderer, const float *params,
                                 size_t fixed, size_t count);

#endif
