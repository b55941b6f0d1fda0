/* The options that kernels are specialised for (host/lib/runtime/kernel_options.h): OPACITY, TEXTURE, SHAPE, BLEND, WEIGHTED
 * and LOSS are constants of a program, so that what an image lacks takes no instructions.
 *
 * With GENERAL they are read when the program runs, from numbers that the host sets before each launch: one program then
 * serves all images of some channels, with the same results.  What MAY_BE says is true in such a program at some time, and
 * decides on the places of values in structs and arrays. */
#ifdef GENERAL
extern __constant int gscl_general_options[GSCL_GENERAL_OPTIONS];
#define OPACITY gscl_general_options[GSCL_GENERAL_OPACITY]
#define TEXTURE gscl_general_options[GSCL_GENERAL_TEXTURE]
#define SHAPE gscl_general_options[GSCL_GENERAL_SHAPE]
#define BLEND gscl_general_options[GSCL_GENERAL_BLEND]
#define WEIGHTED gscl_general_options[GSCL_GENERAL_WEIGHTED]
#define LOSS gscl_general_options[GSCL_GENERAL_LOSS]
#define MAY_BE(option) 1
#else
#define MAY_BE(option) (option)
#endif
#define ROTATION (SHAPE == GSCL_SHAPE_ROTATED)
#define ANISOTROPY (SHAPE != GSCL_SHAPE_ISOTROPIC)
