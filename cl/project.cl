/* From a splat's parameters to what the rasteriser draws, at a pyramid level. */

/* A splat after quantisation, in pixels of the full-size image. */
typedef struct {
    float x, y, theta, opacity;
    float log_s1, log_s2; /* axes, */
    float s1, s2;         /* pixels: splat_set_axes */
    float colour[CHANNELS];
#if TEXTURE
    float wave_x, wave_y, wave_phase, wave_amplitude;
#endif
} splat;

inline float logistic(float x) { return 1.0f / (1.0f + exp(-x)); }

inline void splat_set_axes(splat *s, float log_s1, float log_s2) {
    s->log_s1 = log_s1;
    s->log_s2 = log_s2;
    s->s1 = exp(log_s1);
    s->s2 = exp(log_s2);
}

/* All but the axes, which the quantiser sets. */
inline splat splat_load(__global const float *restrict p) {
    splat s;
    s.x = p[GSCL_X];
    s.y = p[GSCL_Y];
    s.log_s1 = p[GSCL_LOG_S1];
    s.log_s2 = p[ANISOTROPY ? GSCL_LOG_S2 : GSCL_LOG_S1];
    s.theta = ROTATION ? p[GSCL_THETA] : 0.0f;
    s.opacity = OPACITY ? logistic(p[GSCL_OPACITY]) : 1.0f;
    for (int k = 0; k < CHANNELS; k++) s.colour[k] = p[GSCL_COLOUR + k];
#if TEXTURE
    s.wave_x = p[GSCL_WAVE_X];
    s.wave_y = p[GSCL_WAVE_Y];
    s.wave_phase = p[GSCL_WAVE_PHASE];
    s.wave_amplitude = p[GSCL_WAVE_AMPLITUDE];
#endif
    return s;
}

/* The part of the plane that is drawn: pixels of the full-size image times inv_scale, less the origin
 * (x, y).  Mirrors gscl_view in host/lib/render.h. */
typedef struct {
    float inv_scale, blur, x, y;
    int tiles_x, tiles_y;
} view;

/* Axes as seen at a level that shows 1 pixel for 1 / inv_scale of the full image: a smaller level is
 * box-filtered, which widens a splat by `blur` = ((1 / inv_scale)^2 - 1) / 12 square pixels. */
inline float seen_axis(float sigma, float blur) { return sqrt(fma(sigma, sigma, blur)); }

/* What is drawn of a splat: the records of constants.h in private memory. */
typedef struct {
    float drawn[GSCL_DRAWN];
    float extent[GSCL_EXTENT];
} appearance;

inline appearance splat_appearance(splat s, view seen) {
    const float to_frame = 0.849321800f; /* sqrt(log2(e) / 2): exp(-d^2 / 2) = 2^-(to_frame d)^2 */
    appearance a;
    float c = ROTATION ? cos(s.theta) : 1.0f, n = ROTATION ? sin(s.theta) : 0.0f;
    float s1 = seen_axis(s.s1, seen.blur) * seen.inv_scale, s2 = seen_axis(s.s2, seen.blur) * seen.inv_scale;
    float i1 = to_frame / s1, i2 = to_frame / s2;
    a.drawn[GSCL_DRAWN_X] = s.x * seen.inv_scale - seen.x;
    a.drawn[GSCL_DRAWN_Y] = s.y * seen.inv_scale - seen.y;
    a.drawn[GSCL_DRAWN_UX] = c * i1;
    a.drawn[GSCL_DRAWN_UY] = n * i1;
    a.drawn[GSCL_DRAWN_VX] = -n * i2;
    a.drawn[GSCL_DRAWN_VY] = c * i2;
    a.drawn[GSCL_DRAWN_OPACITY] = s.opacity;
    a.drawn[GSCL_DRAWN_ROW_STEP] = ROTATION ? 0.0f : exp2(-i2 * i2);
    for (int k = 0; k < CHANNELS; k++) a.drawn[GSCL_DRAWN_COLOUR + k] = s.colour[k];
#if TEXTURE
    /* What a level's box filter leaves of the wave. */
    float cycles2 = fma(s.wave_x, s.wave_x, s.wave_y * s.wave_y);
    a.drawn[GSCL_DRAWN_WAVE_X] = s.wave_x / seen.inv_scale;
    a.drawn[GSCL_DRAWN_WAVE_Y] = s.wave_y / seen.inv_scale;
    a.drawn[GSCL_DRAWN_WAVE_PHASE] = s.wave_phase;
    a.drawn[GSCL_DRAWN_WAVE_AMPLITUDE] = s.wave_amplitude * exp(-2.0f * M_PI_F * M_PI_F * cycles2 * seen.blur);
#endif

    /* Covariance entries; the outline's support function in x and y. */
    float xx = fma(c * s1, c * s1, (n * s2) * (n * s2)), yy = fma(n * s1, n * s1, (c * s2) * (c * s2));
    float xy = c * n * (s1 * s1 - s2 * s2);
    a.extent[GSCL_EXTENT_HALF_WIDTH] = sqrt(2.0f * GSCL_SUPPORT * xx);
    a.extent[GSCL_EXTENT_HALF_HEIGHT] = sqrt(2.0f * GSCL_SUPPORT * yy);
    a.extent[GSCL_EXTENT_SLOPE] = xy / xx;
    a.extent[GSCL_EXTENT_SLOPE_X] = xy / yy;
    float by_xx = s1 * (s1 / xx), by_yy = s1 * (s1 / yy); /* det / xx^2 and the like without overflow */
    a.extent[GSCL_EXTENT_HEIGHT2] = 2.0f * GSCL_SUPPORT * by_xx * (s2 * s2);
    a.extent[GSCL_EXTENT_WIDTH2] = 2.0f * GSCL_SUPPORT * by_yy * (s2 * s2);
    float ratio_x = s1 * s2 / xx, ratio_y = s1 * s2 / yy;
    a.extent[GSCL_EXTENT_CURVE] = ratio_x * ratio_x;
    a.extent[GSCL_EXTENT_CURVE_X] = ratio_y * ratio_y;
    return a;
}

/* The box of tiles (inclusive; empty when x > y) that the outline may touch, clamped as floats: a giant's box
 * does not fit an int. */
inline int4 appearance_tiles(const appearance *a, view seen) {
    float x = a->drawn[GSCL_DRAWN_X], half_width = a->extent[GSCL_EXTENT_HALF_WIDTH];
    float y = a->drawn[GSCL_DRAWN_Y], half_height = a->extent[GSCL_EXTENT_HALF_HEIGHT];
    float4 edges = (float4)(x - half_width, x + half_width, y - half_height, y + half_height) * (1.0f / GSCL_TILE);
    float4 last = (float4)((float2)((float)seen.tiles_x), (float2)((float)seen.tiles_y));
    edges = clamp(floor(edges), (float4)(-1.0f), last);
    return (int4)(max((int)edges.x, 0), min((int)edges.y, seen.tiles_x - 1), max((int)edges.z, 0),
                  min((int)edges.w, seen.tiles_y - 1));
}

/* For values that are never NaN: fmin and fmax take three instructions, and floor and ceil a dozen. */
#define LESSER(a, b) ((a) < (b) ? (a) : (b))
#define LARGER(a, b) ((a) > (b) ? (a) : (b))

/* First and last tile of row `ty` of its box that the outline touches; a little more than that (by `slack` = 1, or
 * more) where rounding might lose one. */
__attribute__((always_inline)) inline int2 tiles_touched(__global const float *drawn, __global const float *extent,
                                                         int4 box, int ty, float slack) {
    float half_width = extent[GSCL_EXTENT_HALF_WIDTH], half_height = extent[GSCL_EXTENT_HALF_HEIGHT];
    float x = drawn[GSCL_DRAWN_X], y0 = (float)(ty * GSCL_TILE) + 0.5f - drawn[GSCL_DRAWN_Y];
    float low = LARGER(y0, -half_height), high = LESSER(y0 + (float)(GSCL_TILE - 1), half_height);
    high = LARGER(high, low); /* only just touched, or not quite */
    /* dy of the leftmost and of the rightmost point, within the row */
    float right_dy = extent[GSCL_EXTENT_SLOPE] * half_width, slope = extent[GSCL_EXTENT_SLOPE_X];
    float width2 = extent[GSCL_EXTENT_WIDTH2], curve = extent[GSCL_EXTENT_CURVE_X];
    float dy0 = LESSER(LARGER(-right_dy, low), high), dy1 = LESSER(LARGER(right_dy, low), high);
    float arc0 = width2 - curve * dy0 * dy0, arc1 = width2 - curve * dy1 * dy1;
    float left = slope * dy0 - sqrt(LARGER(arc0, 0.0f)), right = slope * dy1 + sqrt(LARGER(arc1, 0.0f));
    float margin = slack * (1e-3f * (1.0f + half_width) + 1e-6f * fabs(x));
    left = (x + LARGER(left, -half_width) - margin) * (1.0f / GSCL_TILE);
    right = (x + LESSER(right, half_width) + margin) * (1.0f / GSCL_TILE);
    /* clamped as floats, since a giant's do not fit an int; the box has no negative tiles */
    float first = (float)box.x, last = (float)box.y;
    left = LESSER(LARGER(left, first), last + 1.0f);
    right = LESSER(LARGER(right, first - 1.0f), last);
    return (int2)(min((int)left, box.y), max((int)right, box.x));
}

/* Stores what is drawn of splat `i`, and its box of tiles. */
inline void splat_project(splat s, view seen, int i, __global float *restrict drawn, __global float *restrict extents,
                          __global int4 *restrict boxes) {
    appearance a = splat_appearance(s, seen);
    for (int k = 0; k < GSCL_DRAWN_COLOUR + CHANNELS; k++) drawn[(size_t)i * GSCL_DRAWN + k] = a.drawn[k];
#if TEXTURE
    for (int k = GSCL_DRAWN_WAVE_X; k < GSCL_DRAWN; k++) drawn[(size_t)i * GSCL_DRAWN + k] = a.drawn[k];
#endif
    for (int k = 0; k < GSCL_EXTENT; k++) extents[(size_t)i * GSCL_EXTENT + k] = a.extent[k];
    boxes[i] = appearance_tiles(&a, seen);
}

/* The nearest splat that scalar coding can write (FORMAT.md, "Dequantisation"), in float: the fit looks
 * through the quantiser so that it learns to live with it.  steps[GSCL_STEP_SCALE] = 0 switches it off. */
inline splat splat_quantise(splat s, __global const float *restrict steps) {
    float scale = steps[GSCL_STEP_SCALE];
    if (!(scale > 0.0f)) {
        splat_set_axes(&s, s.log_s1, s.log_s2);
        return s;
    }
    splat_set_axes(&s, fmax(rint((s.log_s1 + M_LN2_F) / scale), 0.0f) * scale - M_LN2_F,
                   fmax(rint((s.log_s2 + M_LN2_F) / scale), 0.0f) * scale - M_LN2_F);
    float position = fmax(steps[GSCL_STEP_POSITION] * fmin(s.s1, s.s2), 1.0f / 32.0f);
    s.x = (floor(s.x / position) + 0.5f) * position;
    s.y = (floor(s.y / position) + 0.5f) * position;
#if ROTATION
    float aspect = fmax(s.s1, s.s2) / fmin(s.s1, s.s2);
    float angles = clamp(ceil(M_PI_F / steps[GSCL_STEP_ANGLE] * (aspect - 1.0f / aspect)), 1.0f, 512.0f);
    float turn = s.log_s1 < s.log_s2 ? M_PI_2_F : 0.0f; /* codes count from the major axis */
    s.theta = rint((s.theta + turn) * angles / M_PI_F) * M_PI_F / angles - turn;
#endif
    float luma = steps[GSCL_STEP_LUMA];
#if COLOURS == 3
    float chroma = steps[GSCL_STEP_CHROMA];
    float y = rint((s.colour[0] + 2.0f * s.colour[1] + s.colour[2]) * 0.25f / luma) * luma;
    float co = rint((s.colour[0] - s.colour[2]) / chroma) * chroma;
    float cg = rint((s.colour[1] - 0.5f * (s.colour[0] + s.colour[2])) / chroma) * chroma;
    s.colour[1] = y + 0.5f * cg;
    s.colour[2] = y - 0.5f * cg - 0.5f * co;
    s.colour[0] = s.colour[2] + co;
#else
    s.colour[0] = rint(s.colour[0] / luma) * luma;
#endif
#if ALPHA_CHANNEL
    s.colour[COLOURS] = rint(s.colour[COLOURS] / steps[GSCL_STEP_ALPHA]) * steps[GSCL_STEP_ALPHA];
#endif
#if OPACITY
    float levels = steps[GSCL_STEP_OPACITY];
    s.opacity = clamp(rint(s.opacity * levels), 1.0f, levels) / levels;
#endif
    return s;
}

/* Projects the splats as they are, or through the quantiser. */
__kernel void project(__global const float *restrict params, __global const float *restrict steps, int count, view seen,
                      __global float *restrict drawn, __global float *restrict extents, __global int4 *restrict boxes) {
    int i = (int)get_global_id(0);
    if (i >= count) return;
    splat_project(splat_quantise(splat_load(params + (size_t)i * GSCL_PARAMS), steps), seen, i, drawn, extents, boxes);
}
