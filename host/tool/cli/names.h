/* Words for the enums of the library, on the command line and in JSON. */
#ifndef GSCL_TOOL_NAMES_H
#define GSCL_TOOL_NAMES_H

/* Each array is indexed by its enum and ends with NULL. */
extern const char *const preset_words[];  /* gscl_preset */
extern const char *const profile_words[]; /* gscl_profile */
extern const char *const blend_words[];   /* gscl_blend */
extern const char *const loss_words[];    /* gscl_loss */
extern const char *const tune_words[];    /* gscl_tune */
extern const char *const mapping_words[]; /* gscl_mapping */

/* "grey", "grey+alpha", "RGB", "RGBA"; "no" for any other number. */
const char *channels_name(unsigned channels);

#endif
