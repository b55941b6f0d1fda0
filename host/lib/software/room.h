/* Drawing by the host's processor: splats to pixels in plain C99, without OpenCL.
 *
 * It may use: image/, runtime/ and the constants of cl/.
 *
 * In the order in which to read them:
 *   software.h: splats to the samples of a rectangle
 *   strips.h: the same in memory of the caller, strip by strip
 *   projection.h: the ellipse of a splat and its weights, row by row
 *   float_bits.h: bounds and roundings of floats
 *   canvas.h: the sums of a block of pixels, and the three ways of blending
 *   samples.h: sums to samples in memory
 *   tunables.h: the numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_SOFTWARE_H
#define GSCL_ROOM_LIB_SOFTWARE_H
#endif
