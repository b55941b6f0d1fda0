/* Density control: where splats are added, at the start by the content of the image, later by the remaining error. */
#ifndef GSCL_LIB_DENSITY_H
#define GSCL_LIB_DENSITY_H

#include "fit/fit.h"

/* Adds the first `count` splats: half of them spread evenly, half by the magnitude of the image's gradient (the paper's
 * P3, "points sampled from the image"). */
gscl_result gscl_density_seed(gscl_fit *fit, size_t count, uint64_t *random);
/* Adds `count` splats by the box sums of the squared error of the current rendering. */
gscl_result gscl_density_grow(gscl_fit *fit, size_t count, uint64_t *random);
/* Adds `count` splats by the paper's adaptive density control (P7).  Of the splats with the largest gradients of their
 * positions, small ones are cloned and moved against the gradient, large ones are split into two smaller ones. */
gscl_result gscl_density_densify(gscl_fit *fit, size_t count);

#endif
