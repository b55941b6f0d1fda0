/* Decides which effects the coded image has: by rules and, where these do not suffice, by probe fits. */
#ifndef GSCL_LIB_EFFECT_SEARCH_H
#define GSCL_LIB_EFFECT_SEARCH_H

#include "session/encoder.h"

/* Decides all effects that are known before the fit: encoder->header and encoder->effects.  Effects that may gain or
 * lose on this image are decided by probe fits for encoder->target with and without them.  Where grey wins,
 * encoder->source becomes grey, too. */
gscl_result gscl_encode_decide_effects(gscl_encoder *encoder, const gscl_image *image);

#endif
