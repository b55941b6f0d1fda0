/* A model of the squared error as a function of a splat's place and shape, from one pass over its pixels.
 *
 * With basis = (u, v, u^2, v^2, u v) the change of a Gaussian is 2 ln 2 gauss sum_j m_j basis_j, where m holds the shift
 * of the centre along u and v, the changes of both ln sigma, and the turn times the difference of the two ratios of the
 * axes.  The change of a pixel by the weight is (c - P) / D (`sum`: c).  The model is the Gauss-Newton quadratic in m and
 * in the colour, which is minimised over the colour.  It predicts which moves are worth an exact evaluation. */
#define MODEL_PARAMS 5

typedef struct {
    quadratic colour; /* exact, at the present place and shape */
    float slope[MODEL_PARAMS], square[MODEL_PARAMS][MODEL_PARAMS];
    float mixed[MODEL_PARAMS][CHANNELS], colour_slope[CHANNELS];
    float error2; /* the squared error under the outline, of the sum of all colours: bounds the gain of a wave */
} splat_model;

/* Places of its sums, behind those of the quadratic. */
#define MODEL_SLOPE QUADRATIC_SUMS
#define MODEL_SQUARE (MODEL_SLOPE + MODEL_PARAMS)
#define MODEL_MIXED (MODEL_SQUARE + MODEL_PARAMS * (MODEL_PARAMS + 1) / 2)
#define MODEL_ERROR (MODEL_MIXED + MODEL_PARAMS * CHANNELS)
#define MODEL_SUMS (MODEL_ERROR + 1) /* at most 2 SUMS_AT_ONCE */

/* Adds pixels to the slopes and squares.  `base`: the derivatives' common factor; `colour`: those of the channels by the
 * weight. */
ALWAYS_INLINE void model_add(item_sum *sums, const rdo_pixels *x, pix u, pix v, pix base, const pix *colour) {
    pix slope = (pix)(0.0f), square = (pix)(0.0f), error = (pix)(0.0f);
    pix basis[MODEL_PARAMS] = {base * u, base * v, base * u * u, base * v * v, base * u * v};
    UNROLL
    for (int k = 0; k < CHANNELS; k++) {
        slope = fma(x->error[k], colour[k], slope);
        square = fma(colour[k], colour[k], square);
        if (k < COLOURS) error += x->error[k];
    }
    slope *= x->weight;
    square *= x->weight;
    sums[MODEL_ERROR] = ADD_PRODUCTS(x->weight * error, error, sums[MODEL_ERROR]);
    if (WEIGHTED == GSCL_WEIGHTED_LUMA) {
        pix luma = (pix)(0.0f);
        UNROLL
        for (int k = 0; k < COLOURS; k++) luma = fma((pix)(luma_share(k)), colour[k], luma);
        slope = fma(x->luma_weight * x->luma_error, luma, slope);
        square = fma(x->luma_weight * luma, luma, square);
    }
    int at = MODEL_SQUARE;
    UNROLL
    for (int i = 0; i < MODEL_PARAMS; i++) {
        sums[MODEL_SLOPE + i] = ADD_PRODUCTS(slope, basis[i], sums[MODEL_SLOPE + i]);
        UNROLL
        for (int j = 0; j <= i; j++, at++) sums[at] = ADD_PRODUCTS(square * basis[i], basis[j], sums[at]);
    }
    at = MODEL_MIXED;
    UNROLL
    for (int k = 0; k < CHANNELS; k++) {
        pix mixed = x->weight * x->share * colour[k];
        UNROLL
        for (int i = 0; i < MODEL_PARAMS; i++, at++) sums[at] = ADD_PRODUCTS(mixed, basis[i], sums[at]);
    }
}

/* Adds the pixels of a vector to all sums, for a splat that is in the rendering.  Groups of many work-items remove it there, where
 * all pixels are loaded: they evaluate moves in any case. */
ALWAYS_INLINE void model_add_pixels(item_sum *sums, const projected_splat *a, const rdo_planes *p, size_t at, pix dx,
                                    float dy, int lanes) {
    const float *d = a->projected;
    pix u = fma(dx, (pix)(d[GSCL_PROJECTED_UX]), (pix)(dy * d[GSCL_PROJECTED_UY]));
    pix v = fma(dx, (pix)(d[GSCL_PROJECTED_VX]), (pix)(dy * d[GSCL_PROJECTED_VY]));
    pix gauss = pix_exp2(fma(-u, u, -v * v)), wave = (pix)(0.0f);
    pix weight = WITH_OPACITY(fmax(gauss - GSCL_WEIGHT_FLOOR, (pix)(0.0f)), d) * pix_inside(lanes);
    pix base = select((pix)(0.0f), WITH_OPACITY(2.0f * M_LN2_F * gauss, d), PIX_MASK(weight > (pix)(0.0f)));
    pix colour[CHANNELS], without[CHANNELS], residual[CHANNELS];
    rdo_pixels x;
    pixels_load(&x, p, at, lanes);
    if (has_wave(a)) wave = projected_wave(dx, dy, a);
    pix removed = weight;
    x.share = weight;
    if (BLEND == GSCL_NORMALIZED) {
        pix sum = RDO_LOAD_WEIGHTS(p->weights + at, lanes);
        removed = weight / (sum - weight);
        if (RDO_ITEMS > 1) pix_store_clipped(sum - weight, p->weights + at, lanes);
        x.share = weight / sum;
        base /= sum;
    }
    UNROLL
    for (int k = 0; k < CHANNELS; k++) {
        pix own = (pix)(d[GSCL_PROJECTED_COLOUR + k]);
        colour[k] = k < COLOURS ? own + wave : own;
        if (BLEND == GSCL_NORMALIZED) colour[k] -= x.rendering[k];
        without[k] = fma(-removed, colour[k], x.error[k]);
        residual[k] = fma(-x.share, own, x.error[k]);
        if (RDO_ITEMS > 1)
            pix_store_clipped(fma(-removed, colour[k], x.rendering[k]), p->rendering + k * p->plane + at, lanes);
    }
    quadratic_add(sums, &x, without, residual);
    if (WEIGHTED == GSCL_WEIGHTED_LUMA) quadratic_add_luma(sums, &x, luma_with(&x, without), luma_with(&x, residual));
    model_add(sums, &x, u, v, base, colour);
}

ITEMS_INLINE void model_of_totals(splat_model *m, const projected_splat *a, const float *totals) {
    float colour[QUADRATIC_SUMS];
    ITEMS_UNROLL
    for (int k = 0; k < QUADRATIC_SUMS; k++) colour[k] = totals[k];
    quadratic_of_sums(&m->colour, colour);
    m->error2 = totals[MODEL_ERROR];
    int at = MODEL_SQUARE;
    ITEMS_UNROLL
    for (int i = 0; i < MODEL_PARAMS; i++) {
        m->slope[i] = totals[MODEL_SLOPE + i];
        ITEMS_UNROLL
        for (int j = 0; j < MODEL_PARAMS; j++)
            if (j <= i) m->square[i][j] = m->square[j][i] = totals[at++];
    }
    at = MODEL_MIXED;
    ITEMS_UNROLL
    for (int k = 0; k < CHANNELS; k++) {
        m->colour_slope[k] = fma(m->colour.square, a->projected[GSCL_PROJECTED_COLOUR + k], m->colour.linear[k]);
        ITEMS_UNROLL
        for (int i = 0; i < MODEL_PARAMS; i++) m->mixed[i][k] = totals[at++];
    }
}

/* The model of a splat that is in the rendering, which groups of many work-items remove from it. */
ITEMS_INLINE void model_of(splat_model *m, const projected_splat *a, const rdo_planes *p, __local float *shared) {
    outline o = outline_of(a, p->width, p->height);
    item_sum sums[MODEL_SUMS];
    float totals[MODEL_SUMS];
    UNROLL
    for (int k = 0; k < MODEL_SUMS; k++) sums[k] = (item_sum)(0.0f);
    FOR_ROWS(RDO_ITEMS, y, o.rows.x, o.rows.y) {
        int2 columns = outline_columns(&o, y);
        FOR_VECTORS(x, columns.x, columns.y)
        model_add_pixels(sums, a, p, (size_t)y * p->width + x, pix_offsets() + ((float)x + 0.5f - o.x),
                         (float)y + 0.5f - o.y, columns.y - x + 1);
    }
    ITEMS_SUM(sums, MODEL_SUMS, RDO_ITEMS, totals, shared);
    model_of_totals(m, a, totals);
}

/* The predicted change of the error by a change of place and shape, with the best colours before and after. */
ITEMS_INLINE float model_change(const splat_model *m, const float *change) {
    float sum = 0.0f, inverse = 1.0f / fmax(m->colour.square, 1e-20f);
    ITEMS_UNROLL
    for (int i = 0; i < MODEL_PARAMS; i++) {
        float slope = 2.0f * m->slope[i];
        ITEMS_UNROLL
        for (int j = 0; j < MODEL_PARAMS; j++) slope = fma(m->square[i][j], change[j], slope);
        sum = fma(slope, change[i], sum);
    }
    ITEMS_UNROLL
    for (int k = 0; k < CHANNELS; k++) {
        float shift = 0.0f;
        ITEMS_UNROLL
        for (int i = 0; i < MODEL_PARAMS; i++) shift = fma(m->mixed[i][k], change[i], shift);
        sum -= shift * (2.0f * m->colour_slope[k] + shift) * inverse;
    }
    return sum;
}

/* The change from one place and shape, which has this projection, to another, as the model takes it. */
ITEMS_INLINE void geometry_change(const splat_geometry *from, const splat_geometry *to, const projected_splat *a,
                                  gscl_view view, float *change) {
    const float *d = a->projected;
    float dx = (to->x - from->x) * view.inv_scale, dy = (to->y - from->y) * view.inv_scale;
    float turn = to->theta - from->theta, s1 = exp(from->major), s2 = exp(from->minor);
    float e1 = s1 * s1 + view.blur, e2 = s2 * s2 + view.blur, ratio = sqrt(e1 / e2);
    turn -= M_PI_F * rint(turn / M_PI_F);
    change[0] = fma(dx, d[GSCL_PROJECTED_UX], dy * d[GSCL_PROJECTED_UY]);
    change[1] = fma(dx, d[GSCL_PROJECTED_VX], dy * d[GSCL_PROJECTED_VY]);
    change[2] = (to->major - from->major) * s1 * s1 / e1;
    change[3] = (to->minor - from->minor) * s2 * s2 / e2;
    change[4] = turn * (ratio - 1.0f / ratio);
}
