#include "codebook/codebook_cluster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "codebook/kmeans.h"
#include "codebook/tunables.h"
#include "decode/dequantise.h"
#include "fit/random.h"
#include "runtime/elementary.h"

static const float pi = 3.14159265f;

static float logistic(float x) {
    return 1.0f / (1.0f + (float)gscl_exp(-x));
}

static float hyperbolic_sine(float x) {
    const double power = gscl_exp(x);
    return (float)(0.5 * (power - 1.0 / power));
}

/* The axes, the longer first, and the angle of the longer one. */
static void canonical_shape(const float *p, float *major, float *minor, float *theta) {
    bool swap = p[GSCL_LOG_S1] < p[GSCL_LOG_S2];
    *major = p[swap ? GSCL_LOG_S2 : GSCL_LOG_S1];
    *minor = p[swap ? GSCL_LOG_S1 : GSCL_LOG_S2];
    *theta = p[GSCL_THETA] + (swap ? pi / 2 : 0);
}

/* ---- Points of the clustering ---- */

/* Shapes as points whose distance is the relative change of the splat: |dG/d ln s| / |G| = 0.87, and
 * |dG/d theta| / |G| = sinh(ln aspect), with the double angle because half a turn changes nothing. */
static void embed_shape(const float *p, float *point) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    float major, minor, theta;
    canonical_shape(p, &major, &minor, &theta);
    float radius = 0.5f * hyperbolic_sine(fminf(major - minor, t->max_log_aspect));
    point[0] = t->scale_metric * major;
    point[1] = t->scale_metric * minor;
    point[2] = radius * (float)gscl_cos(2 * theta);
    point[3] = radius * (float)gscl_sin(2 * theta);
}

static void embed_colour(const gscl_codebook *c, const float *p, float *point) {
    int n = gscl_codebook_channels(c);
    memcpy(point, p + GSCL_COLOUR, (size_t)n * sizeof(float));
    if (n < GSCL_KMEANS_MAX_DIMS)
        point[n] = gscl_codebook_tunables.opacity_metric * logistic(p[GSCL_OPACITY]);
}

static void embed_splat(const gscl_codebook *c, int book, const float *p, float *point) {
    if (book == GSCL_BOOK_SHAPE)
        embed_shape(p, point);
    else
        embed_colour(c, p, point);
}

static int embedded_dims(const gscl_codebook *c, int book) {
    const int channels = gscl_codebook_channels(c);
    return book == GSCL_BOOK_SHAPE ? 4 : channels + (channels < GSCL_KMEANS_MAX_DIMS ? 1 : 0);
}

/* The weight of a splat in its cluster: the light that it contributes to the rendering. */
static float splat_weight(const float *p) {
    return (float)gscl_exp(0.5f * (p[GSCL_LOG_S1] + p[GSCL_LOG_S2])) * logistic(p[GSCL_OPACITY]);
}

/* The current words as starting points. */
static void embed_words(const gscl_codebook *c, int book, int count, float *points) {
    const int dims = embedded_dims(c, book);
    for (int k = 0; k < count; k++) {
        float params[GSCL_PARAMS] = {0};
        const float *word = c->books[book].words + k * GSCL_BOOK_DIMS;
        if (book == GSCL_BOOK_SHAPE) {
            memcpy(params + GSCL_LOG_S1, word, GSCL_BOOK_SHAPE_DIMS * sizeof(float));
        } else {
            memcpy(params + GSCL_COLOUR, word, (size_t)gscl_codebook_channels(c) * sizeof(float));
            params[GSCL_OPACITY] = word[gscl_codebook_channels(c)];
        }
        embed_splat(c, book, params, points + k * dims);
    }
}

/* ---- Means of the clusters in the words' own units ---- */

/* Weighted sums over the members of one word. */
typedef struct member_sums {
    double sum[GSCL_BOOK_DIMS], weight;
} member_sums;

static void add_member(const gscl_codebook *c, int book, const float *p, member_sums *m) {
    float w = splat_weight(p);
    m->weight += w;
    if (book == GSCL_BOOK_COLOUR) {
        const int channels = gscl_codebook_channels(c);
        for (int k = 0; k < channels; k++)
            m->sum[k] += w * p[GSCL_COLOUR + k];
        m->sum[channels] += w * logistic(p[GSCL_OPACITY]);
        return;
    }
    float major, minor, theta;
    canonical_shape(p, &major, &minor, &theta);
    /* The direction of a nearly circular splat has little weight. */
    float length = w * (major - minor + gscl_codebook_tunables.direction_offset);
    m->sum[0] += w * major;
    m->sum[1] += w * minor;
    m->sum[2] += length * (float)gscl_cos(2 * theta);
    m->sum[3] += length * (float)gscl_sin(2 * theta);
}

/* Sets a word to the mean of its members; a word whose members weigh nothing stays. */
static void set_word_to_mean(const gscl_codebook *c, int book, const member_sums *m, float *word) {
    const struct gscl_codebook_tunables *t = &gscl_codebook_tunables;
    if (!(m->weight > 0))
        return;
    if (book == GSCL_BOOK_COLOUR) {
        const int channels = gscl_codebook_channels(c);
        for (int k = 0; k < channels; k++)
            word[k] = (float)(m->sum[k] / m->weight);
        word[channels] =
            gscl_logit(fmin(fmax(m->sum[channels] / m->weight, t->min_opacity_of_word), t->max_opacity_of_word));
        return;
    }
    word[0] = (float)(m->sum[0] / m->weight);
    word[1] = (float)(m->sum[1] / m->weight);
    word[2] = (float)(0.5 * gscl_atan2(m->sum[3], m->sum[2]));
    if (word[2] < 0)
        word[2] += pi;
}

static gscl_result set_words_to_means(gscl_codebook *c, int book) {
    const size_t splats = gscl_codebook_splats(c);
    member_sums *all = calloc((size_t)c->books[book].count, sizeof *all);
    if (!all)
        return gscl_fail_memory(c->fit->context);
    for (size_t i = 0; i < splats; i++)
        add_member(c, book, c->params + i * GSCL_PARAMS, &all[c->pairs[i][book]]);
    for (int k = 0; k < c->books[book].count; k++)
        set_word_to_mean(c, book, &all[k], c->books[book].words + k * GSCL_BOOK_DIMS);
    free(all);
    return GSCL_OK;
}

/* ---- One book ---- */

typedef struct cluster_arrays {
    float *points, *weights; /* of each splat */
    float *centroids;        /* of each word */
    uint32_t *assignment;    /* of each splat */
} cluster_arrays;

static bool cluster_arrays_allocate(cluster_arrays *a, size_t splats, size_t words, size_t dims) {
    a->points = malloc((splats + 1) * dims * sizeof *a->points);
    a->weights = malloc((splats + 1) * sizeof *a->weights);
    a->centroids = calloc(words * dims, sizeof *a->centroids);
    a->assignment = malloc((splats + 1) * sizeof *a->assignment);
    return a->points && a->weights && a->centroids && a->assignment;
}

static void cluster_arrays_free(cluster_arrays *a) {
    free(a->points);
    free(a->weights);
    free(a->centroids);
    free(a->assignment);
}

static gscl_kmeans_status cluster_splats(gscl_codebook *c, int book, int words, bool warm, uint64_t *random,
                                         cluster_arrays *a) {
    const size_t n = gscl_codebook_splats(c);
    const int dims = embedded_dims(c, book);
    int start = warm ? c->books[book].count : 0;
    if (start > words)
        start = words;
    for (size_t i = 0; i < n; i++) {
        const float *p = c->params + i * GSCL_PARAMS;
        embed_splat(c, book, p, a->points + i * (size_t)dims);
        a->weights[i] = splat_weight(p);
    }
    embed_words(c, book, start, a->centroids);
    const gscl_kmeans_points points = {a->points, a->weights, NULL, (uint32_t)n, (uint32_t)dims};
    const gscl_kmeans_options options = {(uint32_t)words, (uint32_t)start,
                                         (uint32_t)gscl_codebook_tunables.kmeans_iterations, gscl_random(random)};
    gscl_kmeans_result result;
    gscl_kmeans_status status = gscl_kmeans_cluster(&points, &options, a->centroids, a->assignment, &result);
    for (size_t i = 0; i < n && status == GSCL_KMEANS_OK; i++)
        c->pairs[i][book] = (int32_t)a->assignment[i];
    c->books[book].count = (int)result.clusters;
    return status;
}

static gscl_result cluster_book(gscl_codebook *c, int book, int words, bool warm, uint64_t *random) {
    cluster_arrays arrays = {0};
    gscl_kmeans_status status = GSCL_KMEANS_NO_MEMORY;
    if (cluster_arrays_allocate(&arrays, gscl_codebook_splats(c), (size_t)words, (size_t)embedded_dims(c, book)))
        status = cluster_splats(c, book, words, warm, random, &arrays);
    cluster_arrays_free(&arrays);
    if (status == GSCL_KMEANS_NO_MEMORY)
        return gscl_fail_memory(c->fit->context);
    if (status != GSCL_KMEANS_OK)
        return gscl_fail(c->fit->context, GSCL_ERROR_DEVICE_FAILED,
                         "the fit has parameters that are not finite and cannot be clustered");
    return set_words_to_means(c, book);
}

gscl_result gscl_codebook_cluster(gscl_codebook *c, int shapes, int colours, bool warm, uint64_t *random) {
    GSCL_TRY(gscl_codebook_read_back(c));
    GSCL_TRY(cluster_book(c, GSCL_BOOK_SHAPE, shapes, warm, random));
    GSCL_TRY(cluster_book(c, GSCL_BOOK_COLOUR, colours, warm, random));
    return gscl_codebook_upload(c);
}
