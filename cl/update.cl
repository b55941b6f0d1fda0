/* From slots to parameters: a splat's gradient, Adam, and the projection for the next step. */

#if LANES == 16
#define COUNTED 32 /* entries that are counted rather than searched: no branch to be guessed wrong */
#else
#define COUNTED 1
#endif

/* The slot of splat `i` in a tile's sorted list, or -1.  May load up to 7 entries behind the list's. */
inline int slot_find(__global const uint *restrict entries, int2 range, uint i) {
    int low = range.x, n = range.y - range.x;
    while (n > COUNTED) {
        int step = n >> 1;
        if (GSCL_ENTRY_SPLAT(entries[low + step]) <= i) low += step;
        n -= step;
    }
#if COUNTED > 1
    int8 before = (int8)(0); /* as negative numbers */
    for (int k = 0; k < n; k += 8) {
        int8 splats = as_int8(GSCL_ENTRY_SPLAT(vload8(0, entries + low + k)));
        before += (splats < (int)i) & ((int8)(0, 1, 2, 3, 4, 5, 6, 7) < n - k);
    }
    int4 four = before.lo + before.hi;
    low -= four.x + four.y + four.z + four.w;
#endif
    return low < range.y && GSCL_ENTRY_SPLAT(entries[low]) == i ? low : -1;
}

/* Adds a splat's slots over the tiles of its box, row by row: always the same order. */
inline void slots_gather(float *restrict sums, uint i, int4 box, int tiles_x, __global const float *restrict drawn,
                         __global const float *restrict extent, __global const uint *restrict entries,
                         __global const int2 *restrict tile_ranges, __global const float *restrict slots) {
    UNROLL
    for (int k = 0; k < SLOT; k++) sums[k] = 0.0f;
    for (int ty = box.z; ty <= box.w && box.x <= box.y; ty++) {
        int2 tiles = tiles_touched(drawn, extent, box, ty, 2.0f); /* no tighter than the lists were made */
        for (int tx = tiles.x; tx <= tiles.y; tx++) {
            int at = slot_find(entries, tile_ranges[(size_t)ty * tiles_x + tx], i);
            if (at < 0) continue;
            UNROLL
            for (int k = 0; k < SLOT; k++) sums[k] += slots[(size_t)at * SLOT + k];
        }
    }
}

/* Chain rule from the frame's sums to the parameters.  `s` is the splat that was drawn. */
inline void gradient_from_sums(float *restrict gradient, const float *restrict sums, splat s,
                               __global const float *restrict drawn, view seen) {
    float e1 = seen_axis(s.s1, seen.blur), e2 = seen_axis(s.s2, seen.blur);
    /* gauss = 2^-(u^2 + v^2): each derivative of the exponent brings a factor 2 ln 2. */
    const float factor = 2.0f * M_LN2_F;
    float du = factor * sums[SLOT_U], dv = factor * sums[SLOT_V];
    gradient[GSCL_X] = seen.inv_scale * fma(drawn[GSCL_DRAWN_UX], du, drawn[GSCL_DRAWN_VX] * dv);
    gradient[GSCL_Y] = seen.inv_scale * fma(drawn[GSCL_DRAWN_UY], du, drawn[GSCL_DRAWN_VY] * dv);
#if TEXTURE
    /* d/dcentre of cos(2 pi (k.d - h)) = 2 pi k sin(...), and sin is cos a quarter of a turn later. */
    float dwave = 2.0f * M_PI_F * sums[SLOT_WAVE] * seen.inv_scale;
    gradient[GSCL_X] = fma(drawn[GSCL_DRAWN_WAVE_X], dwave, gradient[GSCL_X]);
    gradient[GSCL_Y] = fma(drawn[GSCL_DRAWN_WAVE_Y], dwave, gradient[GSCL_Y]);
#endif
    gradient[GSCL_LOG_S1] = factor * sums[SLOT_UU] * (s.s1 / e1) * (s.s1 / e1);
    gradient[GSCL_LOG_S2] = factor * sums[SLOT_VV] * (s.s2 / e2) * (s.s2 / e2);
    gradient[GSCL_THETA] = ROTATION ? factor * sums[SLOT_UV] * (e1 / e2 - e2 / e1) : 0.0f;
    gradient[GSCL_OPACITY] = OPACITY ? sums[SLOT_OPACITY] * s.opacity * (1.0f - s.opacity) : 0.0f;
    for (int k = 0; k < CHANNELS; k++) gradient[GSCL_COLOUR + k] = sums[SLOT_COLOUR + k];
}

/* Learning rates and bounds of one step. */
typedef struct {
    float rate;             /* this step's factor on all rates */
    float width, height;    /* centres stay inside the full-size image */
    float log_min, log_max; /* of an axis */
    float log_aspect;       /* largest |ln s1 - ln s2| */
    float colour_min, colour_max;
} limits;

#define ADAM_BETA1 0.9f
#define ADAM_BETA2 0.99f
#define LOG2_BETA1 -0.152003093f
#define LOG2_BETA2 -0.0144995697f
#define ADAM_EPSILON 1e-10f
#define RATE_POSITION 0.06f /* of an axis, along it */
#define RATE_SHAPE 0.08f
#define RATE_TURN 0.06f /* of a round splat; less for long ones */
#define RATE_COLOUR 0.012f
#define RATE_OPACITY 0.04f

/* Turns (x, y) by the angle whose cosine and sine are given. */
inline void turn(float *restrict x, float *restrict y, float c, float s) {
    float turned = c * *x - s * *y;
    *y = fma(c, *y, s * *x);
    *x = turned;
}

/* The learning rate of each parameter.  The centre moves along the axes in units of each, and needles turn slowly, by
 * the power 3/4: both keep a step's effect on the picture alike for all shapes. */
inline void learning_rates(float *restrict rates, __global const float *restrict p) {
    float s1 = exp(p[GSCL_LOG_S1]), s2 = exp(p[GSCL_LOG_S2]);
    float roundness = sqrt(2.0f / (1.0f + fmax(s1, s2) / fmin(s1, s2)));
    rates[GSCL_X] = RATE_POSITION * s1;
    rates[GSCL_Y] = RATE_POSITION * s2;
    rates[GSCL_LOG_S1] = rates[GSCL_LOG_S2] = RATE_SHAPE;
    rates[GSCL_THETA] = RATE_TURN * roundness * sqrt(roundness);
    rates[GSCL_OPACITY] = RATE_OPACITY;
    for (int k = 0; k < CHANNELS; k++) rates[GSCL_COLOUR + k] = RATE_COLOUR;
}

/* Adam with the bias correction of each splat's own age; moments of the centre are in the splat's own frame. */
inline void adam(__global float *restrict p, __global float *restrict m, __global float *restrict v, int age,
                 __global const float *restrict gradient, limits bounds) {
    float correct1 = bounds.rate / (1.0f - exp2(LOG2_BETA1 * (float)age));
    float correct2 = 1.0f / (1.0f - exp2(LOG2_BETA2 * (float)age));
    float c = ROTATION ? cos(p[GSCL_THETA]) : 1.0f, s = ROTATION ? sin(p[GSCL_THETA]) : 0.0f,
          steps[GSCL_COLOUR + CHANNELS], rates[GSCL_COLOUR + CHANNELS];
    learning_rates(rates, p);
    for (int k = 0; k < GSCL_COLOUR + CHANNELS; k++) steps[k] = gradient[k];
    turn(&steps[GSCL_X], &steps[GSCL_Y], c, -s);
    for (int k = 0; k < GSCL_COLOUR + CHANNELS; k++) {
        m[k] = fma(ADAM_BETA1, m[k], (1.0f - ADAM_BETA1) * steps[k]);
        v[k] = fma(ADAM_BETA2, v[k], (1.0f - ADAM_BETA2) * steps[k] * steps[k]);
        steps[k] = rates[k] * (m[k] * correct1) / (sqrt(v[k] * correct2) + ADAM_EPSILON);
    }
    turn(&steps[GSCL_X], &steps[GSCL_Y], c, s);
    for (int k = 0; k < GSCL_COLOUR + CHANNELS; k++) p[k] -= steps[k];
}

inline void keep_within(__global float *restrict p, limits b) {
    p[GSCL_X] = clamp(p[GSCL_X], 0.0f, b.width);
    p[GSCL_Y] = clamp(p[GSCL_Y], 0.0f, b.height);
    float excess = 0.5f * (fabs(p[GSCL_LOG_S1] - p[GSCL_LOG_S2]) - b.log_aspect);
    if (excess > 0.0f) {
        if (p[GSCL_LOG_S1] < p[GSCL_LOG_S2]) excess = -excess;
        p[GSCL_LOG_S1] -= excess;
        p[GSCL_LOG_S2] += excess;
    }
    p[GSCL_LOG_S1] = clamp(p[GSCL_LOG_S1], b.log_min, b.log_max);
    p[GSCL_LOG_S2] = clamp(p[GSCL_LOG_S2], b.log_min, b.log_max);
    p[GSCL_OPACITY] = clamp(p[GSCL_OPACITY], -8.0f, 8.0f);
    for (int k = 0; k < CHANNELS; k++) p[GSCL_COLOUR + k] = clamp(p[GSCL_COLOUR + k], b.colour_min, b.colour_max);
}

/* Writes every splat's gradient (GSCL_PARAMS floats each). */
__kernel void gather_gradients(__global const float *restrict params, __global const float *restrict steps, int count,
                               view seen, __global const int4 *restrict boxes, __global const float *restrict drawn,
                               __global const float *restrict extents, __global const uint *restrict entries,
                               __global const int2 *restrict tile_ranges, __global const float *restrict slots,
                               __global float *restrict gradients) {
    int i = (int)get_global_id(0);
    if (i >= count) return;
    float sums[SLOT], gradient[GSCL_PARAMS];
    slots_gather(sums, (uint)i, boxes[i], seen.tiles_x, drawn + (size_t)i * GSCL_DRAWN,
                 extents + (size_t)i * GSCL_EXTENT, entries, tile_ranges, slots);
    splat s = splat_quantise(splat_load(params + (size_t)i * GSCL_PARAMS), steps);
    gradient_from_sums(gradient, sums, s, drawn + (size_t)i * GSCL_DRAWN, seen);
    for (int k = 0; k < GSCL_PARAMS; k++)
        gradients[(size_t)i * GSCL_PARAMS + k] = k < GSCL_COLOUR + CHANNELS ? gradient[k] : 0.0f;
}

/* One step of Adam from the gradients, then the projection of the (quantised) result. */
__kernel void adam_step(__global float *restrict params, __global float *restrict first_moment,
                        __global float *restrict second_moment, __global int *restrict ages,
                        __global const float *restrict gradients, __global const float *restrict steps, int count,
                        limits bounds, view seen, __global float *restrict drawn, __global float *restrict extents,
                        __global int4 *restrict boxes) {
    int i = (int)get_global_id(0);
    if (i >= count) return;
    size_t at = (size_t)i * GSCL_PARAMS;
    adam(params + at, first_moment + at, second_moment + at, ++ages[i], gradients + at, bounds);
    keep_within(params + at, bounds);
    splat_project(splat_quantise(splat_load(params + at), steps), seen, i, drawn, extents, boxes);
}
