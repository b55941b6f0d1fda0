/* Stage "search", of small files alone: tries changes of the splats, and keeps those that pay.
 *
 * A fit of a few dozen splats ends in one of many local optima, which differ by up to half a decibel.  A round of the
 * search removes splats at random, adds others where the error is largest, fits all of them for some steps at a small
 * level of the pyramid and makes rate-distortion passes.  The result is kept where its error, scaled to the size of the
 * budget, is lower.  After the rounds of some starts with other random numbers come rounds that begin with the best
 * result: every second one replaces a rectangle of the image by that of another result, where that one is better.  The
 * last part of the stage makes passes at a finer level until the file uses its budget to the last byte, if it can.
 *
 * The effort is the number of searches.  The lowest efforts have none.  Each search has starts of its own, and combines
 * the results of those before, too.  A higher effort begins with the searches of all lower ones, and keeps the best
 * result of all, by the pixels of the source: it is never worse.
 */
#ifndef GSCL_LIB_SEARCH_H
#define GSCL_LIB_SEARCH_H

#include "scalar/search_pool.h"

/* The part of one start.  The last start of a search combines the pool's results, and brings the coded image to the size
 * of the budget; state->size is its size. */
gscl_result gscl_scalar_search(gscl_scalar_state *state, gscl_search_pool *pool);

#endif
