/* The settings of an encode: which are valid, and what AUTO means. */
#ifndef GSCL_LIB_ENCODE_SETTINGS_H
#define GSCL_LIB_ENCODE_SETTINGS_H

#include "runtime/context.h"

/* Refuses values out of range and settings that contradict each other. */
gscl_result gscl_encode_settings_check(gscl_context *context, const gscl_encode_settings *settings);
/* Refuses a list of blocks that has a type twice, or a size that the format does not allow. */
gscl_result gscl_blocks_check(gscl_context *context, const gscl_block *blocks);
/* Replaces AUTO by what the profile means by it; the target and the tune, which depend on the image, stay as they are. */
void gscl_encode_settings_resolve(gscl_encode_settings *settings);

#endif
