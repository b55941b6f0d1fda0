/* Which fields and settings gscl_pack takes. */
#ifndef GSCL_LIB_CHECK_FIELD_H
#define GSCL_LIB_CHECK_FIELD_H

#include "pack/pack_state.h"

/* Refuses settings that are out of range or exclude each other. */
gscl_result gscl_pack_settings_check(const gscl_packing *packing);
/* Refuses a field whose size, kind or splats are none; the message names the first of these splats. */
gscl_result gscl_field_check(const gscl_packing *packing);

#endif
