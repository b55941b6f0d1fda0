/* What an encode tells of itself (gscl_encode_report): its stages on the wall clock and, where the settings ask for
 * them, the rounds of its fit.
 *
 * A recorder belongs to one encode; the context knows it meanwhile, so that gscl_stage (timing.h) can tell it. */
#ifndef GSCL_LIB_REPORT_H
#define GSCL_LIB_REPORT_H

#include "encoder.h"
#include "fit.h"

typedef struct gscl_recorder {
    gscl_encode_report *report;
    bool rounds; /* are wanted */
    double start_s;
    double aside_s;       /* seconds that measuring rounds took, which are nobody's */
    const char *stage;    /* under way, or NULL */
    double stage_start_s; /* of that stage */
    gscl_renderer probe;  /* draws rounds, so that the fit's own buffers stay as they are */
} gscl_recorder;

/* From now on `recorder` hears of the context's stages and fills in the report. */
void gscl_recorder_begin(gscl_recorder *recorder, gscl_context *context, gscl_encode_report *report, bool rounds);
/* The encode is over: its seconds are in the report.  Accepts a recorder that has ended or, zeroed, was never begun. */
void gscl_recorder_end(gscl_recorder *recorder, gscl_context *context);

/* Ends a stage and begins another, as gscl_stage does. */
const char *gscl_recorder_stage(gscl_recorder *recorder, const char *name, double now_s);

/* Forgets the rounds of a fit that another one follows. */
void gscl_report_restart(gscl_encoder *encoder);
/* Steps from one round of a fit of `steps` steps to the next. */
int gscl_report_interval(int steps);
/* Adds a round: the fit's splats as they are now, through its quantiser, after `steps` steps. */
gscl_result gscl_report_fit(gscl_encoder *encoder, gscl_fit *fit, int steps);
/* Likewise, but the encoder's picture, as its codes say. */
gscl_result gscl_report_picture(gscl_encoder *encoder, gscl_fit *fit, int steps);

#endif
