/* Iterating over the pixels inside one splat's outline, for rate-distortion optimisation. */

/* An outline in an image: its centre, the rows that it touches, and the columns of LANES rows at a time, which are
 * computed as fast as those of one row. */
typedef struct {
    float x, y;
    int2 rows; /* first and last; none where first > last */
    float half_height, slope, width2, curve;
    int width;
    int first[LANES], last[LANES];
} outline;

/* The first and last integer from `from` to `to`, within [0, count).  Truncation and a comparison round as ceil and
 * floor do, which take a dozen instructions each; a comparison that is true gives -1. */
void integers_within(pix from, pix to, int count, pix_mask *first, pix_mask *last) {
    from = LESSER(LARGER(from, (pix)(0.0f)), (pix)((float)count));
    to = LESSER(LARGER(to, (pix)(-1.0f)), (pix)((float)(count - 1)));
    pix_mask low = PIX_INT(from), high = PIX_INT(to);
    *first = low - PIX_MASK(PIX_FLOAT(low) < from);
    *last = high + PIX_MASK(PIX_FLOAT(high) > to);
}

outline outline_of(const projected_splat *a, int width, int height) {
    outline o;
    o.x = a->projected[GSCL_PROJECTED_X];
    o.y = a->projected[GSCL_PROJECTED_Y];
    o.half_height = a->bounds[GSCL_BOUNDS_HALF_HEIGHT];
    o.slope = a->bounds[GSCL_BOUNDS_SLOPE_X];
    o.width2 = a->bounds[GSCL_BOUNDS_WIDTH2];
    o.curve = a->bounds[GSCL_BOUNDS_CURVE_X];
    o.width = width;
    pix_mask first, last;
    integers_within((pix)(o.y - o.half_height - 0.5f), (pix)(o.y + o.half_height - 0.5f), height, &first, &last);
    o.rows = (int2)(PIX_FIRST(first), PIX_FIRST(last));
    return o;
}

/* First and last column of a row.  Must be called for the rows of this work-item in ascending order. */
int2 outline_columns(outline *o, int row) {
#if RDO_ITEMS > 1
    float dy = (float)row + 0.5f - o->y, arc = o->width2 - o->curve * dy * dy;
    float half_width = sqrt(LARGER(arc, 0.0f)), middle = o->x + o->slope * dy - 0.5f;
    pix_mask first, last;
    integers_within((pix)(middle - half_width), (pix)(middle + half_width), o->width, &first, &last);
    return (int2)(PIX_FIRST(first), PIX_FIRST(last));
#else
    int lane = (row - o->rows.x) % LANES;
    if (lane == 0) {
        pix dy = pix_offsets() + ((float)row + 0.5f - o->y), arc = o->width2 - o->curve * dy * dy;
        pix half_width = sqrt(LARGER(arc, (pix)(0.0f))), middle = o->x + o->slope * dy - 0.5f;
        pix_mask first, last;
        integers_within(middle - half_width, middle + half_width, o->width, &first, &last);
        PIX_STORE(first, o->first);
        PIX_STORE(last, o->last);
    }
    return (int2)(o->first[lane], o->last[lane]);
#endif
}

pix projected_weight(pix dx, float dy, const projected_splat *a) {
    pix u = dx * a->projected[GSCL_PROJECTED_UX], v = (pix)(dy * a->projected[GSCL_PROJECTED_VY]);
    if (ROTATION) {
        u = fma(dx, (pix)(a->projected[GSCL_PROJECTED_UX]), (pix)(dy * a->projected[GSCL_PROJECTED_UY]));
        v = fma(dx, (pix)(a->projected[GSCL_PROJECTED_VX]), v);
    }
    return fmax(pix_exp2(fma(-u, u, -v * v)) - GSCL_WEIGHT_FLOOR, (pix)(0.0f));
}

/* The weight with which a splat is blended. */
pix blend_weight(pix dx, float dy, const projected_splat *a) {
    return WITH_OPACITY(projected_weight(dx, dy, a), a->projected);
}

/* Whether the outline stays within the pixels that a splat may change. */
bool outline_is_within(const projected_splat *a, int4 owned) {
    float x = a->projected[GSCL_PROJECTED_X], half_width = a->bounds[GSCL_BOUNDS_HALF_WIDTH];
    float y = a->projected[GSCL_PROJECTED_Y], half_height = a->bounds[GSCL_BOUNDS_HALF_HEIGHT];
    return x - half_width >= (float)owned.x && x + half_width <= (float)owned.y && y - half_height >= (float)owned.z &&
           y + half_height <= (float)owned.w;
}
