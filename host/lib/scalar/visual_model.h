/* The model of the visual loss during a fit of the default profile. */
#ifndef GSCL_LIB_VISUAL_MODEL_H
#define GSCL_LIB_VISUAL_MODEL_H

#include "scalar/scalar_state.h"

/* Renews the model before step `step` of the fit, where it is due, and state->known_error now and then.  Ends the visual loss
 * of the encode where so little is seen of the error that squared error alone serves better.  Has no effect but where
 * gscl_fit_has_visual_loss. */
gscl_result gscl_scalar_renew_model(gscl_scalar_state *state, int step);
/* Steps from model to model. */
int gscl_scalar_model_interval(const gscl_scalar_state *state);

#endif
