/* The fit of the paper profile: free splats, then with the straight-through estimator for codebooks (P1-P5, P7). */
#ifndef GSCL_LIB_CODEBOOK_FIT_H
#define GSCL_LIB_CODEBOOK_FIT_H

#include "codebook/codebook_state.h"

/* Creates state->fit and runs the first steps without codebooks; sets state->fit_error. */
gscl_result gscl_codebook_fit_freely(gscl_codebook_state *state);
/* Creates state->codebook and runs the remaining steps with the straight-through estimator. */
gscl_result gscl_codebook_fit_straight_through(gscl_codebook_state *state);

/* Reports the progress of the encode, 0..1. */
gscl_result gscl_codebook_report_progress(gscl_codebook_state *state, double fraction);
/* The fraction of the encode that the fit stands for in progress reports. */
#define GSCL_CODEBOOK_FIT_SHARE 0.5

#endif
