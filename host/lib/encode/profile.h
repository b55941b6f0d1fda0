/* The two profiles behind one function. */
#ifndef GSCL_LIB_PROFILE_H
#define GSCL_LIB_PROFILE_H

#include "session/encoder.h"

/* Fits splats with the profile that the settings ask for, so that the file has at most `bytes` bytes or, where
 * `bytes` is 0, exactly `splats` splats.  The result is encoder->coded. */
gscl_result gscl_encode_profile(gscl_encoder *encoder, size_t bytes, size_t splats);

#endif
