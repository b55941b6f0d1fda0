/* Choosing code words by rate and distortion (cl/refine.cl): the largest single gain of the default profile. */
#ifndef GSCL_LIB_REFINE_H
#define GSCL_LIB_REFINE_H

#include "fit.h"
#include "picture.h"

/* Makes one pass over all splats of `picture` (scalar coding, blend normalized or sum): each splat's codes
 * change, or the splat is dropped, where that lowers squared error + lambda * bits, with
 * lambda = pressure * error / (2 * bits of the file).  `keep_all`: no splat is dropped.
 * Works at the fit's current level; the fit's splats are overwritten. */
gscl_result gscl_refine_pass(gscl_fit *fit, gscl_picture *picture, double pressure, bool keep_all);

#endif
