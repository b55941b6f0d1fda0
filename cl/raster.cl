/* Rasterisation: weights of splats at pixels and the three ways of blending them. */

/* A fit evaluates each row of each splat twice.  Where one work-item does so, forward and backward in the same order,
 * CACHED_ROWS Gaussians of a tile are cached from the first time to the second.  0: none. */
#if !defined(CACHED_ROWS) || ITEMS > 1
#undef CACHED_ROWS
#define CACHED_ROWS 0
#endif
/* Whether the rows of a splat are, of which a tile's splats before it have `row`. */
#define ARE_CACHED(row) ((row) + ROWS <= CACHED_ROWS)

/* Value `k`, a constant, of a row of projected splats.  Rows are aligned to their size.  A GPU loads four values at once where its
 * compiler knows that: it is told by loads of whole vectors, of which it makes one for all values of a vector. */
#if LANES == 4
real vector_value(REALS(4) v, int i) { return i == 0 ? v.x : i == 1 ? v.y : i == 2 ? v.z : v.w; }
#define PROJECTED(row, k) vector_value(((__global const REALS(4) *)(row))[(k) / 4], (k) % 4)
#else
#define PROJECTED(row, k) ((row)[k])
#endif

/* A splat's weight at a row of pixels, before opacity, and its frame coordinates.  An axis-aligned splat is the product
 * of a Gaussian of the column and a Gaussian of the row, which is updated from row to row by multiplication. */
typedef struct {
    pix u, v; /* gauss = 2^-(u^2 + v^2) */
    /* Of axis-aligned splats: 2^-u^2, 2^-v^2, the ratio of its next value to this, the ratio of two ratios. */
    pix column;
    real row, row_ratio, row_bend;
    pix gauss;
    pix weight; /* max(0, gauss - floor) */
} splat_weight;

/* Begins at a row that the outline touches, `dx` and `dy` from the centre. */
ALWAYS_INLINE void weight_begin(splat_weight *s, pix dx, real dy, __global const real *projected) {
    if (ROTATION) {
        s->u = fma(dx, (pix)(PROJECTED(projected, GSCL_PROJECTED_UX)),
                   (pix)(dy * PROJECTED(projected, GSCL_PROJECTED_UY)));
        s->v = fma(dx, (pix)(PROJECTED(projected, GSCL_PROJECTED_VX)),
                   (pix)(dy * PROJECTED(projected, GSCL_PROJECTED_VY)));
        return;
    }
    real step = PROJECTED(projected, GSCL_PROJECTED_VY), v = dy * step;
    s->u = dx * PROJECTED(projected, GSCL_PROJECTED_UX);
    s->v = (pix)(v);
    /* Exactly 0 outside the support: `row` may be rounded to more than 1 and would then give a gradient there. */
    s->column = select((pix)(0.0f), pix_exp2(-s->u * s->u), PIX_MASK(s->u * s->u < (pix)(SUPPORT2)));
    s->row = exp2(-v * v);
    s->row_ratio = exp2(fmin(-2.0f * v * step, (real)(64.0f))) * PROJECTED(projected, GSCL_PROJECTED_ROW_STEP);
    s->row_bend = PROJECTED(projected, GSCL_PROJECTED_ROW_STEP) * PROJECTED(projected, GSCL_PROJECTED_ROW_STEP);
}

/* Sets the weight from a Gaussian. */
void weight_from_gauss(splat_weight *s, pix gauss) {
    s->gauss = gauss;
    s->weight = fmax(gauss - GSCL_WEIGHT_FLOOR, (pix)(0.0f));
}

/* Evaluates the Gaussian from the coordinates. */
void weight_evaluate(splat_weight *s) {
    weight_from_gauss(s, ROTATION ? pix_exp2(fma(-s->u, s->u, -s->v * s->v)) : s->column * s->row);
}

/* Goes on to the next row. */
void weight_next_row(splat_weight *s, __global const real *restrict projected) {
    if (ROTATION) {
        s->u += PROJECTED(projected, GSCL_PROJECTED_UY);
    } else {
        s->row *= s->row_ratio;
        s->row_ratio *= s->row_bend;
    }
    s->v += PROJECTED(projected, GSCL_PROJECTED_VY);
}

/* Rotated splats with a larger ROW_STEP: where the last of 16 rows lies inside the support, the Gaussian of the first is at
 * least 2^-(sqrt(SUPPORT2) + 15 sqrt(0.28))^2 = 2^-124, a normal number. */
#define SMOOTH_ROW_STEP 0.8236f /* 2^-0.28 */
#define SMALLEST_GAUSS 0x1p-124f

/* The Gaussians of a splat in `count` rows, from that of `s` on.  Those of a splat that changes slowly from row to row follow
 * from each other by their ratio: three operations instead of an exponential.  Their relative error grows to 5e-5 in 16 rows,
 * which gradients bear, but not those of `alpha`, which divide by what a splat lets through.  What is only drawn takes
 * weight_evaluate. */
ALWAYS_INLINE void gauss_rows(pix *rows, splat_weight s, int count, __global const real *projected) {
    const real step = PROJECTED(projected, GSCL_PROJECTED_ROW_STEP);
    const bool is_exact = BLEND == GSCL_ALPHA || step < SMOOTH_ROW_STEP;
    if (!ROTATION || is_exact) {
        for (int r = 0; r < count; r++, weight_next_row(&s, projected)) {
            weight_evaluate(&s);
            rows[r] = s.gauss;
        }
        return;
    }
    pix exponent = fma(-s.u, s.u, -s.v * s.v);
    pix slope =
        -2.0f * fma(s.u, (pix)(PROJECTED(projected, GSCL_PROJECTED_UY)), s.v * PROJECTED(projected, GSCL_PROJECTED_VY));
    pix gauss = pix_exp2_wide(fmax(exponent, (pix)(-124.0f)));
    pix ratio = pix_exp2_wide(clamp(slope, (pix)(-64.0f), (pix)(64.0f))) * step;
    /* Lanes that are too far away to get into the support stay as small as they are. */
    ratio = select((pix)(0.0f), ratio, PIX_MASK(exponent > (pix)(-124.0f)));
    const real bend = step * step;
    for (int r = 0; r < count; r++) {
        rows[r] = gauss;
        gauss = fmax(gauss * ratio, (pix)(SMALLEST_GAUSS)); /* arithmetic with subnormal numbers is slow */
        ratio *= bend;
    }
}

/* A splat's wave at a row of pixels, `dx` and `dy` from its centre, delayed by `turns`; 0 for a splat without one. */
pix wave_at(pix dx, real dy, real turns, __global const real *restrict projected) {
    real amplitude = PROJECTED(projected, GSCL_PROJECTED_WAVE_AMPLITUDE);
    if (!(amplitude > 0.0f)) return (pix)(0.0f);
    return amplitude * pix_wave(dx, dy, PROJECTED(projected, GSCL_PROJECTED_WAVE_X),
                                PROJECTED(projected, GSCL_PROJECTED_WAVE_Y),
                                turns + PROJECTED(projected, GSCL_PROJECTED_WAVE_PHASE));
}

#define WITH_OPACITY(weight, projected) (OPACITY ? (weight) * (projected)[GSCL_PROJECTED_OPACITY] : (weight))

/* The blend's running sums of one work-item. */
typedef struct {
    pix colour[CHANNELS][ROWS];
    /* `normalized`: the sum of weights, after canvas_end its reciprocal.  `sum`: 1.  `alpha`: transmittance - 1, because a
     * product near 1 would not change by very small opacities. */
    pix weight_sum[ROWS];
} canvas;

void canvas_begin(canvas *c, __constant float *background) {
    const float share = BLEND == GSCL_NORMALIZED ? GSCL_EPSILON : BLEND == GSCL_SUM ? 1.0f : 0.0f;
    for (int r = 0; r < ROWS; r++) {
        UNROLL
        for (int k = 0; k < CHANNELS; k++) c->colour[k][r] = (pix)(share * background[k]);
        c->weight_sum[r] = (pix)(share);
    }
}

#if defined(EARLY_STOP)
#define STOP_INTERVAL 4 /* splats from one test to the next */
/* Whether the transmittance is so low at all pixels that splats further behind are not drawn. */
bool canvas_is_opaque(const canvas *c) {
    for (int r = 0; r < ROWS; r++)
        if (any(PIX_MASK(1.0f + c->weight_sum[r] > (pix)(EARLY_STOP)))) return false;
    return true;
}
#endif

/* Adds a row of a splat; `dx` and `dy` from its centre. */
ALWAYS_INLINE void canvas_add_row(canvas *c, int r, pix weight, pix dx, real dy, __global const real *projected) {
    pix w = WITH_OPACITY(weight, projected);
    if (BLEND == GSCL_ALPHA) {
        w = fmin(w, (pix)(GSCL_MAX_ALPHA));
        w = fma(w, c->weight_sum[r], w);
        c->weight_sum[r] -= w;
    } else if (BLEND == GSCL_NORMALIZED) {
        c->weight_sum[r] += w;
    }
    UNROLL
    for (int k = 0; k < CHANNELS; k++)
        c->colour[k][r] = fma(w, (pix)(PROJECTED(projected, GSCL_PROJECTED_COLOUR + k)), c->colour[k][r]);
    if (!TEXTURE || !(PROJECTED(projected, GSCL_PROJECTED_WAVE_AMPLITUDE) > 0.0f)) return;
    pix wave = w * wave_at(dx, dy, 0.0f, projected);
    UNROLL
    for (int k = 0; k < COLOURS; k++) c->colour[k][r] += wave;
}

/* Adds a tile's splats; `cached`: CACHED_ROWS Gaussians, or NULL.  `alpha` goes from the front (the last stored) to the
 * back. */
void canvas_blend(canvas *c, pix px, real py, int row0, __global const real *restrict splats,
                  __global const uint *restrict entries, int count, pix *restrict cached) {
    int row = 0;
    for (int i = 0; i < count; i++) {
#if defined(EARLY_STOP)
        if (BLEND == GSCL_ALPHA && i % STOP_INTERVAL == STOP_INTERVAL - 1 && canvas_is_opaque(c)) break;
#endif
        uint entry = entries[BLEND == GSCL_ALPHA ? count - 1 - i : i];
        __global const real *restrict projected = splats + (size_t)GSCL_ENTRY_SPLAT(entry) * GSCL_PROJECTED;
        int first = max((int)GSCL_ENTRY_FIRST_ROW(entry) - row0, 0);
        int last = min((int)GSCL_ENTRY_LAST_ROW(entry) - row0, ROWS - 1);
        pix dx = px - PROJECTED(projected, GSCL_PROJECTED_X);
        real dy = py - PROJECTED(projected, GSCL_PROJECTED_Y);
        splat_weight s;
        weight_begin(&s, dx, dy + (float)first, projected);
        if (cached && ARE_CACHED(row)) {
            gauss_rows(cached + row, s, last - first + 1, projected);
            for (int r = first; r <= last; r++) {
                weight_from_gauss(&s, cached[row++]);
                canvas_add_row(c, r, s.weight, dx, dy + (float)r, projected);
            }
            continue;
        }
        for (int r = first; r <= last; r++, weight_next_row(&s, projected)) {
            weight_evaluate(&s);
            canvas_add_row(c, r, s.weight, dx, dy + (float)r, projected);
        }
    }
}

/* Turns the sums into colours, and the sum of weights of `normalized` into its reciprocal. */
void canvas_end(canvas *c, __constant float *background) {
    for (int r = 0; r < ROWS; r++) {
        if (BLEND == GSCL_NORMALIZED) {
            c->weight_sum[r] = 1.0f / c->weight_sum[r];
            UNROLL
            for (int k = 0; k < CHANNELS; k++) c->colour[k][r] *= c->weight_sum[r];
        } else if (BLEND == GSCL_ALPHA) {
            UNROLL
            for (int k = 0; k < CHANNELS; k++)
                c->colour[k][r] = fma(1.0f + c->weight_sum[r], (pix)(background[k]), c->colour[k][r]);
        }
    }
}

/* The pixels of a work-item of a group, which draws the tile of its number. */
typedef struct {
    int x, y;  /* its first pixel, in the image */
    int row0;  /* its first row within the tile */
    int lanes; /* pixels of a row inside the image, may be <= 0 or > LANES */
    int rows;  /* rows inside the image, may be <= 0 or > ROWS */
    size_t tile;
} pixel_block;

pixel_block pixel_block_of(size_t tile, gscl_image_shape image) {
    pixel_block p;
    p.tile = tile;
    p.row0 = (int)(get_local_id(0) / ITEMS_X) * ROWS;
    p.x = (int)(p.tile % (size_t)image.tiles_x) * GSCL_TILE + (int)(get_local_id(0) % ITEMS_X) * LANES;
    p.y = (int)(p.tile / (size_t)image.tiles_x) * GSCL_TILE + p.row0;
    p.lanes = image.width - p.x;
    p.rows = min(image.height - p.y, ROWS);
    return p;
}

/* Begins a further run of splats: sums of 0. */
void canvas_clear(canvas *c) {
    for (int r = 0; r < ROWS; r++) {
        UNROLL
        for (int k = 0; k < CHANNELS; k++) c->colour[k][r] = (pix)(0.0f);
        c->weight_sum[r] = (pix)(BLEND == GSCL_SUM ? 1.0f : 0.0f);
    }
}

/* Adds the sums of the runs before; `alpha`: of those in front. */
void canvas_add(canvas *c, const canvas *before) {
    for (int r = 0; r < ROWS; r++) {
        pix transmittance = (pix)(1.0f);
        if (BLEND == GSCL_ALPHA) {
            transmittance += before->weight_sum[r];
            c->weight_sum[r] = fma(transmittance, c->weight_sum[r], before->weight_sum[r]);
        } else if (BLEND == GSCL_NORMALIZED) {
            c->weight_sum[r] += before->weight_sum[r];
        }
        UNROLL
        for (int k = 0; k < CHANNELS; k++) c->colour[k][r] = fma(transmittance, c->colour[k][r], before->colour[k][r]);
    }
}

/* Adds a tile's splats in runs, because the rounding errors of a sum grow with the number of its terms.  Not inlined, so
 * that it takes no registers where it is not called. */
__attribute__((noinline)) void canvas_blend_runs(canvas *c, pix px, real py, int row0,
                                                 __global const real *restrict splats,
                                                 __global const uint *restrict entries, int count) {
    for (int done = 0; done < count; done += GSCL_RUN) {
        canvas run;
        int n = min(count - done, GSCL_RUN), first = BLEND == GSCL_ALPHA ? count - done - n : done;
        canvas_clear(&run);
        canvas_blend(&run, px, py, row0, splats, entries + first, n, NULL);
        canvas_add(&run, c);
        *c = run;
    }
}

/* Draws a tile. */
void canvas_draw(canvas *c, pixel_block p, __global const real *restrict splats, __global const uint *restrict entries,
                 int2 range, __constant float *background) {
    pix px = pix_offsets() + ((float)p.x + 0.5f);
    real py = (float)p.y + 0.5f;
    int count = range.y - range.x;
    canvas_begin(c, background);
    if (count <= GSCL_RUN) {
        canvas_blend(c, px, py, p.row0, splats, entries + range.x, count, NULL);
    } else {
        canvas sums = *c;
        canvas_blend_runs(&sums, px, py, p.row0, splats, entries + range.x, count);
        *c = sums;
    }
    canvas_end(c, background);
}

/* Floats from one plane of an image to the next. */
size_t plane_size(gscl_image_shape image) { return (size_t)image.width * (size_t)image.height; }
