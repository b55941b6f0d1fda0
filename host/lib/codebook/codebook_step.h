/* Steps of the fit with codebooks. */
#ifndef GSCL_LIB_CODEBOOK_STEP_H
#define GSCL_LIB_CODEBOOK_STEP_H

#include "codebook/codebook.h"

/* Rounds the words to values of the file and projects the splats that they describe. */
gscl_result gscl_codebook_project(gscl_codebook *codebook);
/* A step of the splats' own parameters with the straight-through estimator: the gradient at the splats that the words
 * describe is applied to the splats' own parameters.  `rate` multiplies the learning rates. */
gscl_result gscl_codebook_step_straight_through(gscl_codebook *codebook, float rate);
/* A step of the words and the positions. */
gscl_result gscl_codebook_step(gscl_codebook *codebook, float rate);
/* Resets the optimiser state of words and positions. */
gscl_result gscl_codebook_restart_optimiser(gscl_codebook *codebook);

#endif
