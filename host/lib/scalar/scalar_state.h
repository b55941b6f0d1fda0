/* The state of one encode in the default profile, and the operations that its stages share. */
#ifndef GSCL_LIB_SCALAR_STATE_H
#define GSCL_LIB_SCALAR_STATE_H

#include "fit/fit.h"
#include "scalar/scalar_rdo.h"
#include "scalar/tunables.h"
#include "session/encoder.h"

#define GSCL_HEADER_BYTES 5 /* of a picture, about */

/* The source, the target and the result of a fit. */
typedef struct gscl_scalar_plan {
    const gscl_source *source;
    gscl_coded_image *coded; /* its header holds the layers, and the effects that are known before the fit */
    gscl_size_target target; /* of the layers up to this one */
    const gscl_effort_preset *preset;
    uint32_t layer;
    const gsf_splat
        *fixed;           /* of the layers before, in the stored order, with the steps of `coded`; they do not change */
    size_t fixed_count;   /* 0 in the base layer */
    gscl_size_target all; /* of all layers */
    bool is_last;         /* layer of an encode; not of a probe, whose source may serve other fits */
    bool is_given;        /* `coded` has splats and steps, which take the place of a fit */
} gscl_scalar_plan;

typedef struct gscl_scalar_state {
    /* Constant during the encode. */
    gscl_encoder *encoder; /* services, settings and effects; its source and coded image are not used */
    const gscl_source *source;
    bool is_last_fit;       /* of the encoder's source */
    double source_pixels;   /* of the level that is fitted */
    size_t bytes;           /* budget, or 0 */
    size_t max_splats;      /* that the image can use */
    int steps;              /* of the fit */
    int passes;             /* rate-distortion passes, besides the first and those that meet the budget */
    double full_share;      /* share of the budget above which the file is full */
    double final_gain;      /* of the price by the excess over the budget, in the last passes */
    int finest;             /* level of the pyramid that is fitted last, counted from the source's */
    bool is_searched;       /* the file is small */
    int starts;             /* of all its searches */
    int start_index;        /* of this state among them */
    bool ends_search;       /* this start is the last of a search */
    int rounds;             /* of each start */
    int combinations;       /* rounds after the last start of a search */
    bool waves_at_end;      /* the search tries textures in its last part */
    double fit_end;         /* share of the time, at which the fit ends */
    double passes_end;      /* the same of the passes; the search follows */
    bool is_given;          /* the splats are the caller's, and none is added */
    bool has_choice;        /* codes are chosen by rate and distortion */
    const gsf_splat *fixed; /* splats of the layers before; the first of the fit and of `coded` */
    size_t fixed_count;
    uint32_t layer;          /* of the other splats */
    gscl_coded_image *coded; /* the result */

    /* Stage "fit". */
    uint64_t random; /* state of the random generator */
    gscl_fit fit;
    size_t start, target; /* splats at the first step, and after the last densification */
    double surplus;       /* splats fitted for each that the budget holds; the passes drop the others */
    /* Mean squared error per sample when it was last known, with weights of pixels if there are any; 0: not yet. */
    double known_error;
    double residuals[GSCL_MAX_LEVELS]; /* of each level (gscl_fit_level_residual) beyond the noise of rounding; NAN: not
                                          measured yet */
    int next_level_check;              /* step at which a finer level is considered again */

    /* Stages "choose codes" and "meet the budget". */
    gscl_scalar_rdo rdo;         /* arrays and buffers of the passes */
    size_t size;                 /* of the coded image as a file, after the last pass */
    int passes_done;             /* for the progress report */
    double pass_work_done;       /* the same, in passes that do not scan */
    bool textures;               /* textures may be used */
    bool keep_all;               /* no splat is dropped */
    double lambda_scale;         /* price of a bit in the next pass, see gscl_scalar_rdo_settings */
    double highest_lambda_scale; /* of all passes so far */

    float *params; /* scratch for `capacity` splats */
    size_t capacity;
} gscl_scalar_state;

/* Resolves the plan: number of splats, steps, levels, quantiser steps.  Starts with different numbers differ in their
 * random numbers alone.  `state` may hold anything before. */
void gscl_scalar_begin(gscl_scalar_state *state, gscl_encoder *encoder, const gscl_scalar_plan *plan, int start_index);
/* Frees what the stages made, but for the result. */
void gscl_scalar_end(gscl_scalar_state *state);

/* Distance from splat to splat in the source, in units of the tunable full_size_distance. */
double gscl_scalar_relative_spacing(const gscl_scalar_state *state);
/* Whether steps of the fit take the time of their launches (launch_bound_pixels). */
bool gscl_scalar_is_launch_bound(const gscl_scalar_state *state);
/* Whether errors of the fit and residuals of levels are comparable. */
bool gscl_scalar_has_squared_error(const gscl_scalar_state *state);
/* GSCL_WEIGHTED_... of the tune. */
int gscl_scalar_weighting(const gscl_scalar_state *state);
/* Reads the fit's splats and turns them into codes. */
gscl_result gscl_scalar_quantise(gscl_scalar_state *state);
/* Replaces the fit's splats by the coded ones. */
gscl_result gscl_scalar_load(gscl_scalar_state *state);
/* Whether the coded image, whose size is known, has splats and is no larger than the budget. */
bool gscl_scalar_is_within_budget(const gscl_scalar_state *state);
/* Measures squared error per sample of the last rendering at the current level, without weights: state->known_error. */
gscl_result gscl_scalar_measure_rendering(gscl_scalar_state *state);
/* Sorts the coded image; state->size is its size. */
gscl_result gscl_scalar_update_size(gscl_scalar_state *state);
/* From now on the fit draws its splats as the quantiser would store them. */
gscl_result gscl_scalar_set_quantiser(gscl_scalar_state *state);

#endif
