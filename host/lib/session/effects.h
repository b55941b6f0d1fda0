/* Effects of one encode: which are on, and why. */
#ifndef GSCL_LIB_EFFECTS_H
#define GSCL_LIB_EFFECTS_H

#include "format/format.h"
#include "image/flat_background.h"
#include "image/image.h"

/* The effects as far as they are decided.  A copy with other masks serves for a trial. */
typedef struct gscl_effects {
    uint32_t on, off; /* masks: switched on or off by the settings or by a trial; the others are open */
    bool paper, alpha_blend;
    gscl_content content;
    size_t decision_count;
    gscl_effect_decision decisions[GSCL_MAX_EFFECTS]; /* for the report, in the order of the effects */
} gscl_effects;

/* Refuses effects that contradict each other, the other settings, or the image. */
gscl_result gscl_effects_check(gscl_context *context, const gscl_encode_settings *settings, const gscl_image *image);

/* The effects that the settings switch on or off; no decision is noted yet.  `settings` hold no AUTO. */
gscl_effects gscl_effects_of_settings(const gscl_encode_settings *settings, const gscl_content *content);

/* Whether neither the settings nor a trial switched the effect on or off. */
bool gscl_effect_is_open(const gscl_effects *effects, gscl_effect effect);
/* Whether an effect is on: `automatic` where it is open. */
bool gscl_effect_is_on(const gscl_effects *effects, gscl_effect effect, bool automatic);

/* Sets the header's channels: chroma and alpha.  They are known before the source planes exist. */
void gscl_effects_set_channels(const gscl_effects *effects, gsf_header *header);
/* Sets all of the header's effects to what is known before the fit; texture is off until the passes use it.
 * `background`: of the source planes. */
void gscl_effects_set_header(const gscl_effects *effects, const gscl_flat_background *background, gsf_header *header);
/* Notes the decisions behind gscl_effects_set_header; those of trials stay. */
void gscl_effects_note(gscl_effects *effects, const gscl_flat_background *background, const gsf_header *header);

/* Notes a decision for the report; a later one on the same effect replaces it. */
void gscl_effect_note(gscl_effects *effects, gscl_effect effect, gscl_effect_reason reason, bool on, double gain_db);

#endif
