/* Which effects the coded image has: by rules, and where these do not suffice by probe fits. */
#ifndef GSCL_LIB_EFFECT_SEARCH_H
#define GSCL_LIB_EFFECT_SEARCH_H

#include "session/encoder.h"

/* Decides all effects that are known before the fit: encoder->header and encoder->effects.  Effects that this image may
 * be better with or without are tried: two probe fits for encoder->target.  Where grey wins, encoder->source becomes
 * grey, too. */
gscl_result gscl_encode_decide_effects(gscl_encoder *encoder, const gscl_image *image);

#endif
