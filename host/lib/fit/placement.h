/* Placement of splats on a level of the pyramid by a density, on the device: where, how large and in which direction. */
#ifndef GSCL_LIB_PLACEMENT_H
#define GSCL_LIB_PLACEMENT_H

#include "fit/fit.h"

/* Settings for `count` splats on the fit's level.  Their size, opacity and density_scale are left to the caller. */
gscl_placement_settings gscl_placement_begin(const gscl_fit *fit, size_t count);

/* Appends splats by systematic sampling of the density of each pixel, fit->error, whose values before box sums add up to
 * fit->density_total.  The level is cut into strips about as high as the mean distance of the new splats, which are walked to
 * and fro, column by column, and every count-th part of the density on this way gets one splat.  Splats thus keep apart from
 * each other, which independent samples do not.
 *
 * `random` gives GSCL_PLACEMENT_DRAWS numbers for each splat. */
gscl_result gscl_placement_append(gscl_fit *fit, gscl_placement_settings settings, uint64_t *random);

#endif
