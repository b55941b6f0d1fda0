/* Codebooks while fitting (the paper's P5): the shapes (ln s1, ln s2, theta) and the colours (channels, opacity logit)
 * of all splats are words of two codebooks.
 *
 * There are two ways to learn.  With the straight-through estimator the gradient at the splats that the words describe
 * is applied to each splat's own parameters, and clustering makes words of these.  Directly, the gradient of a word is
 * the sum over the splats that use it. */
#define COLOUR_DIMS (CHANNELS + 1)
#define MAX_OPACITY_LOGIT 4.5f /* of a word: opacities 0.011 to 0.989 */

/* A dimension of a word in the unit that the file quantises uniformly: angles as 0..pi, opacities as 0..1. */
float to_stored(int book, int dim, float value) {
    if (book == GSCL_BOOK_SHAPE && dim == 2) return value - M_PI_F * floor(value / M_PI_F);
    if (book == GSCL_BOOK_COLOUR && dim == CHANNELS) return 1.0f / (1.0f + exp(-value));
    return value;
}

float from_stored(int book, int dim, float value) {
    if (book == GSCL_BOOK_COLOUR && dim == CHANNELS) {
        float o = clamp(value, 1e-3f, 0.99f);
        return log(o / (1.0f - o));
    }
    return value;
}

/* Rounds words to values of the file: `levels` + 1 uniform values from the least to the largest of each dimension
 * (paper eq. 7-8).  One work-item for each dimension of the book. */
__kernel GROUP_OF(GSCL_BOOK_GROUP) void book_quantise(__global const float *restrict words, int book, int count,
                                                      int levels, __global float *restrict stored) {
    int dim = (int)get_global_id(0);
    float low = MAXFLOAT, high = -MAXFLOAT;
    for (int i = 0; i < count; i++) {
        float v = to_stored(book, dim, words[i * GSCL_BOOK_DIMS + dim]);
        low = fmin(low, v);
        high = fmax(high, v);
    }
    float step = (high - low) / (float)levels;
    for (int i = 0; i < count; i++) {
        float v = to_stored(book, dim, words[i * GSCL_BOOK_DIMS + dim]);
        if (step > 0.0f) v = low + rint((v - low) / step) * step;
        stored[i * GSCL_BOOK_DIMS + dim] = from_stored(book, dim, v);
    }
}

/* The parameters to draw: positions on their grid, shapes and colours from the words. */
__kernel GROUP_OF(GSCL_SPLATS_PER_GROUP) void book_apply(__global const float *restrict learnt,
                                                         __global const int2 *restrict indices,
                                                         __global const float *restrict shapes,
                                                         __global const float *restrict colours, int count, float2 cell,
                                                         int2 last_cell, __global float *restrict params) {
    int i = (int)get_global_id(0);
    if (i >= count) return;
    __global const float *from = learnt + (size_t)i * GSCL_PARAMS;
    __global float *to = params + (size_t)i * GSCL_PARAMS;
    __global const float *shape = shapes + indices[i].x * GSCL_BOOK_DIMS,
                         *colour = colours + indices[i].y * GSCL_BOOK_DIMS;
    to[GSCL_X] = ((float)clamp((int)floor(from[GSCL_X] / cell.x), 0, last_cell.x) + 0.5f) * cell.x;
    to[GSCL_Y] = ((float)clamp((int)floor(from[GSCL_Y] / cell.y), 0, last_cell.y) + 0.5f) * cell.y;
    for (int k = 0; k < GSCL_BOOK_SHAPE_DIMS; k++) to[GSCL_LOG_S1 + k] = shape[k];
    for (int k = 0; k < CHANNELS; k++) to[GSCL_COLOUR + k] = colour[k];
    to[GSCL_OPACITY] = colour[CHANNELS];
}

/* One step of Adam for each word of a book, from the gradients of its members, added in their order. */
__kernel GROUP_OF(GSCL_BOOK_GROUP) void book_step(__global float *restrict words, __global float *restrict first_moment,
                                                  __global float *restrict second_moment,
                                                  __global const int2 *restrict indices,
                                                  __global const float *restrict gradients,
                                                  gscl_word_step_settings settings, gscl_limits limits) {
    const int book = settings.book, w = (int)get_global_id(0);
    if (w >= settings.words) return;
    int dims = book == GSCL_BOOK_SHAPE ? GSCL_BOOK_SHAPE_DIMS : COLOUR_DIMS;
    float sums[GSCL_BOOK_DIMS];
    for (int k = 0; k < GSCL_BOOK_DIMS; k++) sums[k] = 0.0f;
    for (int i = 0; i < settings.splats; i++) {
        if ((book == GSCL_BOOK_SHAPE ? indices[i].x : indices[i].y) != w) continue;
        __global const float *g = gradients + (size_t)i * GSCL_PARAMS;
        for (int k = 0; k < dims; k++)
            sums[k] += book == GSCL_BOOK_SHAPE ? g[GSCL_LOG_S1 + k]
                       : k < CHANNELS          ? g[GSCL_COLOUR + k]
                                               : g[GSCL_OPACITY];
    }
    float correct1 = 1.0f / (1.0f - pown(GSCL_ADAM_BETA1, settings.age));
    float correct2 = 1.0f / (1.0f - pown(GSCL_ADAM_BETA2, settings.age));
    for (int k = 0; k < dims; k++) {
        int at = w * GSCL_BOOK_DIMS + k;
        float rate = book == GSCL_BOOK_SHAPE ? settings.shape_rate
                     : k < CHANNELS          ? GSCL_RATE_COLOUR
                                             : GSCL_RATE_OPACITY;
        float value = words[at] - adam_update(sums[k], limits.rate * rate, correct1, correct2, first_moment + at,
                                              second_moment + at);
        if (book == GSCL_BOOK_SHAPE && k < 2) value = clamp(value, limits.log_min, limits.log_max);
        if (book == GSCL_BOOK_COLOUR)
            value = k < CHANNELS ? clamp(value, limits.colour_min, limits.colour_max)
                                 : clamp(value, -MAX_OPACITY_LOGIT, MAX_OPACITY_LOGIT);
        words[at] = value;
    }
}

/* One step of Adam for the positions alone. */
__kernel GROUP_OF(GSCL_SPLATS_PER_GROUP) void position_step(
    __global float *restrict learnt, __global float *restrict first_moment, __global float *restrict second_moment,
    __global int *restrict ages, __global const float *restrict params, __global const float *restrict gradients,
    gscl_word_step_settings settings, gscl_limits limits) {
    int i = (int)get_global_id(0);
    if (i >= settings.splats) return;
    int age = ++ages[i];
    float correct1 = 1.0f / (1.0f - pown(GSCL_ADAM_BETA1, age)), correct2 = 1.0f / (1.0f - pown(GSCL_ADAM_BETA2, age));
    float size =
        exp(0.5f * (params[(size_t)i * GSCL_PARAMS + GSCL_LOG_S1] + params[(size_t)i * GSCL_PARAMS + GSCL_LOG_S2]));
    for (int k = GSCL_X; k <= GSCL_Y; k++) {
        size_t at = (size_t)i * GSCL_PARAMS + k;
        float value = learnt[at] - adam_update(gradients[at], limits.rate * settings.position_rate * size, correct1,
                                               correct2, first_moment + at, second_moment + at);
        learnt[at] = clamp(value, 0.0f, k == GSCL_X ? limits.width : limits.height);
    }
}
