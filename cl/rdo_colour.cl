/* The squared error as a function of a splat's colour, and the choice of its colour codes.
 *
 * While a splat is not in the rendering P, adding it with weight w and colour c changes a pixel to P + s (c - P),
 * s = w / (D + w), where D is the sum of weights (`sum`: P + w c).  The error is therefore a quadratic in c, whose
 * coefficients are summed in one pass over the outline; choosing colour codes needs no further pass. */

/* Error of a colour c, relative to no splat: fixed + sum_k (2 linear_k c_k + square c_k^2). */
typedef struct {
    float fixed, square;
    float error; /* without the splat, under its weight */
    float linear[CHANNELS];
    float luma_linear, luma_square; /* likewise for the luma of c, where WEIGHTED is LUMA */
} quadratic;

/* Places of its sums. */
#define QUADRATIC_LUMA (3 + CHANNELS)
#define QUADRATIC_SUMS (QUADRATIC_LUMA + (MAX_WEIGHTED == GSCL_WEIGHTED_LUMA ? 2 : 0))

ITEMS_INLINE void quadratic_of_sums(quadratic *q, const float *sums) {
    q->fixed = sums[0];
    q->square = sums[1];
    q->error = sums[2];
    ITEMS_UNROLL
    for (int k = 0; k < CHANNELS; k++) q->linear[k] = sums[3 + k];
    if (WEIGHTED == GSCL_WEIGHTED_LUMA) {
        q->luma_linear = sums[QUADRATIC_LUMA];
        q->luma_square = sums[QUADRATIC_LUMA + 1];
    }
}

/* The pixels of a vector as a quadratic sees them. */
typedef struct {
    pix share;  /* s */
    pix weight; /* of squared errors */
    pix rendering[CHANNELS], error[CHANNELS];
    pix luma_weight, luma_error; /* where WEIGHTED is LUMA */
} rdo_pixels;

ALWAYS_INLINE void pixels_load(rdo_pixels *x, const rdo_planes *p, size_t at, int lanes) {
    x->weight = (pix)(1.0f);
    if (WEIGHTED == GSCL_WEIGHTED_PIXELS) x->weight = PIX_LOAD(p->target + CHANNELS * p->plane + at);
    if (WEIGHTED == GSCL_WEIGHTED_LUMA) {
        x->luma_weight = PIX_LOAD(p->target + CHANNELS * p->plane + at);
        x->luma_error = -PIX_LOAD(p->target + (CHANNELS + 1) * p->plane + at);
    }
    UNROLL
    for (int k = 0; k < CHANNELS; k++) {
        x->rendering[k] = RDO_LOAD(p->rendering + k * p->plane + at, lanes);
        x->error[k] = x->rendering[k] - PIX_LOAD(p->target + k * p->plane + at);
        if (WEIGHTED == GSCL_WEIGHTED_LUMA && k < COLOURS)
            x->luma_error = fma((pix)(luma_share(k)), x->rendering[k], x->luma_error);
    }
}

/* Adds pixels to the sums of a quadratic.  `without`: errors without the splat; `residual`: errors with a splat of colour
 * 0, to which a colour c adds s c. */
ALWAYS_INLINE void quadratic_add(item_sum *sums, const rdo_pixels *x, const pix *without, const pix *residual) {
    pix weighted = x->weight * x->share, error = (pix)(0.0f), change = (pix)(0.0f);
    sums[1] = ADD_PRODUCTS(weighted, x->share, sums[1]);
    UNROLL
    for (int k = 0; k < CHANNELS; k++) {
        sums[3 + k] = ADD_PRODUCTS(weighted, residual[k], sums[3 + k]);
        error = fma(without[k], without[k], error);
        change = fma(residual[k], residual[k], change);
    }
    sums[0] = ADD_PRODUCTS(x->weight, change - error, sums[0]);
    sums[2] = ADD_PRODUCTS(weighted, error, sums[2]);
}

/* The error of luma where the errors of the channels are others. */
ALWAYS_INLINE pix luma_with(const rdo_pixels *x, const pix *errors) {
    pix luma = x->luma_error;
    UNROLL
    for (int k = 0; k < COLOURS; k++) luma = fma((pix)(luma_share(k)), errors[k] - x->error[k], luma);
    return luma;
}

/* The same for errors of luma. */
ALWAYS_INLINE void quadratic_add_luma(item_sum *sums, const rdo_pixels *x, pix without, pix residual) {
    pix weighted = x->luma_weight * x->share;
    sums[0] = ADD_PRODUCTS(x->luma_weight, fma(residual, residual, -without * without), sums[0]);
    sums[2] = ADD_PRODUCTS(weighted * without, without, sums[2]);
    sums[QUADRATIC_LUMA] = ADD_PRODUCTS(weighted, residual, sums[QUADRATIC_LUMA]);
    sums[QUADRATIC_LUMA + 1] = ADD_PRODUCTS(weighted, x->share, sums[QUADRATIC_LUMA + 1]);
}

/* Moves that are evaluated exactly in a visit; those of opacity always are, because the model does not know them.  Each has a
 * team of work-items. */
#define PREDICTED_MOVES 3
#define EVALUATED_MOVES (PREDICTED_MOVES + (OPACITY ? GSCL_RDO_OPACITY_MOVES : 0))
#define MAX_EVALUATED_MOVES (PREDICTED_MOVES + (MAX_OPACITY ? GSCL_RDO_OPACITY_MOVES : 0)) /* at most MAX_TEAMS */
#define MOVE_TEAM TEAM_OF(MAX_EVALUATED_MOVES)

/* The error as a function of colour, for a splat of this geometry and wave that is not in the rendering: a team's own. */
ITEMS_INLINE void error_of_colour(quadratic *q, const projected_splat *a, const rdo_planes *p, __local float *shared) {
    outline o = outline_of(a, p->width, p->height);
    item_sum sums[QUADRATIC_SUMS];
    float totals[QUADRATIC_SUMS];
    UNROLL
    for (int k = 0; k < QUADRATIC_SUMS; k++) sums[k] = (item_sum)(0.0f);
    FOR_ROWS(MOVE_TEAM, y, o.rows.x, o.rows.y) {
        int2 columns = outline_columns(&o, y);
        FOR_VECTORS(x, columns.x, columns.y) {
            size_t at = (size_t)y * p->width + x;
            int lanes = columns.y - x + 1;
            pix dx = pix_offsets() + ((float)x + 0.5f - o.x), wave = (pix)(0.0f), residual[CHANNELS];
            float dy = (float)y + 0.5f - o.y;
            rdo_pixels pixels;
            pixels_load(&pixels, p, at, lanes);
            pixels.share = blend_weight(dx, dy, a) * pix_inside(lanes);
            if (has_wave(a)) wave = projected_wave(dx, dy, a);
            if (BLEND == GSCL_NORMALIZED) pixels.share /= RDO_LOAD_WEIGHTS(p->weights + at, lanes) + pixels.share;
            UNROLL
            for (int k = 0; k < CHANNELS; k++) {
                pix change = k < COLOURS ? wave : (pix)(0.0f);
                if (BLEND == GSCL_NORMALIZED) change -= pixels.rendering[k];
                residual[k] = fma(pixels.share, change, pixels.error[k]);
            }
            quadratic_add(sums, &pixels, pixels.error, residual);
            if (WEIGHTED == GSCL_WEIGHTED_LUMA)
                quadratic_add_luma(sums, &pixels, pixels.luma_error, luma_with(&pixels, residual));
        }
    }
    ITEMS_SUM(sums, QUADRATIC_SUMS, MOVE_TEAM, totals, shared);
    quadratic_of_sums(q, totals);
}

/* The same error as a function of the codes z of luma, co, cg and alpha:
 * fixed + sum_i (2 linear_i z_i + sum_j square_ij z_i z_j). */
typedef struct {
    float fixed, linear[4], square[4][4];
} colour_form;

#define HAS_COLOUR_CODE(i) ((i) == 0 || ((i) < 3 ? COLOURS == 3 : ALPHA_CHANNEL))

colour_form form_of_quadratic(const quadratic *q, float fineness, gscl_rdo_settings t) {
    const float chroma_step = t.chroma_step / fineness;
    const float steps[4] = {t.luma_step / fineness, chroma_step, chroma_step, t.alpha_step};
    colour_form f = {q->fixed, {0.0f}, {{0.0f}}};
#if COLOURS == 3 /* scalar products of the colours of a unit of each code (colour_from_ycocg) */
    f.linear[0] = q->linear[0] + q->linear[1] + q->linear[2];
    f.linear[1] = 0.5f * (q->linear[0] - q->linear[2]);
    f.linear[2] = 0.5f * (q->linear[1] - q->linear[0] - q->linear[2]);
    f.square[0][0] = 3.0f * q->square;
    f.square[1][1] = 0.5f * q->square;
    f.square[2][2] = 0.75f * q->square;
    f.square[0][2] = f.square[2][0] = -0.5f * q->square;
#else
    f.linear[0] = q->linear[0];
    f.square[0][0] = q->square;
#endif
#if ALPHA_CHANNEL
    f.linear[3] = q->linear[COLOURS];
    f.square[3][3] = q->square;
#endif
#if COLOURS == 3
    const float luma[3] = {1.0f, 0.5f * (luma_share(0) - luma_share(2)),
                           0.5f * (luma_share(1) - luma_share(0) - luma_share(2))};
#else
    const float luma[1] = {1.0f};
#endif
    if (WEIGHTED == GSCL_WEIGHTED_LUMA)
        for (int i = 0; i < COLOURS; i++) {
            f.linear[i] += luma[i] * q->luma_linear;
            for (int j = 0; j < COLOURS; j++) f.square[i][j] += luma[i] * luma[j] * q->luma_square;
        }
    for (int i = 0; i < 4; i++) {
        f.linear[i] *= steps[i];
        for (int j = 0; j < 4; j++) f.square[i][j] *= steps[i] * steps[j];
    }
    return f;
}

/* Half the derivative of the form by code `i`. */
float form_slope(const colour_form *f, const gscl_codes *c, int i) {
    float slope = f->linear[i];
    for (int j = 0; j < 4; j++)
        if (HAS_COLOUR_CODE(j)) slope = fma(f->square[i][j], (float)c->code[GSCL_CODE_LUMA + j], slope);
    return slope;
}

float form_value(const colour_form *f, const gscl_codes *c) {
    float value = f->fixed;
    for (int i = 0; i < 4; i++)
        if (HAS_COLOUR_CODE(i)) value += (float)c->code[GSCL_CODE_LUMA + i] * (f->linear[i] + form_slope(f, c, i));
    return value;
}

/* The fineness of luma, co and cg; alpha has levels only. */
#define CODE_FINENESS(i, fineness) ((i) < 3 ? (fineness) : 1)

/* The place of a code's level in a table of bits. */
int level_place(int code, int fineness) { return (code + GSCL_COLOUR_CODES / 2 * fineness) / fineness; }

/* The bits of the levels; those of their parts belong to the shape. */
float colour_bits(const gscl_codes *c, __global const gscl_rdo_tables *tables) {
    float bits = 0.0f;
    int fineness = codes_fineness(c, tables);
    for (int i = 0; i < 4; i++)
        if (HAS_COLOUR_CODE(i))
            bits += tables->bits[i * GSCL_COLOUR_CODES +
                                 level_place(c->code[GSCL_CODE_LUMA + i], CODE_FINENESS(i, fineness))];
    return bits;
}

#define COLOUR_ROUNDS 6 /* of colour_descend: each changes each code by at most one step */

/* Improves the colour codes one at a time, step by step; returns the cost of the best.  The ranges are copied, because
 * Mesa's compiler fails on a run-time index into a struct that was passed by value. */
ITEMS_INLINE float colour_descend(const quadratic *q, gscl_codes *c, __global const gscl_rdo_tables *tables,
                                  gscl_rdo_settings t) {
    const int min[4] = {t.min[0], t.min[1], t.min[2], t.min[3]}, max[4] = {t.max[0], t.max[1], t.max[2], t.max[3]};
    const int fineness = codes_fineness(c, tables);
    const colour_form f = form_of_quadratic(q, (float)fineness, t);
    for (int round = 0; round < COLOUR_ROUNDS; round++) {
        bool better = false;
        ITEMS_UNROLL
        for (int i = 0; i < 4; i++) {
            if (!HAS_COLOUR_CODE(i)) continue;
            __global const float *bits = tables->bits + i * GSCL_COLOUR_CODES;
            const int fine = CODE_FINENESS(i, fineness);
            int now = c->code[GSCL_CODE_LUMA + i], best = now;
            float lowest = 0.0f, slope = form_slope(&f, c, i);
            for (int step = -1; step <= 1; step += 2) {
                if (now + step < min[i] * fine || now + step >= (max[i] + 1) * fine) continue;
                float change = fma(2.0f * (float)step, slope, f.square[i][i]);
                change = fma(t.lambda, bits[level_place(now + step, fine)] - bits[level_place(now, fine)], change);
                if (change < lowest) {
                    lowest = change;
                    best = now + step;
                }
            }
            c->code[GSCL_CODE_LUMA + i] = best;
            better = better || best != now;
        }
        if (!better) break;
    }
    return form_value(&f, c) + t.lambda * colour_bits(c, tables);
}
