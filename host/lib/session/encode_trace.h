/* The report of an encode (gscl_encode_report): the times of its stages and, where the settings switch it on, the
 * convergence trace of its fit. */
#ifndef GSCL_LIB_ENCODE_TRACE_H
#define GSCL_LIB_ENCODE_TRACE_H

#include "fit/fit.h"
#include "session/encoder.h"

/* The report of an encode that is running. */
struct gscl_encode_trace {
    gscl_encode_report *report;
    bool has_points; /* the convergence trace is recorded */
    double start_s;
    gscl_stage_time_sum before[GSCL_STAGE_COUNT]; /* of the context's clock when the encode began */
    gscl_renderer preview;                        /* draws trace points, so that the fit's buffers stay as they are */
};

/* Begins to measure the context's stages.  `report` is overwritten. */
void gscl_encode_trace_begin(gscl_encode_trace *trace, gscl_context *context, gscl_encode_report *report,
                             bool has_points);
/* Writes the times into the report at the end of the encode.  Accepts a trace that has ended or, zeroed, never
 * began. */
void gscl_encode_trace_end(gscl_encode_trace *trace, gscl_context *context);

/* Discards the trace points of a fit that another one follows. */
void gscl_trace_restart(gscl_encoder *encoder);
/* Steps from one trace point to the next in a fit of `steps` steps. */
int gscl_trace_interval(int steps);
/* Adds a trace point of the fit after `steps` steps, drawn through its quantiser. */
gscl_result gscl_trace_fit(gscl_encoder *encoder, gscl_fit *fit, int steps);
/* Adds a trace point of a coded image. */
gscl_result gscl_trace_coded_image(gscl_encoder *encoder, gscl_fit *fit, const gscl_coded_image *coded, int steps);

#endif
