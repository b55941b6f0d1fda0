/* K-means clustering of a few thousand points in at most five dimensions.
 *
 * The same arguments give the same bits: sums are in double precision and in the order of the points, and the seed of
 * all random draws is an argument. */
#ifndef GSCL_LIB_KMEANS_H
#define GSCL_LIB_KMEANS_H

#include <stdint.h>

#define GSCL_KMEANS_MAX_DIMS 5
#define GSCL_KMEANS_MAX_POINTS (1u << 20) /* keeps every size below 2^26 bytes */
#define GSCL_KMEANS_MAX_CLUSTERS 65536u

typedef enum gscl_kmeans_status {
    GSCL_KMEANS_OK = 0,
    GSCL_KMEANS_INVALID, /* a size outside its range, or a value that is not finite (or negative) */
    GSCL_KMEANS_NO_MEMORY
} gscl_kmeans_status;

/* The points.  The caller keeps ownership of every array; none is written. */
typedef struct gscl_kmeans_points {
    const float *values;  /* [count][dims], finite, in any unit */
    const float *weights; /* [count], finite and >= 0; NULL: 1 each */
    const float *metric;  /* [dims], finite and >= 0: each dimension is multiplied by it before a
                             distance is taken; NULL: 1 each */
    uint32_t count;       /* points, 0..GSCL_KMEANS_MAX_POINTS */
    uint32_t dims;        /* 1..GSCL_KMEANS_MAX_DIMS */
} gscl_kmeans_points;

typedef struct gscl_kmeans_options {
    uint32_t clusters;   /* largest number of code words, 1..GSCL_KMEANS_MAX_CLUSTERS */
    uint32_t warm;       /* the first `warm` rows of `centroids` are starting points, 0..clusters;
                            k-means++ draws the others */
    uint32_t iterations; /* largest number of Lloyd iterations; 0: assign to the starting points only */
    uint64_t seed;       /* of the k-means++ draws */
} gscl_kmeans_options;

typedef struct gscl_kmeans_result {
    uint32_t clusters;   /* code words, each with at least one member; at most min(clusters, count) */
    uint32_t iterations; /* Lloyd iterations; fewer than allowed once no assignment changes */
    double distortion;   /* sum of weight * squared distance in the metric */
} gscl_kmeans_result;

/* Clusters the points.  `assignment` ([count]) receives for every point the row of its nearest centroid, of equally
 * near ones the first.  `centroids` ([options->clusters][dims], in the points' unit) has the warm rows and receives
 * result->clusters rows, the code words.
 *
 * A cluster that becomes empty restarts at the point that is farthest from its centroid.  Code words without members at
 * the end are dropped, and later rows move up in their order.  More iterations do not increase the distortion, up to
 * the rounding of centroids to float.
 *
 * On failure the content of the outputs is undefined. */
gscl_kmeans_status gscl_kmeans_cluster(const gscl_kmeans_points *points, const gscl_kmeans_options *options,
                                       float *centroids, uint32_t *assignment, gscl_kmeans_result *result);

#endif
