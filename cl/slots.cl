/* Gradient slots: a splat's sums over one tile, from the kernel that computes them (fit.cl) to the one that adds them up
 * (update.cl).
 *
 * Each entry of a tile's list has a slot, so that no two work-groups write to the same place and no float atomics are
 * needed.  A splat finds its slots by its links to these entries (links.cl).
 *
 * With h = dL/dweight and t = h * opacity * gauss, a slot holds
 *     sum t u, t v, t u^2, [t u v,] t v^2, [h weight,] w dL/dcolour for each channel, and [w dL/dwave times the wave a
 *     quarter of a turn on, whose phase moves with the splat].
 * A circle has one sum instead of t u^2 and t v^2. */
#define SLOT_VV GSCL_SLOT_VV(SHAPE)
#define SLOT_OPACITY GSCL_SLOT_OPACITY(SHAPE)
#define SLOT_COLOUR GSCL_SLOT_COLOUR(SHAPE, OPACITY)
#define SLOT_WAVE GSCL_SLOT_WAVE(SHAPE, OPACITY, CHANNELS)
#define SLOT GSCL_SLOT_SIZE(SHAPE, OPACITY, CHANNELS, TEXTURE)
#define MAX_SLOT GSCL_SLOT_SIZE(MAX_SHAPE, MAX_OPACITY, CHANNELS, MAX_TEXTURE)
