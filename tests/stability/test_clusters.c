/* K-means on degenerate sets of points. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "report.h"
#include "synthetic_clusters.h"

#define POINTS 2000
#define CLUSTERS 64
#define DIMS 5
#define MAX_ITERATIONS 500
#define ROUNDED 0x1p-24 /* relative error of rounding a mean to float */

/* A hard case: points and their weights, k, and the initial centroids of a warm start. */
typedef struct {
    const char *name;
    uint32_t count, dims, clusters, warm, expected; /* expected: number of words in the result, 0 for any */
    bool weighted, scaled;
    float values[POINTS * DIMS], weights[POINTS], metric[DIMS], start[CLUSTERS * DIMS];
} problem;

typedef struct {
    float centroids[CLUSTERS * DIMS];
    uint32_t assignment[POINTS];
    gscl_kmeans_result result;
} solution;

static void cluster_problem(const problem *p, uint32_t iterations, solution *s) {
    const gscl_kmeans_points points = {p->values, p->weighted ? p->weights : NULL, p->scaled ? p->metric : NULL,
                                       p->count, p->dims};
    const gscl_kmeans_options options = {.clusters = p->clusters, .warm = p->warm, .iterations = iterations, .seed = 3};
    memset(s, 0, sizeof *s);
    memcpy(s->centroids, p->start, sizeof s->centroids);
    assert_int_equal(gscl_kmeans_cluster(&points, &options, s->centroids, s->assignment, &s->result), GSCL_KMEANS_OK);
    assert_true(clusters_are_consistent(&points, s->centroids, s->assignment, &s->result));
    assert_true(isfinite(s->result.distortion));
}

/* The distance of a word from the weighted mean of its members, relative to the size of the members. */
static double error_of_mean(const problem *p, const solution *s, uint32_t word, uint32_t dim) {
    double sum = 0.0, weight = 0.0, size = 0.0;
    for (uint32_t i = 0; i < p->count; i++) {
        const double w = p->weighted ? p->weights[i] : 1.0, value = p->values[i * p->dims + dim];
        if (s->assignment[i] != word)
            continue;
        sum += w * value;
        weight += w;
        size = fmax(size, fabs(value));
    }
    return weight > 0.0 && size > 0.0 ? fabs(s->centroids[word * p->dims + dim] - sum / weight) / size : 0.0;
}

static void check_problem(const problem *p) {
    static solution first, second;
    double worst = 0.0;
    cluster_problem(p, MAX_ITERATIONS, &first);
    cluster_problem(p, MAX_ITERATIONS, &second);
    assert_memory_equal(&first, &second, sizeof first);
    if (first.result.iterations >= MAX_ITERATIONS)
        fail_msg("%s: no end after %u iterations", p->name, first.result.iterations);
    if (p->expected && first.result.clusters != p->expected)
        fail_msg("%s: %u words, %u expected", p->name, first.result.clusters, p->expected);
    for (uint32_t k = 0; k < first.result.clusters; k++)
        for (uint32_t d = 0; d < p->dims; d++)
            worst = fmax(worst, error_of_mean(p, &first, k, d));
    report("k-means", p->name, "", "word off its members' mean, relative", ROUNDED, worst);
    if (worst > ROUNDED)
        fail_msg("%s: a word is off its members' mean by %g of their size", p->name, worst);
}

static problem *cloud(const char *name, uint32_t count, uint32_t dims, uint32_t clusters) {
    static problem p;
    memset(&p, 0, sizeof p);
    p.name = name;
    p.count = count;
    p.dims = dims;
    p.clusters = clusters;
    synthetic_points(p.values, count, dims, 7);
    return &p;
}

static void test_equal_points(void **state) {
    (void)state;
    problem *p = cloud("all points equal", POINTS, 4, CLUSTERS);
    for (uint32_t i = 4; i < POINTS * 4; i++)
        p->values[i] = p->values[i % 4];
    p->expected = 1;
    check_problem(p);
    p->warm = CLUSTERS; /* as many equal words */
    p->name = "all points equal, words too";
    for (uint32_t i = 0; i < CLUSTERS * 4; i++)
        p->start[i] = p->values[i % 4];
    check_problem(p);
}

static void test_few_points(void **state) {
    (void)state;
    problem *p = cloud("fewer points than k", CLUSTERS - 10, 3, CLUSTERS);
    p->expected = CLUSTERS - 10;
    check_problem(p);
    p = cloud("one point", 1, 5, CLUSTERS);
    p->expected = 1;
    check_problem(p);
    p = cloud("two values, many points", POINTS, 1, CLUSTERS);
    for (uint32_t i = 0; i < POINTS; i++)
        p->values[i] = (float)(i % 2);
    p->expected = 2;
    check_problem(p);
}

static void test_one_cluster(void **state) {
    (void)state;
    problem *p = cloud("k = 1", POINTS, 5, 1);
    p->expected = 1;
    check_problem(p);
}

/* Words without members restart at the farthest points. */
static void test_empty_clusters(void **state) {
    (void)state;
    problem *p = cloud("words far from all points", POINTS, 2, CLUSTERS);
    p->warm = p->expected = CLUSTERS;
    for (uint32_t i = 0; i < CLUSTERS * 2; i++)
        p->start[i] = 1e6f * (float)(1 + i);
    check_problem(p);
}

static void test_duplicated_words(void **state) {
    (void)state;
    problem *p = cloud("duplicated words", POINTS, 3, CLUSTERS);
    p->warm = p->expected = CLUSTERS;
    for (uint32_t i = 0; i < CLUSTERS * 3; i++)
        p->start[i] = i / 3 % 2 ? 0.25f : 0.5f;
    check_problem(p);
}

static void test_scales(void **state) {
    (void)state;
    static const float scales[DIMS] = {1e-30f, 1e-6f, 1.0f, 1e6f, 1e30f};
    problem *p = cloud("coordinates from 10^-30 to 10^30", POINTS, DIMS, CLUSTERS);
    for (uint32_t i = 0; i < POINTS * DIMS; i++)
        p->values[i] *= scales[i % DIMS];
    p->expected = CLUSTERS;
    check_problem(p);
    p->scaled = true;
    p->name = "likewise, and a metric that makes them equal";
    for (int d = 0; d < DIMS; d++)
        p->metric[d] = 1.0f / scales[d];
    check_problem(p);
    p = cloud("weights from 10^-20 to 10^20", POINTS, 2, CLUSTERS);
    p->weighted = true;
    for (uint32_t i = 0; i < POINTS; i++)
        p->weights[i] = powf(10.0f, (float)(i % 41) - 20.0f);
    check_problem(p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equal_points),     cmocka_unit_test(test_few_points),
        cmocka_unit_test(test_one_cluster),      cmocka_unit_test(test_empty_clusters),
        cmocka_unit_test(test_duplicated_words), cmocka_unit_test(test_scales),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
