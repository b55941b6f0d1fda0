/* The state of a search (search.h), and the operations that its two parts share. */
#ifndef GSCL_LIB_SEARCH_STATE_H
#define GSCL_LIB_SEARCH_STATE_H

#include "scalar/kept_codes.h"
#include "scalar/scalar_state.h"
#include "scalar/search_pool.h"

typedef struct gscl_search {
    gscl_scalar_state *s;
    gscl_search_pool *pool;
    gscl_kept_codes best; /* of the lowest scaled error so far; the next candidates are made of it */
    gscl_kept_codes
        within;    /* of the lowest error within the budget so far; its count is 0 while there is none.  Between
                                the starts of a search the pool has it */
    double lambda; /* price of a bit, as squared error added over the current level */
    bool elongation_is_free; /* no price for artefacts of shape: where it leaves no use for the last bytes */
} gscl_search;

/* Keeps the coded image, whose error is known, in search->within where it fits and has a lower error. */
gscl_result gscl_search_keep_within(gscl_search *search, double error);
/* Makes `level` (counted from the source's) the current one; measures the kept codes and converts q->lambda. */
gscl_result gscl_search_set_level(gscl_search *q, int level);
/* One rate-distortion pass at the price q->lambda * factor.  `error`: of the coded image. */
gscl_result gscl_search_pass(gscl_search *q, double error, double factor, bool scan_textures);

/* Passes over the codes in `from` at different prices: brackets and then bisects the lowest one at which the file is
 * within the budget.  q->within has the result. */
gscl_result gscl_search_to_budget(gscl_search *q, const gscl_kept_codes *from);
/* The last part: brings q->best to the size of the budget. */
gscl_result gscl_search_meet_budget(gscl_search *q);

#endif
