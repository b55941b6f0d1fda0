/* Between parameters (floats) and the format's codes (integers). */
#ifndef GSCL_LIB_QUANTISE_H
#define GSCL_LIB_QUANTISE_H

#include "format/format.h"

/* The steps as the kernels take them (GSCL_STEP_COUNT floats). */
void gscl_steps_to_floats(const gsf_steps *steps, float *floats);

/* About `factor` times the steps, as far as the format has such steps; of opacities the same. */
gsf_steps gscl_scale_steps(const gsf_steps *steps, double factor);

/* Makes the picture's steps of colour so much finer as `colour` (0..1, each channel), which many of its pixels have,
 * is worth: between two codes it would be off everywhere. */
void gscl_fit_steps_to_colour(gsf_coded_image *picture, const float *colour);

/* The nearest codes for a splat's parameters (GSCL_PARAMS floats); `picture` gives header and steps. */
void gscl_quantise(const gsf_coded_image *picture, const float *params, gsf_splat *splat);
/* Position and angle codes again, for a splat whose axes' codes have been set. */
void gscl_quantise_placement(const gsf_coded_image *picture, const float *params, gsf_splat *splat);
/* What the codes stand for (FORMAT.md, "Dequantisation"). */
void gscl_dequantise(const gsf_coded_image *picture, const gsf_splat *splat, float *params);
/* Likewise for codebook coding. */
void gscl_dequantise_indexed(const gsf_coded_image *picture, const gsf_indexed_splat *splat, float *params);

/* A background value 0..1 as its code, and an opacity as a logit. */
uint16_t gscl_quantise_background(const gsf_header *header, float value);
float gscl_logit(double opacity);

#endif
