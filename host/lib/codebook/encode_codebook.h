/* The paper profile. */
#ifndef GSCL_LIB_ENCODE_CODEBOOK_H
#define GSCL_LIB_ENCODE_CODEBOOK_H

#include "session/encoder.h"

/* Fits splats and codebooks for the target.  The result is encoder->coded. */
gscl_result gscl_encode_codebook(gscl_encoder *encoder, gscl_size_target target);

#endif
