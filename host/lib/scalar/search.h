/* Stage "search", of small files alone: tries changes of the splats, and keeps those that pay.
 *
 * A fit of a few dozen splats ends in one of many local optima, which differ by up to half a decibel.  A round of the
 * search removes splats at random, adds others where the error is largest, fits all of them for some steps at a small
 * level of the pyramid and makes rate-distortion passes.  The result is kept where it costs less: error + lambda *
 * bits, with a lambda at which the files have about the size of the budget.  The last part of the stage makes passes
 * at a finer level until the file uses its budget to the last byte, if it can.
 *
 * The effort is the number of rounds and, from effort 5 on, of starts: after some dozens of rounds further ones hardly
 * gain, while the results of different starts differ by a tenth of a decibel.  The lowest efforts have none.  All others
 * begin with the same fit and the same rounds; a higher effort also does all that lower ones do at their ends, and keeps
 * the best result.
 */
#ifndef GSCL_LIB_SEARCH_H
#define GSCL_LIB_SEARCH_H

#include "scalar/scalar_state.h"

/* Improves the coded image and brings it to the size of the budget; state->size is its size. */
gscl_result gscl_scalar_search(gscl_scalar_state *state);

#endif
