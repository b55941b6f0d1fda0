/* The loop of rate-distortion passes: each pass chooses all codes again, while lambda is updated until the file has
 * about the size of its budget. */
#ifndef GSCL_LIB_CHOOSE_CODES_H
#define GSCL_LIB_CHOOSE_CODES_H

#include "scalar/scalar_state.h"

/* Chooses all codes by rate and distortion, down to about the budget (without one, at a constant price of bits).
 * state->size is the size of the coded image afterwards. */
gscl_result gscl_scalar_choose_codes(gscl_scalar_state *state);

/* One pass; state->size is the size afterwards. */
gscl_result gscl_scalar_pass(gscl_scalar_state *state, bool scan_textures);
/* Adds splats for the bytes that are left, fits all splats for some steps, and makes `passes` passes, of which the first
 * may scan.  Where this raises the error by far, because the steps spoil a fit that was nearly exact, it is undone, and
 * *is_kept is false. */
gscl_result gscl_scalar_densify(gscl_scalar_state *state, int passes, bool scan_textures, bool *is_kept);
/* Whether the image can use no more splats. */
bool gscl_scalar_has_max_splats(const gscl_scalar_state *state);
/* Sets lambda so that the next pass leaves about `target_size` bytes; `before`: the size before the last pass. */
void gscl_scalar_update_lambda(gscl_scalar_state *state, size_t before, double target_size, double gain);

/* The number of splats that have a wave. */
uint32_t gscl_scalar_count_textured(const gsf_coded_image *file);
/* Clears the header's texture effect where no splat has a wave, and notes the decision. */
void gscl_scalar_drop_unused_effects(gscl_scalar_state *state);

#endif
