/* The picture that splats are, whatever their parameters. */
#ifndef GSCL_LIB_FIELD_RENDERING_H
#define GSCL_LIB_FIELD_RENDERING_H

#include "pack/pack_state.h"

/* Draws splats of the packing's kind into a new image of floats with premultiplied colours, whose pixels the caller frees. */
gscl_result gscl_pack_render(const gscl_packing *packing, const gscl_splat_list *splats, gscl_image *image);

#endif
