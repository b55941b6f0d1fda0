/* Which level of the pyramid each step of the fit sees. */
#ifndef GSCL_LIB_SCALAR_FIT_LEVELS_H
#define GSCL_LIB_SCALAR_FIT_LEVELS_H

#include "scalar/scalar_state.h"

/* The shares of the steps at which the fits at full, half and quarter size end. */
void gscl_scalar_level_ends(const gscl_scalar_state *state, double ends[3]);
/* `level`, or the one that is fitted last if that is coarser; counted from the source's. */
int gscl_scalar_limited_level(const gscl_scalar_state *state, int level);
/* The finest level for this part of the steps: the level must contain the detail that the splats should fit. */
int gscl_scalar_level_due(const gscl_scalar_state *state, double fraction);

#endif
