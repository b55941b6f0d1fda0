/* From splats' parameters to projected splats, at a pyramid level. */

/* Splats after quantisation, in pixels of the full-size image. */
typedef struct {
    vfloat x, y, theta, opacity;
    vfloat log_s1, log_s2; /* natural logarithms of the axes */
    vfloat s1, s2;         /* the axes, pixels (splat_set_axes) */
    vfloat colour[CHANNELS];
    vfloat wave_x, wave_y, wave_phase, wave_amplitude;
} splat;

vfloat logistic(vfloat x) { return 1.0f / (1.0f + exp(-x)); }

void splat_set_axes(splat *s, vfloat log_s1, vfloat log_s2) {
    s->log_s1 = log_s1;
    s->log_s2 = log_s2;
    s->s1 = exp(log_s1);
    s->s2 = exp(log_s2);
}

/* Parameter `k` of the splats whose rows begin at p; `lanes_used` of them exist. */
#define LOAD_PARAM(p, k, lanes_used) MASK_TAIL(LOAD_LANES((p) + (k), GSCL_PARAMS), lanes_used)

/* Loads all but the axes s1 and s2, which splat_set_axes computes. */
splat splat_load(__global const float *restrict p, int lanes_used) {
    splat s;
    s.x = LOAD_PARAM(p, GSCL_X, lanes_used);
    s.y = LOAD_PARAM(p, GSCL_Y, lanes_used);
    s.log_s1 = LOAD_PARAM(p, GSCL_LOG_S1, lanes_used);
    s.log_s2 = ANISOTROPY ? LOAD_PARAM(p, GSCL_LOG_S2, lanes_used) : s.log_s1;
    s.theta = ROTATION ? LOAD_PARAM(p, GSCL_THETA, lanes_used) : (vfloat)(0.0f);
    s.opacity = OPACITY ? logistic(LOAD_PARAM(p, GSCL_OPACITY, lanes_used)) : (vfloat)(1.0f);
    UNROLL
    for (int k = 0; k < CHANNELS; k++) s.colour[k] = LOAD_PARAM(p, GSCL_COLOUR + k, lanes_used);
    if (TEXTURE) {
        s.wave_x = LOAD_PARAM(p, GSCL_WAVE_X, lanes_used);
        s.wave_y = LOAD_PARAM(p, GSCL_WAVE_Y, lanes_used);
        s.wave_phase = LOAD_PARAM(p, GSCL_WAVE_PHASE, lanes_used);
        s.wave_amplitude = LOAD_PARAM(p, GSCL_WAVE_AMPLITUDE, lanes_used);
    }
    return s;
}

/* An axis at a level that has 1 pixel for 1 / inv_scale of the full image: a smaller level is
 * box-filtered, which widens a splat by `blur` = ((1 / inv_scale)^2 - 1) / 12 square pixels. */
vfloat axis_at_level(vfloat sigma, float blur) { return sqrt(fma(sigma, sigma, (vfloat)(blur))); }

/* A projected splat and the bounds of its ellipse (constants.h), in private memory. */
typedef struct {
    vfloat projected[GSCL_PROJECTED];
    vfloat bounds[GSCL_BOUNDS];
} projected_splat;

projected_splat splat_project(splat s, gscl_view view) {
    const float to_frame = 0.849321800f; /* sqrt(log2(e) / 2): exp(-d^2 / 2) = 2^-(to_frame d)^2 */
    projected_splat a;
    const unit_vector d = axis_direction(s.theta);
    const vfloat c = d.x, n = d.y;
    vfloat s1 = axis_at_level(s.s1, view.blur) * view.inv_scale, s2 = axis_at_level(s.s2, view.blur) * view.inv_scale;
    vfloat i1 = to_frame / s1, i2 = to_frame / s2;
    const float down = view.row_scale, down2 = down * down; /* pixels are 1 / down as high as wide */
    a.projected[GSCL_PROJECTED_X] = s.x * view.inv_scale - view.x;
    a.projected[GSCL_PROJECTED_Y] = s.y * view.inv_scale * down - view.y;
    a.projected[GSCL_PROJECTED_UX] = c * i1;
    a.projected[GSCL_PROJECTED_UY] = n * i1 / down;
    a.projected[GSCL_PROJECTED_VX] = -n * i2;
    a.projected[GSCL_PROJECTED_VY] = c * i2 / down;
    a.projected[GSCL_PROJECTED_OPACITY] = s.opacity;
    const vfloat step2 = fma(a.projected[GSCL_PROJECTED_UY], a.projected[GSCL_PROJECTED_UY],
                             a.projected[GSCL_PROJECTED_VY] * a.projected[GSCL_PROJECTED_VY]);
    a.projected[GSCL_PROJECTED_ROW_STEP] = exp2(-step2);
    for (int k = 0; k < CHANNELS; k++) a.projected[GSCL_PROJECTED_COLOUR + k] = s.colour[k];
    if (TEXTURE) {
        /* The level's box filter lowers the amplitude. */
        vfloat cycles2 = fma(s.wave_x, s.wave_x, s.wave_y * s.wave_y);
        a.projected[GSCL_PROJECTED_WAVE_X] = s.wave_x / view.inv_scale;
        a.projected[GSCL_PROJECTED_WAVE_Y] = s.wave_y / view.inv_scale / down;
        a.projected[GSCL_PROJECTED_WAVE_PHASE] = s.wave_phase;
        a.projected[GSCL_PROJECTED_WAVE_AMPLITUDE] =
            s.wave_amplitude * exp(-2.0f * M_PI_F * M_PI_F * cycles2 * view.blur);
    }

    /* Covariance entries; the half sizes of the outline follow from them. */
    vfloat xx = fma(c * s1, c * s1, (n * s2) * (n * s2)), yy = fma(n * s1, n * s1, (c * s2) * (c * s2));
    vfloat xy = c * n * (s1 * s1 - s2 * s2);
    a.bounds[GSCL_BOUNDS_HALF_WIDTH] = sqrt(2.0f * GSCL_SUPPORT * xx);
    a.bounds[GSCL_BOUNDS_HALF_HEIGHT] = sqrt(2.0f * GSCL_SUPPORT * yy) * down;
    a.bounds[GSCL_BOUNDS_SLOPE] = xy / xx * down;
    a.bounds[GSCL_BOUNDS_SLOPE_X] = xy / yy / down;
    vfloat by_xx = s1 * (s1 / xx), by_yy = s1 * (s1 / yy); /* det / xx^2 and the like without overflow */
    a.bounds[GSCL_BOUNDS_HEIGHT2] = 2.0f * GSCL_SUPPORT * by_xx * (s2 * s2) * down2;
    a.bounds[GSCL_BOUNDS_WIDTH2] = 2.0f * GSCL_SUPPORT * by_yy * (s2 * s2);
    vfloat ratio_x = s1 * s2 / xx, ratio_y = s1 * s2 / yy;
    a.bounds[GSCL_BOUNDS_CURVE] = ratio_x * ratio_x * down2;
    a.bounds[GSCL_BOUNDS_CURVE_X] = ratio_y * ratio_y / down2;
    return a;
}

/* Boxes of tiles (inclusive; empty when first > last) that outlines may touch. */
typedef struct {
    vint first_x, last_x, first_y, last_y;
} tile_boxes;

/* Clamped as floats: the box of a very large splat does not fit an int. */
vint tile_at(vfloat position, int tiles) {
    return TO_VINT(clamp(floor(position * (1.0f / GSCL_TILE)), (vfloat)(-1.0f), (vfloat)((float)tiles)));
}

tile_boxes projected_tiles(const projected_splat *a, gscl_view view) {
    vfloat x = a->projected[GSCL_PROJECTED_X], half_width = a->bounds[GSCL_BOUNDS_HALF_WIDTH];
    vfloat y = a->projected[GSCL_PROJECTED_Y], half_height = a->bounds[GSCL_BOUNDS_HALF_HEIGHT];
    tile_boxes b;
    b.first_x = max(tile_at(x - half_width, view.tiles_x), (vint)(0));
    b.last_x = min(tile_at(x + half_width, view.tiles_x), (vint)(view.tiles_x - 1));
    b.first_y = max(tile_at(y - half_height, view.tiles_y), (vint)(0));
    b.last_y = min(tile_at(y + half_height, view.tiles_y), (vint)(view.tiles_y - 1));
    return b;
}

/* Stores the projection of the splats from `i` on, and their boxes of tiles. */
void splat_store_projected(splat s, gscl_view view, size_t i, __global float *restrict projected,
                           __global float *restrict ellipse_bounds, __global int4 *restrict boxes) {
    projected_splat a = splat_project(s, view);
    tile_boxes b = projected_tiles(&a, view);
    projected += i * GSCL_PROJECTED;
    ellipse_bounds += i * GSCL_BOUNDS;
    UNROLL
    for (int k = 0; k < GSCL_PROJECTED_COLOUR + CHANNELS; k++)
        store_lanes(a.projected[k], projected + k, GSCL_PROJECTED);
    if (TEXTURE) {
        UNROLL
        for (int k = GSCL_PROJECTED_WAVE_X; k < GSCL_PROJECTED; k++)
            store_lanes(a.projected[k], projected + k, GSCL_PROJECTED);
    }
    UNROLL
    for (int k = 0; k < GSCL_BOUNDS; k++) store_lanes(a.bounds[k], ellipse_bounds + k, GSCL_BOUNDS);
    __global int *box = (__global int *)(boxes + i);
    store_lanes_int(b.first_x, box, 4);
    store_lanes_int(b.last_x, box + 1, 4);
    store_lanes_int(b.first_y, box + 2, 4);
    store_lanes_int(b.last_y, box + 3, 4);
}

#if COLOURS == 3
/* Red, green and blue from YCoCg (FORMAT.md, "Dequantisation"). */
void colour_from_ycocg(vfloat y, vfloat co, vfloat cg, vfloat *restrict colour) {
    colour[1] = y + 0.5f * cg;
    colour[2] = y - 0.5f * cg - 0.5f * co;
    colour[0] = colour[2] + co;
}
#endif

vfloat cell_centre(vfloat x, vfloat step) { return (floor(x / step) + 0.5f) * step; }

/* Rounds the centre to cells that are divided into `parts` across the major axis, which has the angle `theta`.
 * Rounding along the other axis of the image moves the centre along the major axis. */
void splat_quantise_centre(splat *s, vfloat cell, vfloat parts, vfloat theta) {
    const unit_vector d = axis_direction(theta);
    vint steep = fabs(d.y) > fabs(d.x);
    vfloat along = steep ? s->y : s->x, across = steep ? s->x : s->y;
    vfloat slope = parts > 1.0f ? (steep ? d.x / d.y : d.y / d.x) : (vfloat)(0.0f);
    vfloat rounded = cell_centre(along, cell);
    across = cell_centre(across + (rounded - along) * slope, cell / parts);
    s->x = steep ? across : rounded;
    s->y = steep ? rounded : across;
}

/* The parts of a level of luma and chroma, for axes that the format can represent. */
vfloat splat_colour_fineness(const splat *s, __global const float *restrict steps) {
    const vfloat area = (32.0f / M_LN2_F) * (s->log_s1 + s->log_s2) + 64.0f;
    vfloat fineness = (vfloat)(1.0f);
    UNROLL
    for (int i = 0; i < GSCL_MAX_FINENESS - 1; i++)
        fineness += area > steps[GSCL_STEP_FINER + i] ? (vfloat)(1.0f) : (vfloat)(0.0f);
    return fineness;
}

/* The nearest splat that scalar coding can write (FORMAT.md, "Dequantisation"), in float: the fit draws
 * splats as the quantiser leaves them, so that it compensates for the rounding.  steps[GSCL_STEP_SCALE] = 0: none. */
splat splat_quantise(splat s, __global const float *restrict steps) {
    float scale = steps[GSCL_STEP_SCALE];
    if (!(scale > 0.0f)) {
        splat_set_axes(&s, s.log_s1, s.log_s2);
        return s;
    }
    splat_set_axes(&s, fmax(rint((s.log_s1 + M_LN2_F) / scale), (vfloat)(0.0f)) * scale - M_LN2_F,
                   fmax(rint((s.log_s2 + M_LN2_F) / scale), (vfloat)(0.0f)) * scale - M_LN2_F);
    vfloat cell = fmax(steps[GSCL_STEP_POSITION] * fmax(s.s1, s.s2), (vfloat)(1.0f / 32.0f));
    vfloat aspect = fmax(s.s1, s.s2) / fmin(s.s1, s.s2);
    vfloat major_theta = (vfloat)(0.0f);
    if (ROTATION) {
        vfloat angles =
            clamp(ceil(M_PI_F / steps[GSCL_STEP_ANGLE] * (aspect - 1.0f / aspect)), (vfloat)(1.0f), (vfloat)(512.0f));
        vfloat turn = s.log_s1 < s.log_s2 ? (vfloat)(M_PI_2_F) : (vfloat)(0.0f); /* codes count from the major axis */
        major_theta = rint((s.theta + turn) * angles / M_PI_F) * M_PI_F / angles;
        s.theta = major_theta - turn;
    }
    splat_quantise_centre(&s, cell, rint(aspect), major_theta);
    const vfloat fineness = splat_colour_fineness(&s, steps);
    const vfloat luma = steps[GSCL_STEP_LUMA] / fineness;
#if COLOURS == 3
    const vfloat chroma = steps[GSCL_STEP_CHROMA] / fineness;
    vfloat y = rint((s.colour[0] + 2.0f * s.colour[1] + s.colour[2]) * 0.25f / luma) * luma;
    vfloat co = rint((s.colour[0] - s.colour[2]) / chroma) * chroma;
    vfloat cg = rint((s.colour[1] - 0.5f * (s.colour[0] + s.colour[2])) / chroma) * chroma;
    colour_from_ycocg(y, co, cg, s.colour);
#else
    s.colour[0] = rint(s.colour[0] / luma) * luma;
#endif
#if ALPHA_CHANNEL
    s.colour[COLOURS] = rint(s.colour[COLOURS] / steps[GSCL_STEP_ALPHA]) * steps[GSCL_STEP_ALPHA];
#endif
    if (OPACITY) {
        float levels = steps[GSCL_STEP_OPACITY];
        s.opacity = clamp(rint(s.opacity * levels), (vfloat)(1.0f), (vfloat)(levels)) / levels;
    }
    return s;
}
