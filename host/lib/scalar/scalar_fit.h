/* The state of an encode in the default profile, and its fit. */
#ifndef GSCL_LIB_SCALAR_FIT_H
#define GSCL_LIB_SCALAR_FIT_H

#include "session/encoder.h"
#include "fit/fit.h"

typedef struct gscl_scalar_state {
    gscl_encoder *encoder;
    gscl_fit fit;
    int steps;
    int finest; /* level of the pyramid that is fitted, counted from the first */
    double details
        [GSCL_MAX_LEVELS];   /* of levels (gscl_fit_level_residual), beyond what rounding makes; NAN: not known yet */
    int next_look;           /* step at which it is asked again whether a finer level is worth it */
    size_t start, target;    /* splats */
    size_t bytes;            /* budget, or 0 */
    size_t most;             /* splats that the image can use */
    double surplus;          /* splats fitted for each that the budget holds; refinement drops the others */
    int passes, passes_done; /* of refinement */
    bool textures;           /* may be used */
    bool keep_all;           /* no splat is dropped */
    double pressure;         /* price of a bit in the next pass of refinement, see gscl_scalar_rdo_settings */
    float *params;
    size_t capacity;
} gscl_scalar_state;

#define GSCL_SCALAR_FIT_SHARE 0.75 /* of the time, for the progress report */

/* The learning rate at this fraction of a fit's steps. */
double gscl_scalar_learning_rate(double fraction);
/* Puts the picture's splats, as they are coded, into the fit. */
gscl_result gscl_scalar_load(gscl_scalar_state *schedule);
/* From now on the fit looks through the quantiser. */
gscl_result gscl_scalar_set_quantiser(gscl_scalar_state *schedule);
/* Reads the fit's splats and turns them into codes. */
gscl_result gscl_scalar_quantise(gscl_scalar_state *schedule);

/* Pixels of the fitted image. */
double gscl_scalar_fitted_pixels(const gscl_encoder *encoder);
/* Distance from splat to splat in the fitted image, in units of the distance at which full size is due. */
double gscl_scalar_sparseness(const gscl_scalar_state *state);
/* Creates the fit with the options that the encoder's header asks for. */
gscl_result gscl_scalar_create_fit(gscl_scalar_state *state);
/* Runs all steps of the fit. */
gscl_result gscl_scalar_run_steps(gscl_scalar_state *state);

#endif
