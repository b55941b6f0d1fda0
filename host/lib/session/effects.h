/* Effects: what an encode was asked to use or to leave, and what it found out. */
#ifndef GSCL_LIB_EFFECTS_H
#define GSCL_LIB_EFFECTS_H

#include "session/encoder.h"

/* Refuses effects that contradict each other, the other settings, or the image. */
gscl_result gscl_effects_check(const gscl_encoder *encoder);

/* Sets the header's effects to what is known before the fit, and notes the decisions. */
void gscl_effects_begin(gscl_encoder *encoder);

/* Whether an effect is on: as asked, else `automatic`. */
bool gscl_effect_wanted(const gscl_encode_settings *settings, gscl_effect effect, bool automatic);
/* Whether the encoder may decide. */
bool gscl_effect_is_open(const gscl_encode_settings *settings, gscl_effect effect);

/* Notes a decision for the report; a later one on the same effect replaces it. */
void gscl_effect_decide(gscl_encoder *encoder, gscl_effect effect, gscl_effect_reason reason, bool on, double gain_db);

#endif
