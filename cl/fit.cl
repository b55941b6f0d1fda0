/* Gradients of one step of the fit over a tile: a forward pass that renders it, the loss, and a backward pass from the
 * loss to every splat of the tile.  Where a single work-item draws the tile, it takes one splat after another.  Where
 * many do, they share the splats: each adds up a column of the tile's pixel vectors for a splat, and those of a splat add
 * their columns in a fixed order.
 * In `alpha` a splat depends on those behind it, and all work-items add up the same splat. */

/* Per-pixel state of the backward pass. */
typedef struct {
    pix slope[CHANNELS][ROWS]; /* dL/dcolour of the rendering; `normalized`: divided by the sum of weights */
    pix dot[ROWS];             /* dot(rendering, slope); `alpha`: of the part behind the current splat */
    pix transmittance[ROWS];   /* `alpha`: of the splats in front */
} backward;

/* The error of luma in a row of pixels; 0 outside the image. */
pix luma_error(const canvas *c, int r, __global const float *restrict target, int lanes) {
    pix luma = -pix_load_clipped(target, lanes);
    UNROLL
    for (int k = 0; k < COLOURS; k++) luma = fma((pix)(luma_share(k)), c->colour[k][r], luma);
    return luma * pix_inside(lanes);
}

/* Adds the loss of an error `e` of channel `k`; returns half its derivative (of L1: its derivative).  `luma`: the weighted
 * error of luma. */
pix loss_derivative(pix *loss, pix e, int k, pix weight, pix luma) {
    if (WEIGHTED == GSCL_WEIGHTED_PIXELS) {
        pix d = weight * e;
        *loss = fma(d, e, *loss);
        return d;
    }
    if (WEIGHTED == GSCL_WEIGHTED_LUMA) {
        *loss = fma(e, e, *loss);
        return k < COLOURS ? fma((pix)(luma_share(k)), luma, e) : e;
    }
    if (LOSS == GSCL_LOSS_KIND_L2) {
        *loss = fma(e, e, *loss);
        return e;
    }
    *loss += fabs(e);
    return sign(e);
}

/* Starts the backward pass from the rendering on the canvas; returns this work-item's part of the loss.  `target` is as
 * in fit_tiles. */
pix backward_begin(backward *b, const canvas *c, pixel_block p, __global const float *restrict target,
                   gscl_fit_settings settings) {
    const size_t plane = (size_t)settings.shape.width * (size_t)settings.level_height;
    pix loss = (pix)(0.0f);
    for (int r = 0; r < ROWS; r++) {
        const size_t at =
            (size_t)((p.y + r) * settings.row_step + settings.first_row) * settings.shape.width + (size_t)p.x;
        b->dot[r] = (pix)(0.0f);
        const bool inside = r < p.rows && p.lanes > 0;
        pix weight = (pix)(0.0f), luma = (pix)(0.0f);
        if (WEIGHTED != GSCL_WEIGHTED_NOT && inside) weight = pix_load_clipped(target + CHANNELS * plane + at, p.lanes);
        if (WEIGHTED == GSCL_WEIGHTED_LUMA) {
            if (inside) luma = luma_error(c, r, target + (CHANNELS + 1) * plane + at, p.lanes);
            loss = fma(weight * luma, luma, loss);
            luma *= weight;
        }
        UNROLL
        for (int k = 0; k < CHANNELS; k++) {
            pix d = (pix)(0.0f);
            if (inside) {
                pix value = pix_load_clipped(target + k * plane + at, p.lanes);
                d = LOSS == GSCL_LOSS_KIND_EXTERNAL
                        ? value
                        : loss_derivative(&loss, (c->colour[k][r] - value) * pix_inside(p.lanes), k, weight, luma);
            }
            d *= settings.derivative_scale;
            if (BLEND == GSCL_NORMALIZED) d *= c->weight_sum[r]; /* the reciprocal, after canvas_end */
            b->slope[k][r] = d;
            b->dot[r] = fma(c->colour[k][r], d, b->dot[r]);
        }
        b->transmittance[r] = (pix)(1.0f);
    }
    return loss;
}

#if ITEMS > 1
#define SHARES_SPLATS (BLEND != GSCL_ALPHA) /* work-items take different splats */
#else
#define SHARES_SPLATS 0
#endif

#if ITEMS == 1
/* The sums over lanes of eight vectors at once, a third of the instructions of eight single sums: pairs of vectors are added
 * within each four lanes, in which shuffles are cheapest. */
float16 add_halves(float16 p, float16 q) {
    return (float16)(p.s0, q.s0, p.s1, q.s1, p.s4, q.s4, p.s5, q.s5, p.s8, q.s8, p.s9, q.s9, p.sc, q.sc, p.sd, q.sd) +
           (float16)(p.s2, q.s2, p.s3, q.s3, p.s6, q.s6, p.s7, q.s7, p.sa, q.sa, p.sb, q.sb, p.se, q.se, p.sf, q.sf);
}
float16 add_pairs(float16 p, float16 q) {
    return (float16)(p.s0, p.s1, q.s0, q.s1, p.s4, p.s5, q.s4, q.s5, p.s8, p.s9, q.s8, q.s9, p.sc, p.sd, q.sc, q.sd) +
           (float16)(p.s2, p.s3, q.s2, q.s3, p.s6, p.s7, q.s6, q.s7, p.sa, p.sb, q.sa, q.sb, p.se, p.sf, q.se, q.sf);
}
float8 pix_sum_8(const pix *restrict s) {
    float16 a = add_pairs(add_halves(s[0], s[1]), add_halves(s[2], s[3]));
    float16 b = add_pairs(add_halves(s[4], s[5]), add_halves(s[6], s[7]));
    float8 c = a.lo + a.hi, d = b.lo + b.hi;
    return (float8)(c.lo, d.lo) + (float8)(c.hi, d.hi);
}
#define SUMS LARGER(MAX_SLOT, 8) /* no fewer than pix_sum_8 reads */

/* Stores the sums of one work-item. */
void slot_store(__global float *restrict slot, const pix *restrict sums) {
    float first[8];
    vstore8(pix_sum_8(sums), 0, first);
    UNROLL
    for (int k = 0; k < MAX_SLOT; k++)
        if (k < SLOT) slot[k] = k < 8 ? first[k] : pix_sum(sums[k]);
}
#else
#define SUMS MAX_SLOT
#endif

/* Adds one row of one splat to its sums. */
ALWAYS_INLINE void slot_add_row(pix *sums, backward *b, int r, splat_weight s, pix dx, float dy,
                                __global const float *projected) {
    pix w = WITH_OPACITY(s.weight, projected);
    pix by_share = (pix)(0.0f); /* dL/dshare: the derivative by this splat's part of the blend */
    UNROLL
    for (int k = 0; k < CHANNELS; k++)
        by_share = fma((pix)(PROJECTED(projected, GSCL_PROJECTED_COLOUR + k)), b->slope[k][r], by_share);
    pix by_wave = (pix)(0.0f); /* dL/dwave */
    if (TEXTURE) {
        UNROLL
        for (int k = 0; k < COLOURS; k++) by_wave += b->slope[k][r];
        by_share = fma(wave_at(dx, dy, 0.0f, projected), by_wave, by_share);
    }
    pix share = w, h = BLEND == GSCL_NORMALIZED ? by_share - b->dot[r] : by_share;
    if (BLEND == GSCL_ALPHA) {
        pix_mask not_clamped = PIX_MASK(w < (pix)(GSCL_MAX_ALPHA));
        w = fmin(w, (pix)(GSCL_MAX_ALPHA));
        share = w * b->transmittance[r];
        b->dot[r] = fma(-share, by_share, b->dot[r]); /* of the part behind this splat */
        h = select((pix)(0.0f), fma(b->transmittance[r], by_share, -b->dot[r] / (1.0f - w)), not_clamped);
        b->transmittance[r] -= share;
    }
    pix t = select((pix)(0.0f), WITH_OPACITY(h * s.gauss, projected), s.weight > (pix)(0.0f));
    pix tv = t * s.v;
    if (ROTATION) {
        pix tu = t * s.u;
        sums[GSCL_SLOT_U] += tu;
        sums[GSCL_SLOT_UU] = fma(tu, s.u, sums[GSCL_SLOT_UU]);
        sums[GSCL_SLOT_UV] = fma(tu, s.v, sums[GSCL_SLOT_UV]);
    } else {
        sums[GSCL_SLOT_U] += t; /* u is the same in all rows, slot_end multiplies by it */
    }
    sums[GSCL_SLOT_V] += tv;
    sums[SLOT_VV] = fma(tv, s.v, sums[SLOT_VV]);
    if (OPACITY) sums[SLOT_OPACITY] = fma(h, s.weight, sums[SLOT_OPACITY]);
    UNROLL
    for (int k = 0; k < CHANNELS; k++) sums[SLOT_COLOUR + k] = fma(share, b->slope[k][r], sums[SLOT_COLOUR + k]);
    if (TEXTURE) sums[SLOT_WAVE] = fma(share * by_wave, wave_at(dx, dy, 0.25f, projected), sums[SLOT_WAVE]);
}

/* Finishes the sums after the last row. */
void slot_end(pix *restrict sums, splat_weight s) {
    if (ROTATION) return;
    sums[GSCL_SLOT_U] *= s.u;
    sums[GSCL_SLOT_UU] = fma(sums[GSCL_SLOT_U], s.u, sums[GSCL_SLOT_UU]);
}

/* The step until which a tile with this loss is skipped, or 0. */
int skip_until_step(float loss, int pixels, float threshold, int step) {
    return loss < threshold * (float)pixels ? step + 1 + GSCL_SKIP_STEPS : 0;
}

/* Where the splats of a tile and their slots are. */
typedef struct {
    __global const float *splats;
    __global const uint *entries;
    __global float *slots;
    int2 range; /* of the entries and slots */
} tile_splats;

#if SHARES_SPLATS
/* The backward pass's state of a tile, for all its work-items: vectors, so that they are aligned to their size.  Work-items
 * side by side read a row of vectors at a time, so that rows need no padding against conflicts of memory banks. */
typedef struct {
    pix slope[CHANNELS][GSCL_TILE * ITEMS_X], dot[GSCL_TILE * ITEMS_X];
    /* Of ITEMS_X sums those of each work-item.  A vector of padding after each sum's keeps those that are read at once in
     * different memory banks. */
    pix parts[ITEMS_X][ITEMS + 1];
} shared_backward;

/* Shares a work-item's state.  Pixels outside the image have slopes of 0. */
void backward_share(__local shared_backward *shared, const backward *b, int column, int row0) {
    for (int r = 0; r < ROWS; r++) {
        int at = (row0 + r) * ITEMS_X + column;
        shared->dot[at] = b->dot[r];
        UNROLL
        for (int k = 0; k < CHANNELS; k++) shared->slope[k][at] = b->slope[k][r];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

/* Adds a column of pixel vectors to the sums of a splat; (px, py): the first pixel vector of the tile. */
void slot_add_column(pix *sums, __local const shared_backward *shared, int column, uint entry, pix px, float py,
                     __global const float *projected) {
    int first = (int)GSCL_ENTRY_FIRST_ROW(entry), last = (int)GSCL_ENTRY_LAST_ROW(entry);
    pix dx = px + ((float)(column * LANES) - PROJECTED(projected, GSCL_PROJECTED_X));
    float dy = py - PROJECTED(projected, GSCL_PROJECTED_Y);
    splat_weight s;
    weight_begin(&s, dx, dy + (float)first, projected);
    for (int r = first; r <= last; r++, weight_next_row(&s, projected)) {
        const int at = r * ITEMS_X + column;
        backward b;
        b.dot[0] = shared->dot[at];
        UNROLL
        for (int k = 0; k < CHANNELS; k++) b.slope[k][0] = shared->slope[k][at];
        weight_evaluate(&s);
        slot_add_row(sums, &b, 0, s, dx, dy + (float)r, projected);
    }
    slot_end(sums, s);
}

/* Stores the slot of a splat, of which ITEMS_X work-items side by side have summed a column each: one of ITEMS_X sums at a time
 * is the share of each, which adds the columns from left to right.  `slot`: NULL if there is no splat. */
void slot_store(__global float *slot, const pix *sums, __local shared_backward *shared) {
    const int item = (int)get_local_id(0), column = item % ITEMS_X;
    UNROLL
    for (int first = 0; first < SLOT; first += ITEMS_X) {
        UNROLL
        for (int k = 0; k < ITEMS_X; k++)
            if (first + k < SLOT) shared->parts[k][item] = sums[first + k];
        barrier(CLK_LOCAL_MEM_FENCE);
        if (slot && first + column < SLOT) {
            pix total = (pix)(0.0f);
            UNROLL
            for (int x = 0; x < ITEMS_X; x++) total += shared->parts[column][item - column + x];
            slot[first + column] = pix_sum(total);
        }
        barrier(CLK_LOCAL_MEM_FENCE); /* before the next sums take the place of these */
    }
}

/* Writes the slots of all splats, ITEMS_Y of them at a time; (px, py): the first pixel vector of the tile. */
void backward_splats(const tile_splats *t, __local shared_backward *shared, pix px, float py) {
    const int column = (int)get_local_id(0) % ITEMS_X;
    for (int begin = t->range.x; begin < t->range.y; begin += ITEMS_Y) { /* the same for all, because of the barriers */
        const int i = begin + (int)get_local_id(0) / ITEMS_X;
        pix sums[SUMS];
        UNROLL
        for (int k = 0; k < SUMS; k++) sums[k] = (pix)(0.0f);
        if (i < t->range.y) {
            const uint entry = t->entries[i];
            slot_add_column(sums, shared, column, entry, px, py,
                            t->splats + (size_t)GSCL_ENTRY_SPLAT(entry) * GSCL_PROJECTED);
        }
        slot_store(i < t->range.y ? t->slots + (size_t)i * SLOT : NULL, sums, shared);
    }
}
#else
/* Writes the slots of all splats; (px, py): the first pixel vector of this work-item.  `cached`: the Gaussians of the
 * forward pass, CACHED_ROWS of them.  `shared`: where work-items add their sums, SLOT * ITEMS floats. */
void backward_splats(const tile_splats *t, backward *b, pix px, float py, int row0, const pix *restrict cached,
                     __local float *restrict shared) {
    int row = 0;
    for (int i = t->range.x; i < t->range.y; i++) {
        int j = BLEND == GSCL_ALPHA ? t->range.y - 1 - (i - t->range.x) : i;
        uint entry = t->entries[j];
        __global float *slot = t->slots + (size_t)j * SLOT;
        __global const float *restrict projected = t->splats + (size_t)GSCL_ENTRY_SPLAT(entry) * GSCL_PROJECTED;
        int first = max((int)GSCL_ENTRY_FIRST_ROW(entry) - row0, 0);
        int last = min((int)GSCL_ENTRY_LAST_ROW(entry) - row0, ROWS - 1);
        pix dx = px - PROJECTED(projected, GSCL_PROJECTED_X);
        float dy = py - PROJECTED(projected, GSCL_PROJECTED_Y);
        pix sums[SUMS];
        UNROLL
        for (int k = 0; k < SUMS; k++) sums[k] = (pix)(0.0f);
        splat_weight s;
        weight_begin(&s, dx, dy + (float)first, projected);
        const bool is_cached = ARE_CACHED(row);
        for (int r = first; r <= last; r++, weight_next_row(&s, projected)) {
            if (is_cached) weight_from_gauss(&s, cached[row++]);
            else weight_evaluate(&s);
            slot_add_row(sums, b, r, s, dx, dy + (float)r, projected);
        }
        slot_end(sums, s);
#if ITEMS == 1
        slot_store(slot, sums);
#else
        int item = (int)get_local_id(0);
        UNROLL
        for (int k = 0; k < SLOT; k++) shared[k * ITEMS + item] = pix_sum(sums[k]);
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item < SLOT) {
            float total = 0.0f;
            for (int j = 0; j < ITEMS; j++) total += shared[item * ITEMS + j];
            slot[item] = total;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
#endif
    }
}
#endif

/* Writes a gradient slot for each entry and the loss of each tile, from the rows of the level that are drawn.  `target`:
 * CHANNELS planes of the level and those of WEIGHTED; where the loss is EXTERNAL, planes of its derivative by the
 * rendering.
 * A tile whose loss per pixel is below the threshold is skipped for the next GSCL_SKIP_STEPS steps, in which its slots
 * are 0 and its loss stays the same.  `skip_until`: for each tile the step with which it is computed again. */
__kernel GROUP_OF(ITEMS) void fit_tiles(__global const float *restrict splats, __global const uint *restrict entries,
                                        __global const int2 *restrict tile_ranges, __constant float *background,
                                        __global const float *restrict target, gscl_fit_settings settings,
                                        __global const gscl_fit_control *restrict control,
                                        __global float *restrict slots, __global float *restrict tile_loss,
                                        __global int *restrict skip_until) {
#if SHARES_SPLATS
    __local shared_backward shared_state;
    __local float *shared = (__local float *)shared_state.parts;
#elif ITEMS > 1
    __local float shared[MAX_SLOT * ITEMS];
#else
    __local float *shared = NULL;
#endif
    const int width = settings.shape.width, height = settings.shape.height, step = settings.step;
    pixel_block p = pixel_block_of(get_group_id(0), settings.shape);
    int2 range = tile_ranges[p.tile];
    bool is_skipped = skip_until[p.tile] > step;
    int pixels = min(GSCL_TILE, width - (p.x & -GSCL_TILE)) * min(GSCL_TILE, height - (p.y & -GSCL_TILE));
    if (is_skipped) {
        for (int i = range.x * SLOT + (int)get_local_id(0); i < range.y * SLOT; i += ITEMS) slots[i] = 0.0f;
#if ITEMS == 1
        return;
#else
        range.y = range.x; /* no return, because of the barriers below */
#endif
    }
    pix px = pix_offsets() + ((float)p.x + 0.5f);
    float py = (float)p.y + 0.5f;
    canvas c;
    canvas_begin(&c, background);
#if CACHED_ROWS
    pix cached[CACHED_ROWS];
#else
    pix *cached = NULL;
#endif
    canvas_blend(&c, px, py, p.row0, splats, entries + range.x, range.y - range.x, cached);
    canvas_end(&c, background);
    backward b;
    pix loss = backward_begin(&b, &c, p, target, settings);
    tile_splats t = {splats, entries, slots, range};
#if SHARES_SPLATS
    backward_share(&shared_state, &b, (int)get_local_id(0) % ITEMS_X, p.row0);
    backward_splats(&t, &shared_state, pix_offsets() + ((float)(p.x & -GSCL_TILE) + 0.5f),
                    (float)(p.y & -GSCL_TILE) + 0.5f);
#else
    backward_splats(&t, &b, px, py, p.row0, cached, shared);
#endif
#if ITEMS == 1
    float total = pix_sum(loss);
    tile_loss[p.tile] = total;
    skip_until[p.tile] = skip_until_step(total, pixels, control->skip_threshold, step);
#else
    shared[get_local_id(0)] = pix_sum(loss);
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE); /* also: all have read skip_until */
    if (get_local_id(0) == 0 && !is_skipped) {
        float total = 0.0f;
        for (int j = 0; j < ITEMS; j++) total += shared[j];
        tile_loss[p.tile] = total;
        skip_until[p.tile] = skip_until_step(total, pixels, control->skip_threshold, step);
    }
#endif
}
