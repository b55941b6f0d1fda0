/* RDO rounds: words and positions are chosen by rate and distortion and then learnt, until the file fits its budget. */
#ifndef GSCL_LIB_CODEBOOK_ROUNDS_H
#define GSCL_LIB_CODEBOOK_ROUNDS_H

#include "codebook/codebook_state.h"

/* Creates state->rdo and runs the planned rounds; lambda is updated so that the size approaches the budget. */
gscl_result gscl_codebook_run_rounds(gscl_codebook_state *state);
/* Runs RDO passes with a rising lambda until the file all but fits, learns the words once more and cuts off what still
 * exceeds the budget.  Leaves the coded image in the encoder. */
gscl_result gscl_codebook_meet_budget(gscl_codebook_state *state);

#endif
