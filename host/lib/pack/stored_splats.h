/* The splats of a field as parameters: as they are, and as the format can store them. */
#ifndef GSCL_LIB_STORED_SPLATS_H
#define GSCL_LIB_STORED_SPLATS_H

#include "pack/pack_state.h"

/* Sets the header's kind, size and effects, and the background, from what the field has. */
void gscl_pack_describe(gscl_packing *packing);
/* The parameters of a splat as it is, one of the field or of its kind. */
void gscl_pack_given_params(const gscl_packing *packing, const gscl_splat *splat, float *params);
/* The parameters of all splats of the field as it is: the caller frees list->params. */
gscl_result gscl_pack_given_splats(const gscl_packing *packing, gscl_splat_list *list);
/* Sets packing->stored and its layers, and counts in the report what differs from the field. */
gscl_result gscl_pack_store_splats(gscl_packing *packing);

#endif
