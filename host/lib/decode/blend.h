/* Blend modes have three numberings: the public one (which has AUTO), the file format's, and the one that kernels are
 * built with.  This file alone converts between them. */
#ifndef GSCL_LIB_BLEND_H
#define GSCL_LIB_BLEND_H

#include <gscl/gscl.h>

#include "format/types.h"

/* `blend` must not be AUTO. */
gsf_blend gscl_blend_to_format(gscl_blend blend);
gscl_blend gscl_blend_from_format(gsf_blend blend);
/* GSCL_NORMALIZED, GSCL_ALPHA or GSCL_SUM; `blend` must not be AUTO. */
int gscl_blend_to_kernels(gscl_blend blend);
gscl_blend gscl_blend_from_kernels(int blend);

#endif
