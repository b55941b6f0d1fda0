/* From parameters (floats) to the format's codes (integers). */
#ifndef GSCL_LIB_QUANTISE_H
#define GSCL_LIB_QUANTISE_H

#include "format/format.h"

/* The steps as the kernels take them (GSCL_STEP_COUNT floats). */
void gscl_steps_to_floats(const gsf_steps *steps, float *floats);

/* `factor` times the steps, rounded to the nearest steps that the format offers; the opacity steps stay. */
gsf_steps gscl_scale_steps(const gsf_steps *steps, double factor);

/* Makes the steps of colour finer where the error of `colour` (0..1, each channel) is worth the bits.  `colour` is
 * that of many pixels, which are all wrong if it lies between two codes. */
void gscl_fit_steps_to_colour(gsf_coded_image *coded, const float *colour);

/* The nearest codes for a splat's parameters (GSCL_PARAMS floats); `coded` has the header and the steps. */
void gscl_quantise(const gsf_coded_image *coded, const float *params, gsf_splat *splat);

/* A background value 0..1 as its code. */
uint16_t gscl_quantise_background(const gsf_header *header, float value);

#endif
