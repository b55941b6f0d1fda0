/* Meeting the byte budget: from a file of about the size of its budget to one that fits. */
#ifndef GSCL_LIB_BYTE_BUDGET_H
#define GSCL_LIB_BYTE_BUDGET_H

#include "scalar/scalar_state.h"

/* All do nothing where the target has no budget. */

/* After gscl_scalar_choose_codes: uses bytes that are left, then shrinks the file until it fits. */
gscl_result gscl_scalar_meet_budget(gscl_scalar_state *state);
/* After it: where the price had to become so high that needed splats were dropped, fits the others to the gaps, and
 * meets the budget again, as long as that lowers the error. */
gscl_result gscl_scalar_refit_after_drops(gscl_scalar_state *state);
/* Drops splats, the smallest first, until the file fits. */
gscl_result gscl_scalar_trim(gscl_scalar_state *state);

#endif
