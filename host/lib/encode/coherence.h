/* Coherence of the directions of an image's edges. */
#ifndef GSCL_LIB_COHERENCE_H
#define GSCL_LIB_COHERENCE_H

#include "image/image.h"

/* Coherence at a level of the pyramid, in windows in proportion to the distance between `splats` splats that cover the
 * image.  1: in each window all edges have one direction.  0: all directions are equally frequent. */
gscl_result gscl_edge_coherence(gscl_context *context, const gscl_image *image, int level, double splats,
                                double *coherence);

#endif
