/* The default profile: a fit with scalar quantisation in the loop, then rate-distortion passes down to the budget.
 *
 * It may use: session/ and lower rooms.
 *
 * In the order in which to read them:
 *   encode_scalar.h: the profile from start to end
 *   scalar_fit.h: the fit
 *   scalar_rdo.h: one rate-distortion pass
 *   byte_budget.h: passes until the file meets its budget */
#ifndef GSCL_ROOM_LIB_SCALAR_H
#define GSCL_ROOM_LIB_SCALAR_H
#endif
