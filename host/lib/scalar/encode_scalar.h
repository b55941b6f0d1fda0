/* The default profile: a fit with scalar quantisation in the loop, then rate-distortion passes down to the budget. */
#ifndef GSCL_LIB_ENCODE_SCALAR_H
#define GSCL_LIB_ENCODE_SCALAR_H

#include "session/encoder.h"

/* Fits splats for the target.  encoder->coded holds the header before and the result afterwards. */
gscl_result gscl_encode_scalar(gscl_encoder *encoder, gscl_size_target target);

/* Chooses codes for the splats that encoder->coded has, which take the place of a fit: after `steps` steps in which they may move,
 * rate-distortion passes down to the picture of `bytes` bytes.  No splat is added.  Not for the blend alpha. */
gscl_result gscl_encode_given(gscl_encoder *encoder, size_t bytes, int steps);

/* A short fit of `source` for the same target.  `header` holds the effects.  *mse is the squared error per sample
 * (weighted where the fit is) before any code is chosen by rate.  Of the encoder nothing but the progress changes. */
gscl_result gscl_scalar_probe_fit(gscl_encoder *encoder, const gscl_source *source, const gsf_header *header,
                                  gscl_size_target target, double *mse);

#endif
