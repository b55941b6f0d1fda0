/* The fit of the default profile: a pyramid, with scalar quantisation in the loop. */
#ifndef GSCL_LIB_SCALAR_FIT_H
#define GSCL_LIB_SCALAR_FIT_H

#include "scalar/scalar_state.h"

/* Creates state->fit and runs all its steps. */
gscl_result gscl_scalar_fit(gscl_scalar_state *state);
/* Creates state->fit for the splats of the coded image, at the finest level, without a step. */
gscl_result gscl_scalar_take_given(gscl_scalar_state *state);
/* Fits all coded splats for `steps` steps, `new_splats` of them new where the error is largest, and quantises them. */
gscl_result gscl_scalar_refit(gscl_scalar_state *state, size_t new_splats, int steps);
/* Decides whether the coded image stores its background: where the mean of its splats would be seen between them. */
gscl_result gscl_scalar_choose_background(gscl_scalar_state *state);
/* Squared error of the coded image, added over the current level; INFINITY without splats. */
gscl_result gscl_scalar_measure(gscl_scalar_state *state, double *error);
/* The same of each pixel of the current level, of a coded image that has splats. */
gscl_result gscl_scalar_measure_pixels(gscl_scalar_state *state, float *error);

#endif
