/* From the format's codes (integers) to parameters (floats): FORMAT.md, "Dequantisation". */
#ifndef GSCL_LIB_DEQUANTISE_H
#define GSCL_LIB_DEQUANTISE_H

#include "format/format.h"
#include "runtime/real.h"

/* Steps of ln sigma and of the amplitude of a wave. */
gscl_real gscl_scale_step(const gsf_steps *steps);
gscl_real gscl_amplitude_step(const gsf_steps *steps);

/* An opacity 0..1 as a logit. */
float gscl_logit(gscl_real opacity);

/* The parameters (GSCL_PARAMS floats) of a splat's codes. */
void gscl_dequantise(const gsf_coded_image *coded, const gsf_splat *splat, float *params);
/* The same for codebook coding. */
void gscl_dequantise_indexed(const gsf_coded_image *coded, const gsf_indexed_splat *splat, float *params);
/* The same for splat number `i` of either coding. */
void gscl_dequantise_splat(const gsf_coded_image *coded, uint32_t i, float *params);

/* The colour of a splat of scalar coding, gsf_channel_count channels. */
void gscl_dequantise_colour(const gsf_coded_image *coded, const gsf_splat *splat, float *colour);

/* The background, of gsf_channel_count channels.  `colour_sums`: each channel added up over the splats. */
void gscl_dequantise_background(const gsf_coded_image *coded, const gscl_real colour_sums[4], float background[4]);

#endif
