/* The state of an encode in the paper profile, which its stages share. */
#ifndef GSCL_LIB_CODEBOOK_STATE_H
#define GSCL_LIB_CODEBOOK_STATE_H

#include "codebook/codebook.h"
#include "codebook/codebook_plan.h"
#include "codebook/codebook_rdo.h"
#include "session/encoder.h"

typedef struct gscl_codebook_state {
    gscl_encoder *encoder;
    gscl_codebook_plan plan;
    gscl_fit fit;           /* from the stage "free fit" on */
    gscl_codebook codebook; /* from the stage "codebooks" on */
    gscl_codebook_rdo rdo;  /* buffers of the RDO passes, from the stage "RDO rounds" on */
    double fit_error;       /* squared error of the free fit */
    double lambda_scale;    /* lambda as a share of `fit_error` per bit of the file */
} gscl_codebook_state;

#endif
