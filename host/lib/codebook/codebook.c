#include "codebook/codebook.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "codebook/kmeans.h"
#include "decode/quantise.h"
#include "fit/random.h"

#define KMEANS_ITERATIONS 10 /* paper, section 3.3 */
#define OPACITY_METRIC 0.5f  /* of an opacity against a colour: "lower sensitivity of opacity", section 3.3 */
#define BOOK_BYTES (GSF_MAX_CODEBOOK * GSCL_BOOK_DIMS * sizeof(float))

static const float pi = 3.14159265f;

static gscl_result out_of_memory(const gscl_codebook *c) {
    return gscl_fail_memory(c->fit->context);
}
static size_t splats(const gscl_codebook *c) {
    return (size_t)c->fit->renderer.count;
}
static int channels(const gscl_codebook *c) {
    return c->fit->renderer.channels;
}

/* Host room for the splats that the fit has. */
static gscl_result reserve(gscl_codebook *c) {
    size_t count = splats(c);
    if (c->params && count <= c->capacity)
        return GSCL_OK;
    free(c->params);
    free(c->pairs);
    c->params = malloc((count + 1) * GSCL_PARAMS * sizeof(float));
    c->pairs = calloc(count + 1, sizeof *c->pairs);
    c->capacity = count;
    return c->params && c->pairs ? GSCL_OK : out_of_memory(c);
}

gscl_result gscl_codebook_create(gscl_codebook *c, gscl_fit *fit, int position_bits, int shape_bits, int colour_bits) {
    memset(c, 0, sizeof *c);
    c->fit = fit;
    c->position_bits = position_bits;
    c->books[GSCL_BOOK_SHAPE].bits = shape_bits;
    c->books[GSCL_BOOK_COLOUR].bits = colour_bits;
    for (int b = 0; b < GSCL_BOOKS; b++) {
        gscl_book *book = &c->books[b];
        book->words = calloc(1, BOOK_BYTES);
        if (!book->words)
            return out_of_memory(c);
        gscl_buffer *buffers[] = {&book->learnt, &book->stored, &book->first_moment, &book->second_moment};
        for (int i = 0; i < 4; i++)
            GSCL_TRY(gscl_buffer_reserve(fit->context, buffers[i], BOOK_BYTES));
    }
    GSCL_TRY(reserve(c));
    GSCL_TRY(
        gscl_buffer_reserve(fit->context, &c->learnt, gscl_room_for_splats(splats(c)) * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve(fit->context, &c->indices, splats(c) * sizeof(cl_int2)));
    GSCL_TRY(gscl_fit_read(fit, c->params));
    return gscl_codebook_push(c);
}

void gscl_codebook_free(gscl_codebook *c) {
    for (int b = 0; b < GSCL_BOOKS; b++) {
        gscl_book *book = &c->books[b];
        free(book->words);
        gscl_buffer *buffers[] = {&book->learnt, &book->stored, &book->first_moment, &book->second_moment};
        for (int i = 0; i < 4; i++)
            gscl_buffer_free(buffers[i]);
    }
    gscl_buffer_free(&c->learnt);
    gscl_buffer_free(&c->indices);
    free(c->params);
    free(c->pairs);
    memset(c, 0, sizeof *c);
}

gscl_result gscl_codebook_pull(gscl_codebook *c) {
    GSCL_TRY(gscl_buffer_read(c->fit->context, &c->learnt, 0, c->params, splats(c) * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_read(c->fit->context, &c->indices, 0, c->pairs, splats(c) * sizeof(cl_int2)));
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(gscl_buffer_read(c->fit->context, &c->books[b].learnt, 0, c->books[b].words, BOOK_BYTES));
    return GSCL_OK;
}

gscl_result gscl_codebook_push(gscl_codebook *c) {
    GSCL_TRY(gscl_buffer_write(c->fit->context, &c->learnt, 0, c->params, splats(c) * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_write(c->fit->context, &c->indices, 0, c->pairs, splats(c) * sizeof(cl_int2)));
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(gscl_buffer_write(c->fit->context, &c->books[b].learnt, 0, c->books[b].words, BOOK_BYTES));
    return GSCL_OK;
}

/* ---- Clustering ---- */

static float logistic(float x) {
    return 1.0f / (1.0f + expf(-x));
}

/* Axes in order and the angle of the longer one. */
static void canonical_shape(const float *p, float *major, float *minor, float *theta) {
    bool swap = p[GSCL_LOG_S1] < p[GSCL_LOG_S2];
    *major = p[swap ? GSCL_LOG_S2 : GSCL_LOG_S1];
    *minor = p[swap ? GSCL_LOG_S1 : GSCL_LOG_S2];
    *theta = p[GSCL_THETA] + (swap ? pi / 2 : 0);
}

/* Shapes as points whose distance is the relative change of the splat: |dG/d ln s| / |G| = 0.87, and
 * |dG/d theta| / |G| = sinh(ln aspect), with the double angle because half a turn changes nothing. */
static void embed_shape(const float *p, float *point) {
    float major, minor, theta;
    canonical_shape(p, &major, &minor, &theta);
    float radius = 0.5f * sinhf(fminf(major - minor, 2.2f));
    point[0] = 0.87f * major;
    point[1] = 0.87f * minor;
    point[2] = radius * cosf(2 * theta);
    point[3] = radius * sinf(2 * theta);
}

static void embed_colour(const gscl_codebook *c, const float *p, float *point) {
    int n = channels(c);
    memcpy(point, p + GSCL_COLOUR, (size_t)n * sizeof(float));
    if (n < KMEANS_MAX_DIMS)
        point[n] = OPACITY_METRIC * logistic(p[GSCL_OPACITY]);
}

/* What a splat weighs in a cluster: how much of the picture it makes. */
static float weight_of(const float *p) {
    return expf(0.5f * (p[GSCL_LOG_S1] + p[GSCL_LOG_S2])) * logistic(p[GSCL_OPACITY]);
}

/* Sums of one word's members. */
typedef struct members {
    double sum[GSCL_BOOK_DIMS], weight;
} members;

static void add_member(const gscl_codebook *c, int book, const float *p, members *m) {
    float w = weight_of(p);
    m->weight += w;
    if (book == GSCL_BOOK_COLOUR) {
        for (int k = 0; k < channels(c); k++)
            m->sum[k] += w * p[GSCL_COLOUR + k];
        m->sum[channels(c)] += w * logistic(p[GSCL_OPACITY]);
        return;
    }
    float major, minor, theta;
    canonical_shape(p, &major, &minor, &theta);
    float length = w * (major - minor + 0.05f); /* a round splat has no direction to vote for */
    m->sum[0] += w * major;
    m->sum[1] += w * minor;
    m->sum[2] += length * cosf(2 * theta);
    m->sum[3] += length * sinf(2 * theta);
}

/* The word at the middle of its members. */
static void centre(const gscl_codebook *c, int book, const members *m, float *word) {
    if (!(m->weight > 0))
        return;
    if (book == GSCL_BOOK_COLOUR) {
        for (int k = 0; k < channels(c); k++)
            word[k] = (float)(m->sum[k] / m->weight);
        word[channels(c)] = gscl_logit(fmin(fmax(m->sum[channels(c)] / m->weight, 0.011), 0.989));
        return;
    }
    word[0] = (float)(m->sum[0] / m->weight);
    word[1] = (float)(m->sum[1] / m->weight);
    word[2] = (float)(0.5 * atan2(m->sum[3], m->sum[2]));
    if (word[2] < 0)
        word[2] += pi;
}

static gscl_result recentre(gscl_codebook *c, int book) {
    members *all = calloc((size_t)c->books[book].count, sizeof *all);
    if (!all)
        return out_of_memory(c);
    for (size_t i = 0; i < splats(c); i++)
        add_member(c, book, c->params + i * GSCL_PARAMS, &all[c->pairs[i][book]]);
    for (int k = 0; k < c->books[book].count; k++)
        centre(c, book, &all[k], c->books[book].words + k * GSCL_BOOK_DIMS);
    free(all);
    return GSCL_OK;
}

/* The words there are, as starting points. */
static void embed_words(const gscl_codebook *c, int book, int dims, int count, float *points) {
    for (int k = 0; k < count; k++) {
        float params[GSCL_PARAMS] = {0};
        const float *word = c->books[book].words + k * GSCL_BOOK_DIMS;
        if (book == GSCL_BOOK_SHAPE) {
            memcpy(params + GSCL_LOG_S1, word, 3 * sizeof(float));
            embed_shape(params, points + k * dims);
        } else {
            memcpy(params + GSCL_COLOUR, word, (size_t)channels(c) * sizeof(float));
            params[GSCL_OPACITY] = word[channels(c)];
            embed_colour(c, params, points + k * dims);
        }
    }
}

static gscl_result cluster(gscl_codebook *c, int book, int words, bool warm, uint64_t *random) {
    size_t n = splats(c);
    int dims = book == GSCL_BOOK_SHAPE ? 4 : channels(c) + (channels(c) < KMEANS_MAX_DIMS ? 1 : 0);
    float *points = malloc((n + 1) * (size_t)dims * sizeof(float)), *weights = malloc((n + 1) * sizeof(float));
    float *centroids = calloc((size_t)words * (size_t)dims, sizeof(float));
    uint32_t *assignment = malloc((n + 1) * sizeof *assignment);
    kmeans_result clustered = {0};
    kmeans_status status = KMEANS_NO_MEMORY;
    if (points && weights && centroids && assignment) {
        for (size_t i = 0; i < n; i++) {
            const float *p = c->params + i * GSCL_PARAMS;
            if (book == GSCL_BOOK_SHAPE)
                embed_shape(p, points + i * (size_t)dims);
            else
                embed_colour(c, p, points + i * (size_t)dims);
            weights[i] = weight_of(p);
        }
        int start = warm ? c->books[book].count : 0;
        if (start > words)
            start = words;
        embed_words(c, book, dims, start, centroids);
        kmeans_points set = {points, weights, NULL, (uint32_t)n, (uint32_t)dims};
        kmeans_options options = {(uint32_t)words, (uint32_t)start, KMEANS_ITERATIONS, gscl_random(random)};
        status = kmeans_cluster(&set, &options, centroids, assignment, &clustered);
        for (size_t i = 0; i < n && status == KMEANS_OK; i++)
            c->pairs[i][book] = (cl_int)assignment[i];
        c->books[book].count = (int)clustered.clusters;
    }
    free(points);
    free(weights);
    free(centroids);
    free(assignment);
    if (status == KMEANS_NO_MEMORY)
        return out_of_memory(c);
    if (status != KMEANS_OK)
        return gscl_fail(c->fit->context, GSCL_ERROR_DEVICE_FAILED, "the fit gave values that cannot be clustered");
    return recentre(c, book);
}

gscl_result gscl_codebook_cluster(gscl_codebook *c, int shapes, int colours, bool warm, uint64_t *random) {
    GSCL_TRY(gscl_codebook_pull(c));
    GSCL_TRY(cluster(c, GSCL_BOOK_SHAPE, shapes, warm, random));
    GSCL_TRY(cluster(c, GSCL_BOOK_COLOUR, colours, warm, random));
    return gscl_codebook_push(c);
}

void gscl_codebook_compact(gscl_codebook *c) {
    for (int b = 0; b < GSCL_BOOKS; b++) {
        gscl_book *book = &c->books[b];
        int place[GSF_MAX_CODEBOOK], kept = 0;
        bool used[GSF_MAX_CODEBOOK] = {false};
        for (size_t i = 0; i < splats(c); i++)
            used[c->pairs[i][b]] = true;
        for (int k = 0; k < book->count; k++) {
            if (!used[k])
                continue;
            memmove(book->words + kept * GSCL_BOOK_DIMS, book->words + k * GSCL_BOOK_DIMS,
                    GSCL_BOOK_DIMS * sizeof(float));
            place[k] = kept++;
        }
        for (size_t i = 0; i < splats(c); i++)
            c->pairs[i][b] = place[c->pairs[i][b]];
        book->count = kept;
    }
}

/* ---- Order ---- */

/* Words keep s1 the longer axis; their moments are not worth turning. */
static void order_axes(gscl_book *shapes) {
    for (int k = 0; k < shapes->count; k++) {
        float *w = shapes->words + k * GSCL_BOOK_DIMS;
        if (w[0] < w[1]) {
            float t = w[0];
            w[0] = w[1];
            w[1] = t;
            w[2] += pi / 2;
        }
        w[2] -= pi * floorf(w[2] / pi);
    }
}

gscl_result gscl_codebook_sort(gscl_codebook *c, gscl_coded_image *picture) {
    size_t n = splats(c);
    GSCL_TRY(gscl_codebook_pull(c));
    order_axes(&c->books[GSCL_BOOK_SHAPE]);
    GSCL_TRY(gscl_codebook_quantise(c, picture));
    size_t *order = malloc((n + 1) * sizeof *order);
    float *params = malloc((n + 1) * GSCL_PARAMS * sizeof(float));
    cl_int(*pairs)[2] = malloc((n + 1) * sizeof *pairs);
    gscl_result result = order && params && pairs ? gscl_coded_image_sort(picture, order) : out_of_memory(c);
    if (result == GSCL_OK) {
        for (size_t i = 0; i < n; i++) {
            memcpy(params + i * GSCL_PARAMS, c->params + order[i] * GSCL_PARAMS, GSCL_PARAMS * sizeof(float));
            memcpy(pairs[i], c->pairs[order[i]], sizeof pairs[i]);
        }
        memcpy(c->params, params, n * GSCL_PARAMS * sizeof(float));
        memcpy(c->pairs, pairs, n * sizeof *pairs);
        result = gscl_fit_reorder(c->fit, order, n);
    }
    if (result == GSCL_OK)
        result = gscl_codebook_push(c);
    free(order);
    free(params);
    free(pairs);
    return result;
}

/* ---- Steps ---- */

static gscl_result quantise_book(gscl_codebook *c, int which) {
    gscl_book *book = &c->books[which];
    cl_kernel kernel;
    cl_int number = which, count = book->count, levels = (1 << book->bits) - 1;
    size_t dims = which == GSCL_BOOK_SHAPE ? 3 : (size_t)channels(c) + 1;
    GSCL_TRY(gscl_kernel(c->fit->context, GSCL_PROGRAM_CODEBOOK, &c->fit->renderer.options, "book_quantise", &kernel));
    return GSCL_LAUNCH(c->fit->context, kernel, dims, 1, GSCL_ARG_BUFFER(book->learnt), GSCL_ARG(number),
                       GSCL_ARG(count), GSCL_ARG(levels), GSCL_ARG_BUFFER(book->stored));
}

gscl_result gscl_codebook_project(gscl_codebook *c) {
    gscl_renderer *r = &c->fit->renderer;
    cl_kernel kernel;
    cl_float2 cell = {{(float)c->fit->pyramid.width / (float)(1 << c->position_bits),
                       (float)c->fit->pyramid.height / (float)(1 << c->position_bits)}};
    cl_int2 last = {{(1 << c->position_bits) - 1, (1 << c->position_bits) - 1}};
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(quantise_book(c, b));
    GSCL_TRY(gscl_kernel(r->context, GSCL_PROGRAM_CODEBOOK, &r->options, "book_apply", &kernel));
    GSCL_TRY(GSCL_LAUNCH(r->context, kernel, gscl_groups(splats(c), GSCL_SPLATS_PER_GROUP), GSCL_SPLATS_PER_GROUP,
                         GSCL_ARG_BUFFER(c->learnt), GSCL_ARG_BUFFER(c->indices), GSCL_ARG_BUFFER(c->books[0].stored),
                         GSCL_ARG_BUFFER(c->books[1].stored), GSCL_ARG(r->count), GSCL_ARG(cell), GSCL_ARG(last),
                         GSCL_ARG_BUFFER(r->params)));
    return gscl_renderer_project(r);
}

gscl_result gscl_codebook_step_through(gscl_codebook *c, float rate) {
    GSCL_TRY(gscl_codebook_project(c));
    GSCL_TRY(gscl_fit_differentiate(c->fit));
    return gscl_fit_adam(c->fit, &c->learnt, rate);
}

static gscl_result step_book(gscl_codebook *c, int which) {
    gscl_book *book = &c->books[which];
    gscl_fit *f = c->fit;
    cl_kernel kernel;
    cl_int number = which, count = book->count, age = c->age;
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_CODEBOOK, &f->renderer.options, "book_step", &kernel));
    return GSCL_LAUNCH(f->context, kernel, (size_t)count, 1, GSCL_ARG_BUFFER(book->learnt),
                       GSCL_ARG_BUFFER(book->first_moment), GSCL_ARG_BUFFER(book->second_moment), GSCL_ARG(number),
                       GSCL_ARG(count), GSCL_ARG(age), GSCL_ARG_BUFFER(c->indices), GSCL_ARG(f->renderer.count),
                       GSCL_ARG_BUFFER(f->gradients), GSCL_ARG(f->limits));
}

gscl_result gscl_codebook_step(gscl_codebook *c, float rate) {
    gscl_fit *f = c->fit;
    cl_kernel kernel;
    GSCL_TRY(gscl_codebook_project(c));
    GSCL_TRY(gscl_fit_differentiate(f));
    f->limits.rate = rate;
    c->age++;
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(step_book(c, b));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_CODEBOOK, &f->renderer.options, "position_step", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_groups(splats(c), GSCL_SPLATS_PER_GROUP), GSCL_SPLATS_PER_GROUP,
                       GSCL_ARG_BUFFER(c->learnt), GSCL_ARG_BUFFER(f->first_moment), GSCL_ARG_BUFFER(f->second_moment),
                       GSCL_ARG_BUFFER(f->ages), GSCL_ARG(f->renderer.count), GSCL_ARG_BUFFER(f->renderer.params),
                       GSCL_ARG_BUFFER(f->gradients), GSCL_ARG(f->limits));
}

gscl_result gscl_codebook_rest(gscl_codebook *c) {
    gscl_fit *f = c->fit;
    size_t row = GSCL_PARAMS * sizeof(float);
    c->age = 0;
    for (int b = 0; b < GSCL_BOOKS; b++) {
        GSCL_TRY(gscl_buffer_zero(f->context, &c->books[b].first_moment, 0, BOOK_BYTES));
        GSCL_TRY(gscl_buffer_zero(f->context, &c->books[b].second_moment, 0, BOOK_BYTES));
    }
    GSCL_TRY(gscl_buffer_zero(f->context, &f->first_moment, 0, splats(c) * row));
    GSCL_TRY(gscl_buffer_zero(f->context, &f->second_moment, 0, splats(c) * row));
    return gscl_buffer_zero(f->context, &f->ages, 0, splats(c) * sizeof(cl_int));
}
