/* Walking over the pixels inside one splat's outline: what the passes that try other codes do. */

/* Rows of the image that an outline touches, and its columns in a row. */
typedef struct {
    float x, y, half_height, slope, width2, curve;
} outline;

inline outline outline_of(const appearance *a) {
    outline o;
    o.x = a->drawn[GSCL_DRAWN_X];
    o.y = a->drawn[GSCL_DRAWN_Y];
    o.half_height = a->extent[GSCL_EXTENT_HALF_HEIGHT];
    o.slope = a->extent[GSCL_EXTENT_SLOPE_X];
    o.width2 = a->extent[GSCL_EXTENT_WIDTH2];
    o.curve = a->extent[GSCL_EXTENT_CURVE_X];
    return o;
}

/* The whole numbers from `from` to `to`, within [0, count): first and last; none where first > last.  Cutting off and
 * comparing rounds as ceil and floor do, which take a dozen instructions each. */
inline int2 whole_within(float from, float to, int count) {
    from = LESSER(LARGER(from, 0.0f), (float)count);
    to = LESSER(LARGER(to, -1.0f), (float)(count - 1));
    int first = (int)from, last = (int)to;
    return (int2)(first + ((float)first < from), last - ((float)last > to));
}

inline int2 outline_rows(outline o, int height) {
    return whole_within(o.y - o.half_height - 0.5f, o.y + o.half_height - 0.5f, height);
}

inline int2 outline_columns(outline o, int row, int width) {
    float dy = (float)row + 0.5f - o.y, arc = o.width2 - o.curve * dy * dy;
    float half_width = sqrt(LARGER(arc, 0.0f)), middle = o.x + o.slope * dy - 0.5f;
    return whole_within(middle - half_width, middle + half_width, width);
}

inline pix private_weight(pix dx, float dy, const appearance *a) {
#if ROTATION
    pix u = fma(dx, (pix)(a->drawn[GSCL_DRAWN_UX]), (pix)(dy * a->drawn[GSCL_DRAWN_UY]));
    pix v = fma(dx, (pix)(a->drawn[GSCL_DRAWN_VX]), (pix)(dy * a->drawn[GSCL_DRAWN_VY]));
#else
    pix u = dx * a->drawn[GSCL_DRAWN_UX];
    float v = dy * a->drawn[GSCL_DRAWN_VY];
#endif
    return fmax(pix_exp2(fma(-u, u, -v * v)) - GSCL_WEIGHT_FLOOR, (pix)(0.0f));
}

/* The weight with which it is blended. */
inline pix painted_weight(pix dx, float dy, const appearance *a) {
    return WITH_OPACITY(private_weight(dx, dy, a), a->drawn);
}

/* Whether the outline stays within the pixels that this visit owns. */
inline bool within(const appearance *a, int4 owned) {
    float x = a->drawn[GSCL_DRAWN_X], half_width = a->extent[GSCL_EXTENT_HALF_WIDTH];
    float y = a->drawn[GSCL_DRAWN_Y], half_height = a->extent[GSCL_EXTENT_HALF_HEIGHT];
    return x - half_width >= (float)owned.x && x + half_width <= (float)owned.y && y - half_height >= (float)owned.z &&
           y + half_height <= (float)owned.w;
}
