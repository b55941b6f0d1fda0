/* Points to be clustered, and what must be true of any clustering. */
#ifndef GSCL_SYNTHETIC_CLUSTERS_H
#define GSCL_SYNTHETIC_CLUSTERS_H

#include <stdbool.h>

#include "codebook/kmeans.h"

/* A fixed cloud of `count` points in [0, 1) per dimension, denser towards 0. */
void synthetic_points(float *values, uint32_t count, uint32_t dims, uint32_t seed);

/* Every point sits at its nearest centroid, every centroid has a member, the distortion adds up. */
bool clusters_are_consistent(const gscl_kmeans_points *points, const float *centroids, const uint32_t *assignment,
                             const gscl_kmeans_result *result);

#endif
