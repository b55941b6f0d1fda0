/* A copy of the codes of a coded image, to which the search and the stage "meet the budget" return. */
#ifndef GSCL_LIB_KEPT_CODES_H
#define GSCL_LIB_KEPT_CODES_H

#include "scalar/scalar_state.h"

/* Zeroed: empty. */
typedef struct gscl_kept_codes {
    gsf_splat *splats; /* `count` of them, in the stored order */
    size_t capacity;
    uint32_t count;
    bool has_texture;
    size_t size;  /* of the coded image as a file */
    double error; /* squared, at the level at which it was measured; NAN: it was not */
} gscl_kept_codes;

/* Copies state->coded; state->size is its size. */
gscl_result gscl_kept_codes_keep(gscl_kept_codes *kept, const gscl_scalar_state *state, double error);
/* The same where none are kept, or the kept ones have a higher error. */
gscl_result gscl_kept_codes_keep_better(gscl_kept_codes *kept, const gscl_scalar_state *state, double error);
/* Writes the codes and their size back. */
gscl_result gscl_kept_codes_restore(const gscl_kept_codes *kept, gscl_scalar_state *state);
/* Accepts a zeroed object. */
void gscl_kept_codes_free(gscl_kept_codes *kept);

#endif
