/* A splat whose centre lies outside the picture, in place of which the format has others only. */
#ifndef GSCL_LIB_CUT_SPLAT_H
#define GSCL_LIB_CUT_SPLAT_H

#include <gscl/gscl.h>

typedef struct gscl_cut {
    double by_x, by_y; /* what the centre has moved, in standard deviations along x and along y */
    double weight;     /* of the splat at its new centre, where it was 1 at the old one */
} gscl_cut;

/* Moves the centre of a splat to the sides of the picture that it lies beyond: into 0..most[0] by 0..most[1].
 * Within the picture the new splat is much like the old one if its weight is taken to that of the cut.  Across a side it falls
 * off so that its integral is the same, along a side nothing changes, and the wave stays where it was. */
gscl_cut gscl_cut_at_sides(gscl_splat *splat, const double most[2]);

#endif
