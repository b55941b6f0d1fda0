/* Where splats are born: at the start by the image's content, later by what is still wrong. */
#ifndef GSCL_LIB_DENSITY_H
#define GSCL_LIB_DENSITY_H

#include "fit/fit.h"

/* Adds the first `count` splats: half spread evenly, half where the image changes most (the
 * paper's P3, "points sampled from the image"). */
gscl_result gscl_density_seed(gscl_fit *fit, size_t count, uint64_t *random);
/* Adds `count` splats where the blurred squared error of the current picture is largest. */
gscl_result gscl_density_grow(gscl_fit *fit, size_t count, uint64_t *random);
/* Adds `count` splats by the paper's adaptive density control (P7): those whose position is pulled hardest are cloned,
 * moved along the pull, where they are small, and split in two smaller ones where they are large. */
gscl_result gscl_density_densify(gscl_fit *fit, size_t count);

#endif
