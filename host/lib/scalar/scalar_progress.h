/* Progress of an encode: as the time that its steps and passes are expected to take, which differ by a hundred times. */
#ifndef GSCL_LIB_SCALAR_PROGRESS_H
#define GSCL_LIB_SCALAR_PROGRESS_H

#include "scalar/scalar_state.h"

/* Sets state->fit_end of an encode that is not searched. */
void gscl_scalar_expect_fit_end(gscl_scalar_state *state);
/* Reports step `step` of the fit, where a report is due. */
gscl_result gscl_scalar_report_step(gscl_scalar_state *state, int step);
/* Reports a rate-distortion pass that has been done, and counts it. */
gscl_result gscl_scalar_report_pass(gscl_scalar_state *state, bool scan_textures);

#endif
