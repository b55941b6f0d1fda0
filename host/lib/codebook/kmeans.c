#include "codebook/kmeans.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* The state of one run.  Arrays marked * are owned and freed at the end. */
typedef struct kmeans_run {
    const gscl_kmeans_points *points;
    float metric[GSCL_KMEANS_MAX_DIMS];
    float *centroids;     /* caller's, [max_clusters][dims] */
    uint32_t *assignment; /* caller's, [count] */
    double *distance;     /* * [count]: squared, to the assigned centroid, not weighted */
    double *sums;         /* * [max_clusters][dims + 1]: weighted sums of members, then their weight */
    uint32_t *members;    /* * [max_clusters] */
    uint32_t clusters;    /* rows of centroids in use */
} kmeans_run;

/* xorshift64* (Marsaglia, Vigna); the state is never 0.  The rest of the encoder uses SplitMix64 (fit/random.h).  With
 * that generator here the draws, and so the bytes of every file of the paper profile, would change. */
static uint64_t next_random(uint64_t *state) {
    uint64_t x = *state;
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    *state = x;
    return x * UINT64_C(0x2545F4914F6CDD1D);
}

/* Uniform in [0, 1). */
static double random_unit(uint64_t *state) {
    return (double)(next_random(state) >> 11) * 0x1p-53;
}

/* Spreads neighbouring seeds over all 64 bits (splitmix64's finaliser). */
static uint64_t state_from_seed(uint64_t seed) {
    uint64_t z = seed + UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return z ? z : 1;
}

static const float *point_at(const kmeans_run *run, uint32_t i) {
    return run->points->values + (size_t)i * run->points->dims;
}

static float *centroid_at(const kmeans_run *run, uint32_t k) {
    return run->centroids + (size_t)k * run->points->dims;
}

static double weight_at(const kmeans_run *run, uint32_t i) {
    return run->points->weights ? run->points->weights[i] : 1.0;
}

static double squared_distance(const kmeans_run *run, const float *a, const float *b) {
    double sum = 0.0;
    for (uint32_t d = 0; d < run->points->dims; d++) {
        const double difference = ((double)a[d] - b[d]) * run->metric[d];
        sum += difference * difference;
    }
    return sum;
}

/* Assigns to centroid `k` every point that is nearer to it than to its own centroid. */
static void assign_nearer_points(kmeans_run *run, uint32_t k) {
    for (uint32_t i = 0; i < run->points->count; i++) {
        const double distance = squared_distance(run, point_at(run, i), centroid_at(run, k));
        if (distance < run->distance[i]) {
            run->distance[i] = distance;
            run->assignment[i] = k;
        }
    }
}

/* Assigns every point to its nearest centroid, of equally near ones to the first; returns whether any assignment
 * changed. */
static bool assign_points(kmeans_run *run) {
    bool changed = false;
    memset(run->members, 0, run->clusters * sizeof *run->members);
    for (uint32_t i = 0; i < run->points->count; i++) {
        double best = INFINITY;
        uint32_t nearest = 0;
        for (uint32_t k = 0; k < run->clusters; k++) {
            const double distance = squared_distance(run, point_at(run, i), centroid_at(run, k));
            if (distance < best) {
                best = distance;
                nearest = k;
            }
        }
        changed |= run->assignment[i] != nearest;
        run->assignment[i] = nearest;
        run->distance[i] = best;
        run->members[nearest]++;
    }
    return changed;
}

/* The point of largest weighted squared distance, among the clusters of two points or more; `count` if all these
 * distances are 0. */
static uint32_t farthest_point(const kmeans_run *run) {
    uint32_t farthest = run->points->count;
    double max_cost = 0.0;
    for (uint32_t i = 0; i < run->points->count; i++) {
        const double cost = weight_at(run, i) * run->distance[i];
        if (cost > max_cost && run->members[run->assignment[i]] > 1) {
            max_cost = cost;
            farthest = i;
        }
    }
    return farthest;
}

/* Moves the farthest point to each cluster without members, as long as there is one; returns whether any was moved. */
static bool refill_empty_clusters(kmeans_run *run) {
    bool moved = false;
    for (uint32_t k = 0; k < run->clusters; k++) {
        if (run->members[k] > 0)
            continue;
        const uint32_t i = farthest_point(run);
        if (i == run->points->count)
            break;
        run->members[run->assignment[i]]--;
        run->members[k] = 1;
        run->assignment[i] = k;
        run->distance[i] = 0.0;
        moved = true;
    }
    return moved;
}

/* Moves every centroid to the weighted mean of its members; it stays if their weights are all 0. */
static void update_centroids(kmeans_run *run) {
    const uint32_t dims = run->points->dims;
    memset(run->sums, 0, (size_t)run->clusters * (dims + 1) * sizeof *run->sums);
    for (uint32_t i = 0; i < run->points->count; i++) {
        double *sum = run->sums + (size_t)run->assignment[i] * (dims + 1);
        const double weight = weight_at(run, i);
        for (uint32_t d = 0; d < dims; d++)
            sum[d] += weight * point_at(run, i)[d];
        sum[dims] += weight;
    }
    for (uint32_t k = 0; k < run->clusters; k++) {
        const double *sum = run->sums + (size_t)k * (dims + 1);
        if (sum[dims] <= 0.0)
            continue;
        for (uint32_t d = 0; d < dims; d++)
            centroid_at(run, k)[d] = (float)(sum[d] / sum[dims]);
    }
}

/* Draws a point with probability proportional to its weight times its squared distance to the nearest centroid, or to
 * its weight alone for the first centroid; `count` if all these products are 0, that is if every distinct point is a
 * centroid. */
static uint32_t draw_point(const kmeans_run *run, uint64_t *state) {
    const bool first = run->clusters == 0;
    double total = 0.0;
    for (uint32_t i = 0; i < run->points->count; i++)
        total += weight_at(run, i) * (first ? 1.0 : run->distance[i]);
    double left = random_unit(state) * total;
    uint32_t drawn = run->points->count;
    for (uint32_t i = 0; i < run->points->count; i++) {
        const double part = weight_at(run, i) * (first ? 1.0 : run->distance[i]);
        if (part <= 0.0)
            continue;
        drawn = i; /* rounding may leave some of `left` after the last point */
        if (left < part)
            break;
        left -= part;
    }
    return drawn;
}

/* Keeps the first `warm` centroids and draws the others, up to `max_clusters` (k-means++). */
static void seed_centroids(kmeans_run *run, uint32_t warm, uint32_t max_clusters, uint64_t seed) {
    uint64_t state = state_from_seed(seed);
    for (uint32_t i = 0; i < run->points->count; i++) {
        run->distance[i] = INFINITY;
        run->assignment[i] = 0;
    }
    for (run->clusters = 0; run->clusters < warm; run->clusters++)
        assign_nearer_points(run, run->clusters);
    while (run->clusters < max_clusters) {
        const uint32_t i = draw_point(run, &state);
        if (i == run->points->count)
            break;
        memcpy(centroid_at(run, run->clusters), point_at(run, i), run->points->dims * sizeof(float));
        assign_nearer_points(run, run->clusters);
        run->clusters++;
    }
}

/* If all weights are 0, k-means++ draws no centroid: the first point becomes the only one. */
static void ensure_one_centroid(kmeans_run *run) {
    if (run->clusters > 0)
        return;
    memcpy(centroid_at(run, 0), point_at(run, 0), run->points->dims * sizeof(float));
    run->clusters = 1;
}

/* Removes centroids without members, moves the others up and renumbers the assignment. */
static void drop_empty_clusters(kmeans_run *run) {
    const size_t row = run->points->dims * sizeof(float);
    uint32_t kept = 0;
    for (uint32_t k = 0; k < run->clusters; k++) {
        if (run->members[k] == 0)
            continue;
        memmove(centroid_at(run, kept), centroid_at(run, k), row);
        run->members[k] = kept++; /* its new index */
    }
    for (uint32_t i = 0; i < run->points->count; i++)
        run->assignment[i] = run->members[run->assignment[i]];
    run->clusters = kept;
}

/* Lloyd's iterations.  Every point ends at its nearest centroid; returns the number of iterations. */
static uint32_t run_lloyd(kmeans_run *run, uint32_t max_iterations) {
    uint32_t done = 0;
    assign_points(run);
    while (done < max_iterations) {
        const bool moved = refill_empty_clusters(run);
        update_centroids(run);
        const bool changed = assign_points(run);
        done++;
        if (!moved && !changed)
            break;
    }
    return done;
}

static double total_distortion(const kmeans_run *run) {
    double sum = 0.0;
    for (uint32_t i = 0; i < run->points->count; i++)
        sum += weight_at(run, i) * run->distance[i];
    return sum;
}

static bool all_finite(const float *values, size_t count, bool negative_too) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]) || (!negative_too && values[i] < 0.0f))
            return false;
    return true;
}

static bool arguments_valid(const gscl_kmeans_points *points, const gscl_kmeans_options *options,
                            const float *centroids) {
    if (points->dims < 1 || points->dims > GSCL_KMEANS_MAX_DIMS || points->count > GSCL_KMEANS_MAX_POINTS ||
        options->clusters < 1 || options->clusters > GSCL_KMEANS_MAX_CLUSTERS || options->warm > options->clusters)
        return false;
    return all_finite(points->values, (size_t)points->count * points->dims, true) &&
           (!points->weights || all_finite(points->weights, points->count, false)) &&
           (!points->metric || all_finite(points->metric, points->dims, false)) &&
           all_finite(centroids, (size_t)options->warm * points->dims, true);
}

/* Allocates the working arrays; on failure the caller calls run_free as well. */
static bool run_allocate(kmeans_run *run, uint32_t max_clusters) {
    for (uint32_t d = 0; d < run->points->dims; d++)
        run->metric[d] = run->points->metric ? run->points->metric[d] : 1.0f;
    run->distance = malloc(run->points->count * sizeof *run->distance);
    run->sums = malloc((size_t)max_clusters * (run->points->dims + 1) * sizeof *run->sums);
    run->members = malloc(max_clusters * sizeof *run->members);
    return run->distance && run->sums && run->members;
}

static void run_free(kmeans_run *run) {
    free(run->distance);
    free(run->sums);
    free(run->members);
}

gscl_kmeans_status gscl_kmeans_cluster(const gscl_kmeans_points *points, const gscl_kmeans_options *options,
                                       float *centroids, uint32_t *assignment, gscl_kmeans_result *result) {
    *result = (gscl_kmeans_result){0};
    if (!arguments_valid(points, options, centroids))
        return GSCL_KMEANS_INVALID;
    if (points->count == 0)
        return GSCL_KMEANS_OK;
    kmeans_run run = {.points = points, .centroids = centroids, .assignment = assignment};
    /* More drawn centroids than points would stay empty; warm centroids are all used. */
    uint32_t max_clusters = options->clusters < points->count ? options->clusters : points->count;
    if (max_clusters < options->warm)
        max_clusters = options->warm;
    gscl_kmeans_status status = GSCL_KMEANS_NO_MEMORY;
    if (run_allocate(&run, max_clusters)) {
        seed_centroids(&run, options->warm, max_clusters, options->seed);
        ensure_one_centroid(&run);
        result->iterations = run_lloyd(&run, options->iterations);
        result->distortion = total_distortion(&run);
        drop_empty_clusters(&run);
        result->clusters = run.clusters;
        status = GSCL_KMEANS_OK;
    }
    run_free(&run);
    return status;
}
