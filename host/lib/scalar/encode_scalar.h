/* The default profile: a fit with scalar quantisation in the loop, then rate-distortion passes down to the budget. */
#ifndef GSCL_LIB_ENCODE_SCALAR_H
#define GSCL_LIB_ENCODE_SCALAR_H

#include "session/encoder.h"

/* Fits splats so that the file has at most `bytes` bytes or, where `bytes` is 0, exactly `splats` splats.
 * The result is encoder->coded. */
gscl_result gscl_encode_scalar(gscl_encoder *encoder, size_t bytes, size_t splats);

/* A quick fit for the same budget and with the effects that the settings give.  *mse is the squared error per sample
 * (weighted where the fit is) before any code is chosen by rate.  Of the encoder only the coded image changes; it has no
 * meaning afterwards. */
gscl_result gscl_scalar_probe_fit(gscl_encoder *encoder, size_t bytes, size_t splats, double *mse);

#endif
