/* Points to be clustered, and a check of a clustering. */
#ifndef GSCL_SYNTHETIC_CLUSTERS_H
#define GSCL_SYNTHETIC_CLUSTERS_H

#include <stdbool.h>

#include "codebook/kmeans.h"

/* A fixed set of `count` pseudo-random points in [0, 1) per dimension, denser towards 0. */
void synthetic_points(float *values, uint32_t count, uint32_t dims, uint32_t seed);

/* Whether every point is assigned to its nearest centroid, every centroid has a member, and the distortion is the sum
 * over all points. */
bool clusters_are_consistent(const gscl_kmeans_points *points, const float *centroids, const uint32_t *assignment,
                             const gscl_kmeans_result *result);

#endif
