/* Effects that are decided by trial. */
#ifndef GSCL_LIB_EFFECT_SEARCH_H
#define GSCL_LIB_EFFECT_SEARCH_H

#include "session/encoder.h"

/* Tries effects that this image, looked at quickly, may be better with or without: a sketch each way (encoder.h), for
 * the file that is to be made (of `bytes`, or where they are 0 of `splats`).  What wins is asked for in the settings
 * and what loses ruled out, so that what follows is what it would have been, had the caller said so. */
gscl_result gscl_effects_try(gscl_encoder *encoder, size_t bytes, size_t splats);

#endif
