/* The options that kernels are specialised for, where they are values at run time.
 *
 * A program that is built with GENERAL serves all values of SHAPE, OPACITY, TEXTURE, BLEND, WEIGHTED and LOSS: kernels read
 * them from gscl_launch_options(), which belong to the launch that the calling thread works on.  It computes the same as a
 * program that is specialised for them, more slowly.  Kernels that are compiled with the library (cl/native.py) are general
 * for all but the most usual options.  Where a caller never has but one value of BLEND or LOSS, a build may fix it, for smaller
 * kernels. */
#ifdef GENERAL
#define SHAPE (gscl_launch_options()->shape)
#define OPACITY (gscl_launch_options()->opacity)
#define TEXTURE (gscl_launch_options()->texture)
#ifndef BLEND
#define BLEND (gscl_launch_options()->blend)
#endif
#define WEIGHTED (gscl_launch_options()->weighted)
#ifndef LOSS
#define LOSS (gscl_launch_options()->loss)
#endif

/* The values for which arrays have the most elements. */
#define MAX_SHAPE GSCL_SHAPE_ROTATED
#define MAX_OPACITY 1
#define MAX_TEXTURE 1
#define MAX_WEIGHTED GSCL_WEIGHTED_LUMA
#else
#define MAX_SHAPE SHAPE
#define MAX_OPACITY OPACITY
#define MAX_TEXTURE TEXTURE
#define MAX_WEIGHTED WEIGHTED
#endif
