/* The paper's codebooks while fitting: shapes (ln s1, ln s2, theta) and colours (channels, opacity logit) of all
 * splats are words of two codebooks.
 *
 * Two ways to learn: straight through (the parameters of each splat are learnt as if they were drawn, its words
 * follow by clustering), and directly (a word's gradient is the sum over the splats that use it). */
#define COLOUR_DIMS (CHANNELS + 1)

inline float to_stored(int book, int dim, float value) {
    if (book == GSCL_BOOK_SHAPE && dim == 2) return value - M_PI_F * floor(value / M_PI_F); /* half a turn */
    if (book == GSCL_BOOK_COLOUR && dim == CHANNELS) return 1.0f / (1.0f + exp(-value));
    return value;
}

inline float from_stored(int book, int dim, float value) {
    if (book == GSCL_BOOK_COLOUR && dim == CHANNELS) {
        float o = clamp(value, 1e-3f, 0.99f);
        return log(o / (1.0f - o));
    }
    return value;
}

/* Words as the file stores them: uniform `levels` + 1 values between each dimension's ends (paper eq. 7-8).
 * One work-item for each dimension of each book; `ends` receives min and max. */
__kernel void book_quantise(__global const float *restrict words, int book, int count, int levels,
                            __global float *restrict stored) {
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

/* What is drawn: positions on their grid, everything else from the words. */
__kernel void book_apply(__global const float *restrict learnt, __global const int2 *restrict indices,
                         __global const float *restrict shapes, __global const float *restrict colours, int count,
                         float2 cell, int2 last_cell, __global float *restrict params) {
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

/* Words and the places of their members learn more slowly than free splats. */
#define RATE_WORD_SHAPE 0.03f
#define RATE_MEMBER_POSITION 0.04f /* of the geometric mean axis */

/* One step of Adam for each word, from the gradients of its members added in their order. */
__kernel void book_step(__global float *restrict words, __global float *restrict first_moment,
                        __global float *restrict second_moment, int book, int count, int age,
                        __global const int2 *restrict indices, int splats, __global const float *restrict gradients,
                        gscl_limits bounds) {
    int w = (int)get_global_id(0);
    if (w >= count) return;
    int dims = book == GSCL_BOOK_SHAPE ? GSCL_BOOK_SHAPE_DIMS : COLOUR_DIMS;
    float sums[GSCL_BOOK_DIMS];
    for (int k = 0; k < GSCL_BOOK_DIMS; k++) sums[k] = 0.0f;
    for (int i = 0; i < splats; i++) {
        if ((book == GSCL_BOOK_SHAPE ? indices[i].x : indices[i].y) != w) continue;
        __global const float *g = gradients + (size_t)i * GSCL_PARAMS;
        for (int k = 0; k < dims; k++)
            sums[k] += book == GSCL_BOOK_SHAPE ? g[GSCL_LOG_S1 + k]
                       : k < CHANNELS          ? g[GSCL_COLOUR + k]
                                               : g[GSCL_OPACITY];
    }
    float correct1 = 1.0f / (1.0f - pown(ADAM_BETA1, age)), correct2 = 1.0f / (1.0f - pown(ADAM_BETA2, age));
    for (int k = 0; k < dims; k++) {
        int at = w * GSCL_BOOK_DIMS + k;
        float rate = book == GSCL_BOOK_SHAPE ? RATE_WORD_SHAPE : k < CHANNELS ? RATE_COLOUR : RATE_OPACITY;
        float m = first_moment[at] = fma(ADAM_BETA1, first_moment[at], (1.0f - ADAM_BETA1) * sums[k]);
        float v = second_moment[at] = fma(ADAM_BETA2, second_moment[at], (1.0f - ADAM_BETA2) * sums[k] * sums[k]);
        float value = words[at] - bounds.rate * rate * (m * correct1) / (sqrt(v * correct2) + ADAM_EPSILON);
        if (book == GSCL_BOOK_SHAPE && k < 2) value = clamp(value, bounds.log_min, bounds.log_max);
        if (book == GSCL_BOOK_COLOUR)
            value = k < CHANNELS ? clamp(value, bounds.colour_min, bounds.colour_max) : clamp(value, -4.5f, 4.5f);
        words[at] = value;
    }
}

/* One step of Adam for the positions alone. */
__kernel void position_step(__global float *restrict learnt, __global float *restrict first_moment,
                            __global float *restrict second_moment, __global int *restrict ages, int count,
                            __global const float *restrict params, __global const float *restrict gradients,
                            gscl_limits bounds) {
    int i = (int)get_global_id(0);
    if (i >= count) return;
    int age = ++ages[i];
    float correct1 = 1.0f / (1.0f - pown(ADAM_BETA1, age)), correct2 = 1.0f / (1.0f - pown(ADAM_BETA2, age));
    float size =
        exp(0.5f * (params[(size_t)i * GSCL_PARAMS + GSCL_LOG_S1] + params[(size_t)i * GSCL_PARAMS + GSCL_LOG_S2]));
    for (int k = GSCL_X; k <= GSCL_Y; k++) {
        size_t at = (size_t)i * GSCL_PARAMS + k;
        float g = gradients[at];
        float m = first_moment[at] = fma(ADAM_BETA1, first_moment[at], (1.0f - ADAM_BETA1) * g);
        float v = second_moment[at] = fma(ADAM_BETA2, second_moment[at], (1.0f - ADAM_BETA2) * g * g);
        float value = learnt[at] -
                      bounds.rate * RATE_MEMBER_POSITION * size * (m * correct1) / (sqrt(v * correct2) + ADAM_EPSILON);
        learnt[at] = clamp(value, 0.0f, k == GSCL_X ? bounds.width : bounds.height);
    }
}
