/* Groups of splats that a rate-distortion pass can change at once, because none touches another's pixels. */
#ifndef GSCL_LIB_RDO_GROUPS_H
#define GSCL_LIB_RDO_GROUPS_H

#include <stdint.h>

#include "cl/structs.h"
#include "decode/renderer.h"

/* At most: a photograph has splats 50 to 110 deep at 0.1 bits a pixel, 140 to 240 at 0.6 and 280 to 440 at 2.  With 64,
 * which takes 1 to 8 % less time, passes left splats out that the next ones left out again, and PSNR was 0 to 0.19 dB lower at
 * 0.1 and 0.183 bits, 0.29 to 0.71 at 0.6 (four photographs) and 1.5 at 2 (two). */
#define GSCL_RDO_GROUPS 512

typedef struct gscl_rdo_groups {
    size_t capacity;      /* splats that fit in `tasks` and `keys` */
    gscl_rdo_task *tasks; /* by group */
    struct gscl_rdo_key *keys;
    size_t start[GSCL_RDO_GROUPS + 1]; /* tasks of each group; the last is the number of all */
    size_t cell_capacity;
    uint64_t *cells; /* maps of the cells of the image, each of 64 groups: which of them have a splat in a cell */
} gscl_rdo_groups;

/* Accepts zeroed groups.  The tasks may be in a copy that was not waited for. */
void gscl_rdo_groups_free(gscl_rdo_groups *groups, gscl_context *context);

/* Distributes `count` splats (GSCL_PARAMS floats each) over the groups, but for the first `fixed`, which do not change.
 * Splats that fit in none are left out. */
gscl_result gscl_rdo_groups_make(gscl_rdo_groups *groups, const gscl_renderer *renderer, const float *params,
                                 size_t fixed, size_t count);

#endif
