#include "synthetic_clusters.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

void synthetic_points(float *values, uint32_t count, uint32_t dims, uint32_t seed) {
    uint32_t state = seed;
    for (uint32_t i = 0; i < count * dims; i++) {
        state = state * 1664525u + 1013904223u;
        const float u = (float)(state >> 8) * (1.0f / 16777216.0f);
        values[i] = u * u;
    }
}

static double squared_distance(const gscl_kmeans_points *points, uint32_t i, const float *centroid) {
    double sum = 0.0;
    for (uint32_t d = 0; d < points->dims; d++) {
        const double metric = points->metric ? points->metric[d] : 1.0;
        const double difference = ((double)points->values[(size_t)i * points->dims + d] - centroid[d]) * metric;
        sum += difference * difference;
    }
    return sum;
}

bool clusters_are_consistent(const gscl_kmeans_points *points, const float *centroids, const uint32_t *assignment,
                             const gscl_kmeans_result *result) {
    double total = 0.0;
    uint32_t *members = calloc(result->clusters + 1, sizeof *members);
    bool good = members != NULL;
    for (uint32_t i = 0; i < points->count && good; i++) {
        double best = INFINITY, own = INFINITY;
        for (uint32_t k = 0; k < result->clusters; k++) {
            const double distance = squared_distance(points, i, centroids + (size_t)k * points->dims);
            best = distance < best ? distance : best;
            own = k == assignment[i] ? distance : own;
        }
        good = assignment[i] < result->clusters && own <= best;
        if (good)
            members[assignment[i]]++;
        total += own * (points->weights ? points->weights[i] : 1.0);
    }
    for (uint32_t k = 0; k < result->clusters && good; k++)
        good = members[k] > 0;
    free(members);
    return good && fabs(total - result->distortion) <= 1e-12 + 1e-9 * total;
}
