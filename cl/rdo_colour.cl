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
#define MAX_EVALUATED_MOVES (PREDICTED_MOVES + (MAX_OPACITY ? GSCL_RDO_OPACITY_MOVES : 0)) /* less than MAX_TEAMS */
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
 * fixed + sum_i (2 linear_i z_i + sum_j square_ij z_i z_j).  In vectors, which calls pass in registers. */
typedef struct {
    float fixed;
    float4 linear, square; /* square: where i = j */
    float4 mixed;          /* square_ij of luma and co, of luma and cg, of co and cg; those with alpha are 0 */
} colour_form;

#define HAS_COLOUR_CODE(i) ((i) == 0 || ((i) < 3 ? COLOURS == 3 : ALPHA_CHANNEL))

ITEMS_INLINE void form_of_quadratic(colour_form *f, const quadratic *q, float fineness, gscl_rdo_settings t) {
    const float square = q->square, chroma_step = t.chroma_step / fineness;
    const float4 steps = (float4)(t.luma_step / fineness, chroma_step, chroma_step, t.alpha_step);
    float4 luma = (float4)(1.0f, 0.0f, 0.0f, 0.0f);
    f->fixed = q->fixed;
#if COLOURS == 3 /* scalar products of the colours of a unit of each code (colour_from_ycocg) */
    f->linear = (float4)(q->linear[0] + q->linear[1] + q->linear[2], 0.5f * (q->linear[0] - q->linear[2]),
                         0.5f * (q->linear[1] - q->linear[0] - q->linear[2]), 0.0f);
    f->square = (float4)(3.0f * square, 0.5f * square, 0.75f * square, 0.0f);
    f->mixed = (float4)(0.0f, -0.5f * square, 0.0f, 0.0f);
    luma.s1 = 0.5f * (luma_share(0) - luma_share(2));
    luma.s2 = 0.5f * (luma_share(1) - luma_share(0) - luma_share(2));
#else
    f->linear = (float4)(q->linear[0], 0.0f, 0.0f, 0.0f);
    f->square = (float4)(square, 0.0f, 0.0f, 0.0f);
    f->mixed = (float4)(0.0f);
#endif
#if ALPHA_CHANNEL
    f->linear.s3 = q->linear[COLOURS];
    f->square.s3 = square;
#endif
    if (WEIGHTED == GSCL_WEIGHTED_LUMA) {
        f->linear += luma * q->luma_linear;
        f->square += luma * luma * q->luma_square;
        f->mixed += luma.s0013 * luma.s1223 * q->luma_square;
    }
    f->linear *= steps;
    f->square *= steps * steps;
    f->mixed *= steps.s0013 * steps.s1223;
}

/* Half the derivatives of the form by the codes. */
float4 form_slopes(float4 linear, float4 square, float4 mixed, int4 codes) {
    const float4 z = convert_float4(codes);
    float4 slopes = fma((float4)(square.s0, mixed.s0, mixed.s1, 0.0f), (float4)(z.s0), linear);
    if (COLOURS == 3) {
        slopes = fma((float4)(mixed.s0, square.s1, mixed.s2, 0.0f), (float4)(z.s1), slopes);
        slopes = fma((float4)(mixed.s1, mixed.s2, square.s2, 0.0f), (float4)(z.s2), slopes);
    }
    if (ALPHA_CHANNEL) slopes.s3 = fma(square.s3, z.s3, slopes.s3);
    return slopes;
}

float form_value(const colour_form *f, int4 codes) {
    const float4 terms = convert_float4(codes) * (f->linear + form_slopes(f->linear, f->square, f->mixed, codes));
    float value = f->fixed + terms.s0;
    if (COLOURS == 3) value = value + terms.s1 + terms.s2;
    return ALPHA_CHANNEL ? value + terms.s3 : value;
}

/* The bits of the levels of all four codes; those of their parts belong to the shape.  `part`: a code's share of a level. */
float4 levels_bits(int4 codes, float4 part, __global const float *bits) {
    /* The middle of a part is further from the next level than the product is inexact. */
    const int4 levels = convert_int4((convert_float4(codes) + 0.5f) * part + (float)(GSCL_COLOUR_CODES / 2));
    float4 found = (float4)(0.0f);
    found.s0 = bits[levels.s0];
    if (HAS_COLOUR_CODE(1)) found.s1 = bits[GSCL_COLOUR_CODES + levels.s1];
    if (HAS_COLOUR_CODE(2)) found.s2 = bits[2 * GSCL_COLOUR_CODES + levels.s2];
    if (HAS_COLOUR_CODE(3)) found.s3 = bits[3 * GSCL_COLOUR_CODES + levels.s3];
    return found;
}

#define FORM_ROUNDS 6 /* of form_descend: each changes each code by at most one step */
/* Element `i` of a vector, without an index at run time. */
#define ELEMENT(v, i) ((i) == 0 ? (v).s0 : (i) == 1 ? (v).s1 : (i) == 2 ? (v).s2 : (v).s3)

/* Improves the codes of a colour one at a time, step by step.  They stay from `first` to before `end`.  `part`, `bits`: see
 * levels_bits. */
int4 form_descend(float4 linear, float4 square, float4 mixed, int4 codes, int4 first, int4 end, float4 part,
                  float lambda, __global const float *bits) {
    for (int round = 0; round < FORM_ROUNDS; round++) {
        bool better = false;
        /* Of all codes at once, because each waits for the memory as long as all do. */
        const float4 bits_now = levels_bits(codes, part, bits);
        const float4 less = levels_bits(max(codes - 1, first), part, bits) - bits_now;
        const float4 more = levels_bits(min(codes + 1, end - 1), part, bits) - bits_now;
        UNROLL
        for (int i = 0; i < 4; i++) {
            if (!HAS_COLOUR_CODE(i)) continue;
            const float4 slopes = form_slopes(linear, square, mixed, codes);
            const float slope = ELEMENT(slopes, i), curvature = ELEMENT(square, i);
            const int now = ELEMENT(codes, i), lowest = ELEMENT(first, i), above = ELEMENT(end, i);
            float least = 0.0f;
            int best = 0; /* step */
            for (int step = -1; step <= 1; step += 2) {
                if (now + step < lowest || now + step >= above) continue;
                float change = fma(2.0f * (float)step, slope, curvature);
                change = fma(lambda, step < 0 ? ELEMENT(less, i) : ELEMENT(more, i), change);
                if (change < least) {
                    least = change;
                    best = step;
                }
            }
            codes += (int4)(i == 0, i == 1, i == 2, i == 3) * best;
            better = better || best != 0;
        }
        if (!better) break;
    }
    return codes;
}

/* Improves the colour codes; returns the error of the best, and the bits of their levels. */
ITEMS_INLINE float colour_descend(const quadratic *q, gscl_codes *c, __global const gscl_rdo_tables *tables,
                                  gscl_rdo_settings t, float *bits) {
    const int fineness = codes_fineness(c, tables);
    const int4 parts = (int4)(fineness, fineness, fineness, 1); /* alpha has levels only */
    const int4 first = (int4)(t.min[0], t.min[1], t.min[2], t.min[3]) * parts;
    const int4 end = ((int4)(t.max[0], t.max[1], t.max[2], t.max[3]) + 1) * parts;
    int4 codes =
        (int4)(c->code[GSCL_CODE_LUMA], c->code[GSCL_CODE_CO], c->code[GSCL_CODE_CG], c->code[GSCL_CODE_ALPHA]);
    colour_form f;
    const float4 part = 1.0f / convert_float4(parts);
    float4 bits_of_codes;
    form_of_quadratic(&f, q, (float)fineness, t);
    codes = form_descend(f.linear, f.square, f.mixed, codes, first, end, part, t.lambda, tables->bits);
    bits_of_codes = levels_bits(codes, part, tables->bits);
    c->code[GSCL_CODE_LUMA] = codes.s0;
    c->code[GSCL_CODE_CO] = codes.s1;
    c->code[GSCL_CODE_CG] = codes.s2;
    c->code[GSCL_CODE_ALPHA] = codes.s3;
    *bits = bits_of_codes.s0 + bits_of_codes.s1 + bits_of_codes.s2 + bits_of_codes.s3;
    return form_value(&f, codes);
}
