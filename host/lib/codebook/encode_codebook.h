/* The paper profile. */
#ifndef GSCL_LIB_ENCODE_CODEBOOK_H
#define GSCL_LIB_ENCODE_CODEBOOK_H

#include "session/encoder.h"

/* Fits splats and codebooks so that the file has at most `bytes` bytes or, where `bytes` is 0, exactly `splats` splats.
 * The result is encoder->coded. */
gscl_result gscl_encode_codebook(gscl_encoder *encoder, size_t bytes, size_t splats);

#endif
