/* Files for a target: codes with coarser steps, and codes that rate-distortion passes choose. */
#ifndef GSCL_LIB_PACK_TARGET_H
#define GSCL_LIB_PACK_TARGET_H

#include "pack/pack_state.h"

/* packing->coded becomes the result for the target of the settings, which the reference serves where it is needed. */
gscl_result gscl_pack_choose_codes(gscl_packing *packing);
/* Whether this needs the reference. */
bool gscl_pack_needs_reference(const gscl_packing *packing);

#endif
