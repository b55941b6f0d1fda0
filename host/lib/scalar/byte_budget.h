/* From a fit that is slightly too large to a file that just fits its budget. */
#ifndef GSCL_LIB_BYTE_BUDGET_H
#define GSCL_LIB_BYTE_BUDGET_H

#include "scalar/scalar_fit.h"

/* Chooses all codes by rate and distortion, down to the budget (without one, at a fixed price of bits). */
gscl_result gscl_scalar_refine(gscl_scalar_state *schedule);
/* Drops splats, the smallest first, until the file fits. */
gscl_result gscl_scalar_trim(gscl_scalar_state *schedule);

#endif
