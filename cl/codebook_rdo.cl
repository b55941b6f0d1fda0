/* Choosing colour words and positions by rate and distortion, under alpha blending.
 *
 * Splats are visited from the front to the back.  F is the light of those already visited, T their
 * transmittance, P the whole picture.  With the visited splat (alpha a, colour c) out, what lies behind it sends
 * U = (P - F - T a c) / (1 - a) through; with another alpha and colour in its place the pixel is
 * F + U + a (T c - U), so the error is quadratic in c and in the opacity, and one walk over the outline
 * prices all colour words.  Splats visited together do not touch each other's pixels, and each is visited
 * after those in front of it (host/lib/codebook_choose.c). */

/* Error of a word (colour c, opacity o), relative to no splat:
 * 2 o (dot(light, c) - behind) + o^2 (square dot(c, c) - 2 dot(mixed, c) + through). */
typedef struct {
    float light[CHANNELS], behind, square, mixed[CHANNELS], through;
} word_error;

/* Takes a splat out within its box: afterwards P holds U.  */
inline void take_out(const projected_splat *a, int4 box, __global float *restrict picture,
                     __global const float *restrict front, __global const float *restrict through, int width,
                     ulong plane) {
    for (int y = box.z; y <= box.w; y++)
        for (int x = box.x; x <= box.y; x += LANES) {
            size_t at = (size_t)y * width + x;
            pix alpha = fmin(a->projected[GSCL_PROJECTED_OPACITY] *
                                 projected_weight(pix_offsets() + ((float)x + 0.5f - a->projected[GSCL_PROJECTED_X]),
                                                  (float)y + 0.5f - a->projected[GSCL_PROJECTED_Y], a),
                             (pix)(GSCL_MAX_ALPHA));
            pix own = alpha * PIX_LOAD(through + at), inverse = 1.0f / (1.0f - alpha);
            UNROLL
            for (int k = 0; k < CHANNELS; k++) {
                pix u = PIX_LOAD(picture + k * plane + at) - PIX_LOAD(front + k * plane + at) -
                        own * a->projected[GSCL_PROJECTED_COLOUR + k];
                pix_store_clipped(u * inverse, picture + k * plane + at, box.y - x + 1);
            }
        }
}

/* Puts a splat in: P, F and T are what they are after this visit. */
inline void put_in(const projected_splat *a, int4 box, __global float *restrict picture, __global float *restrict front,
                   __global float *restrict through, int width, ulong plane) {
    for (int y = box.z; y <= box.w; y++)
        for (int x = box.x; x <= box.y; x += LANES) {
            size_t at = (size_t)y * width + x;
            int lanes = box.y - x + 1;
            pix alpha = fmin(a->projected[GSCL_PROJECTED_OPACITY] *
                                 projected_weight(pix_offsets() + ((float)x + 0.5f - a->projected[GSCL_PROJECTED_X]),
                                                  (float)y + 0.5f - a->projected[GSCL_PROJECTED_Y], a),
                             (pix)(GSCL_MAX_ALPHA));
            pix t = PIX_LOAD(through + at), own = t * alpha;
            UNROLL
            for (int k = 0; k < CHANNELS; k++) {
                pix u = PIX_LOAD(picture + k * plane + at), f = PIX_LOAD(front + k * plane + at);
                pix light = own * a->projected[GSCL_PROJECTED_COLOUR + k];
                pix_store_clipped(f + light + u * (1.0f - alpha), picture + k * plane + at, lanes);
                pix_store_clipped(f + light, front + k * plane + at, lanes);
            }
            pix_store_clipped(t - own, through + at, lanes);
        }
}

/* The error of all colour words for one shape and position. */
inline word_error walk(const projected_splat *a, __global const float *restrict picture,
                       __global const float *restrict front, __global const float *restrict through,
                       __global const float *restrict target, int width, int height, ulong plane) {
    outline o = outline_of(a, width, height);
    pix light[CHANNELS], mixed[CHANNELS], behind = (pix)(0.0f), square = (pix)(0.0f), passed = (pix)(0.0f);
    for (int k = 0; k < CHANNELS; k++) light[k] = mixed[k] = (pix)(0.0f);
    for (int y = o.rows.x; y <= o.rows.y; y++) {
        int2 columns = outline_columns(&o, y);
        for (int x = columns.x; x <= columns.y; x += LANES) {
            size_t at = (size_t)y * width + x;
            pix g = projected_weight(pix_offsets() + ((float)x + 0.5f - o.x), (float)y + 0.5f - o.y, a) *
                    pix_inside(columns.y - x + 1);
            pix gt = g * PIX_LOAD(through + at);
            square = fma(gt, gt, square);
            UNROLL
            for (int k = 0; k < CHANNELS; k++) {
                pix u = PIX_LOAD(picture + k * plane + at);
                pix e = PIX_LOAD(front + k * plane + at) + u - PIX_LOAD(target + k * plane + at), gu = g * u;
                light[k] = fma(gt, e, light[k]);
                behind = fma(gu, e, behind);
                mixed[k] = fma(gt, gu, mixed[k]);
                passed = fma(gu, gu, passed);
            }
        }
    }
    word_error w;
    w.behind = pix_sum(behind);
    w.square = pix_sum(square);
    w.through = pix_sum(passed);
    for (int k = 0; k < CHANNELS; k++) {
        w.light[k] = pix_sum(light[k]);
        w.mixed[k] = pix_sum(mixed[k]);
    }
    return w;
}

/* The cheapest colour word; returns its cost. */
inline float best_colour(const word_error *w, __global const float *restrict colours,
                         __global const float *restrict bits, int count, float lambda, int *word) {
    float best = MAXFLOAT;
    for (int i = 0; i < count; i++) {
        __global const float *c = colours + i * GSCL_BOOK_DIMS;
        float o = logistic(c[CHANNELS]), first = -w->behind, second = w->through;
        for (int k = 0; k < CHANNELS; k++) {
            first = fma(w->light[k], c[k], first);
            second += c[k] * (w->square * c[k] - 2.0f * w->mixed[k]);
        }
        float cost = o * (2.0f * first + o * second) + lambda * bits[i];
        if (cost < best) {
            best = cost;
            *word = i;
        }
    }
    return best;
}

inline projected_splat word_project(int2 cell, __global const float *restrict shape,
                                    __global const float *restrict colour, gscl_word_rdo_settings t, gscl_view view) {
    splat s;
    s.x = ((float)cell.x + 0.5f) * t.cell_x;
    s.y = ((float)cell.y + 0.5f) * t.cell_y;
    splat_set_axes(&s, shape[0], shape[1]);
    s.theta = shape[2];
    s.opacity = logistic(colour[CHANNELS]);
    for (int k = 0; k < CHANNELS; k++) s.colour[k] = colour[k];
    return splat_project(s, view);
}

/* One visit each of the splats `visits[0..count)`: cells and indices change, a splat that is not worth its bits gets
 * shape -1.  `boxes`: pixels (x0, x1, y0, y1) of each visit. */
__kernel void choose_visit(__global const int *restrict visits, int count, __global int2 *restrict cells,
                           __global int2 *restrict indices, __global const int4 *restrict boxes,
                           __global const float *restrict shapes, __global const float *restrict colours,
                           __global const float *restrict shape_bits, __global const float *restrict colour_bits,
                           gscl_word_rdo_settings t, gscl_view view, __global float *restrict picture,
                           __global float *restrict front, __global float *restrict through,
                           __global const float *restrict target, int width, int height, ulong plane) {
    if ((int)get_global_id(0) >= count) return;
    int i = visits[get_global_id(0)];
    int2 cell = cells[i], index = indices[i], best_cell = cell, best_index = (int2)(-1, 0);
    projected_splat a =
        word_project(cell, shapes + index.x * GSCL_BOOK_DIMS, colours + index.y * GSCL_BOOK_DIMS, t, view);
    take_out(&a, boxes[i], picture, front, through, width, plane);
    float best = t.leave_out, fixed_cost = t.lambda * (shape_bits[index.x] + t.existence);
    for (int n = 0; n < 5; n++) { /* here, and one cell to each side; another shape would change the drawing order */
        int2 at = cell + (int2)(n == 1 ? 1 : n == 2 ? -1 : 0, n == 3 ? 1 : n == 4 ? -1 : 0);
        int colour = 0;
        if (at.x < 0 || at.y < 0 || at.x > t.last_x || at.y > t.last_y) continue;
        a = word_project(at, shapes + index.x * GSCL_BOOK_DIMS, colours, t, view);
        word_error w = walk(&a, picture, front, through, target, width, height, plane);
        float cost = best_colour(&w, colours, colour_bits, t.colours, t.lambda, &colour) + fixed_cost;
        if (cost < best) {
            best = cost;
            best_cell = at;
            best_index = (int2)(index.x, colour);
        }
    }
    indices[i] = best_index;
    cells[i] = best_cell;
    a = word_project(best_cell, shapes + max(best_index.x, 0) * GSCL_BOOK_DIMS, colours + best_index.y * GSCL_BOOK_DIMS,
                     t, view);
    if (best_index.x < 0) a.projected[GSCL_PROJECTED_OPACITY] = 0.0f;
    put_in(&a, boxes[i], picture, front, through, width, plane);
}
