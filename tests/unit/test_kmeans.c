/* K-means: edge cases, monotone distortion, determinism. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "synthetic_clusters.h"

#define POINTS 600
#define CLUSTERS 24

static void test_cloud_in_every_dimension(void **state) {
    (void)state;
    static float values[POINTS * GSCL_KMEANS_MAX_DIMS], weights[POINTS];
    synthetic_points(weights, POINTS, 1, 9);
    const float metric[GSCL_KMEANS_MAX_DIMS] = {1.0f, 3.0f, 0.5f, 0.0f, 2.0f};
    for (uint32_t dims = 1; dims <= GSCL_KMEANS_MAX_DIMS; dims++) {
        float centroids[CLUSTERS * GSCL_KMEANS_MAX_DIMS];
        uint32_t assignment[POINTS];
        gscl_kmeans_result result;
        synthetic_points(values, POINTS, dims, dims);
        const gscl_kmeans_points points = {values, weights, metric, POINTS, dims};
        const gscl_kmeans_options options = {.clusters = CLUSTERS, .iterations = 10, .seed = 5};
        assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
        assert_int_equal(result.clusters, CLUSTERS);
        assert_true(clusters_are_consistent(&points, centroids, assignment, &result));
    }
}

static void test_distortion_never_grows(void **state) {
    (void)state;
    static float values[POINTS * 3];
    synthetic_points(values, POINTS, 3, 1);
    const gscl_kmeans_points points = {.values = values, .count = POINTS, .dims = 3};
    for (uint64_t seed = 0; seed < 5; seed++) {
        double before = INFINITY;
        for (uint32_t iterations = 0; iterations < 20; iterations++) {
            float centroids[CLUSTERS * 3];
            uint32_t assignment[POINTS];
            gscl_kmeans_result result;
            const gscl_kmeans_options options = {.clusters = CLUSTERS, .iterations = iterations, .seed = seed};
            assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
            assert_true(result.distortion <= before * (1.0 + 1e-6));
            before = result.distortion;
        }
    }
}

static void test_same_twice(void **state) {
    (void)state;
    static float values[POINTS * 4];
    synthetic_points(values, POINTS, 4, 3);
    const gscl_kmeans_points points = {.values = values, .count = POINTS, .dims = 4};
    const gscl_kmeans_options options = {.clusters = CLUSTERS, .iterations = 10, .seed = 77};
    float centroids[2][CLUSTERS * 4] = {{0}};
    uint32_t assignment[2][POINTS];
    gscl_kmeans_result result[2];
    for (int run = 0; run < 2; run++)
        assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids[run], assignment[run], &result[run]),
                         GSCL_KMEANS_OK);
    assert_memory_equal(centroids[0], centroids[1], sizeof centroids[0]);
    assert_memory_equal(assignment[0], assignment[1], sizeof assignment[0]);
    assert_true(result[0].distortion == result[1].distortion);
    assert_int_equal(result[0].iterations, result[1].iterations);
}

static void test_seed_matters(void **state) {
    (void)state;
    static float values[POINTS * 2];
    synthetic_points(values, POINTS, 2, 3);
    const gscl_kmeans_points points = {.values = values, .count = POINTS, .dims = 2};
    float centroids[2][CLUSTERS * 2];
    uint32_t assignment[POINTS];
    gscl_kmeans_result result;
    for (uint64_t seed = 0; seed < 2; seed++) {
        const gscl_kmeans_options options = {.clusters = CLUSTERS, .seed = seed};
        assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids[seed], assignment, &result), GSCL_KMEANS_OK);
    }
    assert_memory_not_equal(centroids[0], centroids[1], sizeof centroids[0]);
}

static void test_finds_separate_clumps(void **state) {
    (void)state;
    const float values[8] = {0.0f, 0.5f, 10.0f, 10.5f, 20.0f, 20.5f, 30.0f, 30.5f};
    const gscl_kmeans_points points = {.values = values, .count = 8, .dims = 1};
    for (uint64_t seed = 0; seed < 20; seed++) {
        float centroids[4];
        uint32_t assignment[8];
        gscl_kmeans_result result;
        const gscl_kmeans_options options = {.clusters = 4, .iterations = 50, .seed = seed};
        assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
        assert_int_equal(result.clusters, 4);
        assert_true(fabs(result.distortion - 0.5) < 1e-6);
        for (int i = 0; i < 8; i += 2)
            assert_int_equal(assignment[i], assignment[i + 1]);
    }
}

static void test_one_cluster_is_the_weighted_mean(void **state) {
    (void)state;
    const float values[6] = {0.0f, 0.0f, 4.0f, 8.0f, 1.0f, 1.0f}, weights[3] = {3.0f, 1.0f, 0.0f};
    const gscl_kmeans_points points = {.values = values, .weights = weights, .count = 3, .dims = 2};
    const gscl_kmeans_options options = {.clusters = 1, .iterations = 3, .seed = 1};
    float centroid[2];
    uint32_t assignment[3];
    gscl_kmeans_result result;
    assert_int_equal(gscl_kmeans_cluster(&points, &options, centroid, assignment, &result), GSCL_KMEANS_OK);
    assert_int_equal(result.clusters, 1);
    assert_true(centroid[0] == 1.0f && centroid[1] == 2.0f);
    assert_true(clusters_are_consistent(&points, centroid, assignment, &result));
}

static void test_fewer_points_than_clusters(void **state) {
    (void)state;
    const float values[3] = {5.0f, 1.0f, 3.0f};
    const gscl_kmeans_points points = {.values = values, .count = 3, .dims = 1};
    const gscl_kmeans_options options = {.clusters = CLUSTERS, .iterations = 10, .seed = 2};
    float centroids[CLUSTERS];
    uint32_t assignment[3];
    gscl_kmeans_result result;
    assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
    assert_int_equal(result.clusters, 3);
    assert_true(result.distortion == 0.0);
    for (int i = 0; i < 3; i++)
        assert_true(centroids[assignment[i]] == values[i]);
}

static void test_all_points_equal(void **state) {
    (void)state;
    float values[40];
    for (int i = 0; i < 40; i++)
        values[i] = i % 2 ? 0.25f : -3.5f;
    const gscl_kmeans_points points = {.values = values, .count = 20, .dims = 2};
    const gscl_kmeans_options options = {.clusters = CLUSTERS, .iterations = 10, .seed = 2};
    float centroids[CLUSTERS * 2];
    uint32_t assignment[20];
    gscl_kmeans_result result;
    assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
    assert_int_equal(result.clusters, 1);
    assert_true(result.distortion == 0.0 && centroids[0] == -3.5f && centroids[1] == 0.25f);
}

static void test_no_points_and_no_weight(void **state) {
    (void)state;
    const float values[2] = {1.0f, 2.0f}, weights[2] = {0.0f, 0.0f};
    gscl_kmeans_points points = {.values = values, .count = 0, .dims = 1};
    const gscl_kmeans_options options = {.clusters = 4, .iterations = 10};
    float centroids[4];
    uint32_t assignment[2];
    gscl_kmeans_result result;
    assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
    assert_int_equal(result.clusters, 0);
    points.count = 2;
    points.weights = weights;
    assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
    assert_int_equal(result.clusters, 1);
    assert_true(centroids[0] == 1.0f);
}

/* Equal starting points: all clusters but one become empty and restart at the farthest points. */
static void test_duplicate_warm_start_recovers(void **state) {
    (void)state;
    const float values[4] = {0.0f, 1.0f, 10.0f, 30.0f};
    const gscl_kmeans_points points = {.values = values, .count = 4, .dims = 1};
    const gscl_kmeans_options options = {.clusters = 4, .warm = 4, .iterations = 10};
    float centroids[4] = {0.5f, 0.5f, 0.5f, 0.5f};
    uint32_t assignment[4];
    gscl_kmeans_result result;
    assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
    assert_int_equal(result.clusters, 4);
    assert_true(result.distortion == 0.0);
}

/* Without iterations no centroid moves; code words without members are dropped, the others keep their order. */
static void test_warm_start_drops_unused(void **state) {
    (void)state;
    const float values[4] = {0.0f, 0.1f, 9.0f, 9.1f};
    const gscl_kmeans_points points = {.values = values, .count = 4, .dims = 1};
    const gscl_kmeans_options options = {.clusters = 6, .warm = 6, .iterations = 0};
    float centroids[6] = {50.0f, 9.0f, 9.0f, 60.0f, 0.0f, 70.0f};
    uint32_t assignment[4];
    gscl_kmeans_result result;
    assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
    assert_int_equal(result.clusters, 2);
    assert_true(centroids[0] == 9.0f && centroids[1] == 0.0f);
    assert_int_equal(assignment[0], 1);
    assert_int_equal(assignment[2], 0);
}

/* The rows after the warm ones are drawn from the points that are not at a warm centroid. */
static void test_warm_start_is_completed(void **state) {
    (void)state;
    const float values[3] = {0.0f, 5.0f, 9.0f};
    const gscl_kmeans_points points = {.values = values, .count = 3, .dims = 1};
    const gscl_kmeans_options options = {.clusters = 3, .warm = 1, .iterations = 5, .seed = 4};
    float centroids[3] = {5.0f};
    uint32_t assignment[3];
    gscl_kmeans_result result;
    assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
    assert_int_equal(result.clusters, 3);
    assert_true(centroids[0] == 5.0f && result.distortion == 0.0);
}

static void test_metric_decides(void **state) {
    (void)state;
    const float values[8] = {0.0f, 0.0f, 0.0f, 10.0f, 4.0f, 0.0f, 4.0f, 10.0f};
    const float metrics[2][2] = {{1.0f, 0.1f}, {0.1f, 1.0f}};
    for (int m = 0; m < 2; m++) {
        const gscl_kmeans_points points = {.values = values, .metric = metrics[m], .count = 4, .dims = 2};
        const gscl_kmeans_options options = {.clusters = 2, .warm = 2, .iterations = 10};
        float centroids[4] = {1.0f, 4.0f, 3.0f, 6.0f};
        uint32_t assignment[4];
        gscl_kmeans_result result;
        assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_OK);
        assert_int_equal(result.clusters, 2);
        assert_int_equal(assignment[0], assignment[m == 0 ? 1 : 2]);
        assert_int_not_equal(assignment[0], assignment[m == 0 ? 2 : 1]);
    }
}

static void test_bad_arguments(void **state) {
    (void)state;
    float values[2] = {1.0f, 2.0f}, weights[2] = {1.0f, -1.0f}, metric[1] = {1.0f}, centroids[2] = {0.0f};
    uint32_t assignment[2];
    gscl_kmeans_result result;
    gscl_kmeans_points points = {.values = values, .count = 2, .dims = 1};
    gscl_kmeans_options options = {.clusters = 2, .iterations = 1};
#define EXPECT_INVALID() \
    assert_int_equal(gscl_kmeans_cluster(&points, &options, centroids, assignment, &result), GSCL_KMEANS_INVALID)
    options.clusters = 0;
    EXPECT_INVALID();
    options.clusters = GSCL_KMEANS_MAX_CLUSTERS + 1;
    EXPECT_INVALID();
    options = (gscl_kmeans_options){.clusters = 2, .warm = 3};
    EXPECT_INVALID();
    options.warm = 1;
    centroids[0] = NAN;
    EXPECT_INVALID();
    options.warm = 0;
    points.weights = weights;
    EXPECT_INVALID();
    points.weights = NULL;
    points.metric = metric;
    metric[0] = INFINITY;
    EXPECT_INVALID();
    points.metric = NULL;
    values[1] = NAN;
    EXPECT_INVALID();
    values[1] = 2.0f;
    points.dims = 0;
    EXPECT_INVALID();
    points.dims = GSCL_KMEANS_MAX_DIMS + 1;
    EXPECT_INVALID();
#undef EXPECT_INVALID
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cloud_in_every_dimension),
        cmocka_unit_test(test_distortion_never_grows),
        cmocka_unit_test(test_same_twice),
        cmocka_unit_test(test_seed_matters),
        cmocka_unit_test(test_finds_separate_clumps),
        cmocka_unit_test(test_one_cluster_is_the_weighted_mean),
        cmocka_unit_test(test_fewer_points_than_clusters),
        cmocka_unit_test(test_all_points_equal),
        cmocka_unit_test(test_no_points_and_no_weight),
        cmocka_unit_test(test_duplicate_warm_start_recovers),
        cmocka_unit_test(test_warm_start_drops_unused),
        cmocka_unit_test(test_warm_start_is_completed),
        cmocka_unit_test(test_metric_decides),
        cmocka_unit_test(test_bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
