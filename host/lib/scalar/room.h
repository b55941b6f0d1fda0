/* The default profile: a fit with scalar quantisation in the loop, then rate-distortion passes down to the budget.
 *
 * It may use: session/ and lower rooms.
 *
 * In the order in which to read them:
 *   encode_scalar.h: the stages of the profile
 *   scalar_state.h: the state that they share
 *   scalar_fit.h: stage "fit"
 *   fit_levels.h: which level each of its steps sees
 *   visual_model.h: the visual loss in it
 *   choose_codes.h: stage "choose codes", a loop of rate-distortion passes
 *   scalar_rdo.h: one rate-distortion pass
 *   rdo_tables.h: meanings and costs of codes in a pass
 *   rdo_groups.h: splats that a pass can change at once
 *   byte_budget.h: stage "meet the budget"
 *   search.h: stage "search", of small files
 *   search_plan.h: its levels and rounds
 *   search_state.h: what its two parts share
 *   search_pool.h: the results that a search combines
 *   kept_codes.h: copies of codes
 *   scalar_progress.h: what part of the time is over
 *   probe_fit.c: short fits by which effects are decided
 *   tunables.h: effort presets, and the numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_SCALAR_H
#define GSCL_ROOM_LIB_SCALAR_H
#endif
