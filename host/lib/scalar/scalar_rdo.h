/* Choosing code words by rate and distortion (cl/scalar_rdo.cl): the largest single gain of the default profile. */
#ifndef GSCL_LIB_REFINE_H
#define GSCL_LIB_REFINE_H

#include "fit/fit.h"
#include "decode/coded_image.h"

typedef struct gscl_scalar_rdo_settings {
    double lambda_scale; /* price of a bit: lambda = lambda_scale * error / (2 * bits of the file) */
    bool keep_all;       /* no splat is dropped */
    bool scan_textures;  /* with has_texture: splats may take any wave, else waves only change a little or go */
} gscl_scalar_rdo_settings;

/* Makes one pass over all splats of `picture` (scalar coding, blend normalized or sum): each splat's codes
 * change, or the splat is dropped, where that lowers squared error + lambda * bits.
 * Works at the fit's current level; the fit's splats are overwritten. */
gscl_result gscl_scalar_rdo_pass(gscl_fit *fit, gscl_coded_image *picture, const gscl_scalar_rdo_settings *settings);

#endif
