/* The default profile's encoder, in two parts: the fit (encode_scalar.c), then passes of rate-distortion refinement
 * down to the byte budget (scalar_budget.c). */
#ifndef GSCL_LIB_SCALAR_SCHEDULE_H
#define GSCL_LIB_SCALAR_SCHEDULE_H

#include "encoder.h"
#include "fit.h"

typedef struct gscl_scalar_schedule {
    gscl_encoder *encoder;
    gscl_fit fit;
    int steps;
    int finest;                      /* level of the pyramid that is fitted, counted from the first */
    double details[GSCL_MAX_LEVELS]; /* of levels (gscl_fit_detail), beyond what rounding makes; NAN: not known yet */
    int next_look;                   /* step at which it is asked again whether a finer level is worth it */
    size_t start, target;            /* splats */
    size_t bytes;                    /* budget, or 0 */
    size_t most;                     /* splats that the image can use */
    double surplus;                  /* splats fitted for each that the budget holds; refinement drops the others */
    int passes, passes_done;         /* of refinement */
    bool textures;                   /* may be used */
    bool keep_all;                   /* no splat is dropped */
    double pressure;                 /* price of a bit in the next pass of refinement, see gscl_refine_settings */
    float *params;
    size_t capacity;
} gscl_scalar_schedule;

#define GSCL_SCALAR_FIT_SHARE 0.75 /* of the time, for the progress report */

/* The learning rate at this fraction of a fit's steps. */
double gscl_scalar_rate(double fraction);
/* Puts the picture's splats, as they are coded, into the fit. */
gscl_result gscl_scalar_load(gscl_scalar_schedule *schedule);
/* From now on the fit looks through the quantiser. */
gscl_result gscl_scalar_set_quantiser(gscl_scalar_schedule *schedule);
/* Reads the fit's splats and turns them into codes. */
gscl_result gscl_scalar_quantise(gscl_scalar_schedule *schedule);

/* Chooses all codes by rate and distortion, down to the budget (without one, at a fixed price of bits). */
gscl_result gscl_scalar_refine(gscl_scalar_schedule *schedule);
/* Drops splats, the smallest first, until the file fits. */
gscl_result gscl_scalar_trim(gscl_scalar_schedule *schedule);

#endif
