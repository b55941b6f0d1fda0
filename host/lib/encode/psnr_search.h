/* Encoding to a quality: a search over the byte budget. */
#ifndef GSCL_LIB_PSNR_SEARCH_H
#define GSCL_LIB_PSNR_SEARCH_H

#include "session/encoder.h"

/* Searches for the smallest file that reaches settings.target_value dB. */
gscl_result gscl_encode_to_psnr(gscl_encoder *encoder);

#endif
