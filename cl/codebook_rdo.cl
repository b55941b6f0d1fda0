/* Rate-distortion optimisation of colour words and positions, with alpha blending.
 *
 * Splats are optimised from the front to the back.  F is the light of the splats in front of the current one, T their
 * transmittance and P the rendering of all splats.  Without the current splat (alpha a, colour c) the splats behind it
 * contribute U = (P - F - T a c) / (1 - a).  With another alpha and colour the pixel is F + U + a (T c - U), so the
 * squared error is quadratic in c and in the opacity, and sums over one outline give the error of every colour word.
 * The splats of one batch do not overlap, and every splat in front of them is in an earlier batch
 * (host/lib/codebook/codebook_rdo.c). */

/* Squared error of a word (colour c, opacity o), relative to no splat:
 * 2 o (dot(light, c) - behind) + o^2 (square dot(c, c) - 2 dot(mixed, c) + behind_square). */
typedef struct {
    float light[CHANNELS], behind, square, mixed[CHANNELS], behind_square;
} word_error;

/* Places of its sums. */
#define WORD_BEHIND 0
#define WORD_SQUARE 1
#define WORD_BEHIND_SQUARE 2
#define WORD_LIGHT 3
#define WORD_MIXED (WORD_LIGHT + CHANNELS)
#define WORD_SUMS (WORD_MIXED + CHANNELS)

/* The splat's alpha at a row of pixels from (x, y) on. */
pix word_alpha(const projected_splat *s, int x, int y) {
    pix dx = pix_offsets() + ((float)x + 0.5f - s->projected[GSCL_PROJECTED_X]);
    float dy = (float)y + 0.5f - s->projected[GSCL_PROJECTED_Y];
    return fmin(s->projected[GSCL_PROJECTED_OPACITY] * projected_weight(dx, dy, s), (pix)(GSCL_MAX_ALPHA));
}

/* Removes a splat from the rendering within its box: P becomes U. */
void word_rdo_remove(const projected_splat *s, int4 box, __global float *restrict rendering,
                     __global const float *restrict front, __global const float *restrict transmittance,
                     gscl_image_shape image) {
    const size_t plane = plane_size(image);
    FOR_ROWS(RDO_ITEMS, y, box.z, box.w)
    FOR_VECTORS(x, box.x, box.y) {
        size_t at = (size_t)y * image.width + x;
        int lanes = box.y - x + 1;
        pix alpha = word_alpha(s, x, y);
        pix own = alpha * RDO_LOAD(transmittance + at, lanes), inverse = 1.0f / (1.0f - alpha);
        UNROLL
        for (int k = 0; k < CHANNELS; k++) {
            pix u = RDO_LOAD(rendering + k * plane + at, lanes) - RDO_LOAD(front + k * plane + at, lanes) -
                    own * s->projected[GSCL_PROJECTED_COLOUR + k];
            pix_store_clipped(u * inverse, rendering + k * plane + at, lanes);
        }
    }
}

/* Adds a splat within its box: U becomes P, and F and T include the splat. */
void word_rdo_commit(const projected_splat *s, int4 box, __global float *restrict rendering,
                     __global float *restrict front, __global float *restrict transmittance, gscl_image_shape image) {
    const size_t plane = plane_size(image);
    FOR_ROWS(RDO_ITEMS, y, box.z, box.w)
    FOR_VECTORS(x, box.x, box.y) {
        size_t at = (size_t)y * image.width + x;
        int lanes = box.y - x + 1;
        pix alpha = word_alpha(s, x, y);
        pix t = RDO_LOAD(transmittance + at, lanes), own = t * alpha;
        UNROLL
        for (int k = 0; k < CHANNELS; k++) {
            pix u = RDO_LOAD(rendering + k * plane + at, lanes), f = RDO_LOAD(front + k * plane + at, lanes);
            pix light = own * s->projected[GSCL_PROJECTED_COLOUR + k];
            pix_store_clipped(f + light + u * (1.0f - alpha), rendering + k * plane + at, lanes);
            pix_store_clipped(f + light, front + k * plane + at, lanes);
        }
        pix_store_clipped(t - own, transmittance + at, lanes);
    }
}

/* The error of all colour words for one shape and position; P holds U. */
word_error word_rdo_evaluate(const projected_splat *s, __global const float *restrict rendering,
                             __global const float *restrict front, __global const float *restrict transmittance,
                             __global const float *restrict target, gscl_image_shape image, __local float *shared) {
    const size_t plane = plane_size(image);
    outline o = outline_of(s, image.width, image.height);
    item_sum sums[WORD_SUMS];
    float totals[WORD_SUMS];
    UNROLL
    for (int k = 0; k < WORD_SUMS; k++) sums[k] = (item_sum)(0.0f);
    FOR_ROWS(RDO_ITEMS, y, o.rows.x, o.rows.y) {
        int2 columns = outline_columns(&o, y);
        FOR_VECTORS(x, columns.x, columns.y) {
            size_t at = (size_t)y * image.width + x;
            int lanes = columns.y - x + 1;
            pix g =
                projected_weight(pix_offsets() + ((float)x + 0.5f - o.x), (float)y + 0.5f - o.y, s) * pix_inside(lanes);
            pix gt = g * RDO_LOAD(transmittance + at, lanes);
            sums[WORD_SQUARE] = ADD_PRODUCTS(gt, gt, sums[WORD_SQUARE]);
            UNROLL
            for (int k = 0; k < CHANNELS; k++) {
                pix u = RDO_LOAD(rendering + k * plane + at, lanes), gu = g * u;
                pix e = RDO_LOAD(front + k * plane + at, lanes) + u - PIX_LOAD(target + k * plane + at);
                sums[WORD_LIGHT + k] = ADD_PRODUCTS(gt, e, sums[WORD_LIGHT + k]);
                sums[WORD_BEHIND] = ADD_PRODUCTS(gu, e, sums[WORD_BEHIND]);
                sums[WORD_MIXED + k] = ADD_PRODUCTS(gt, gu, sums[WORD_MIXED + k]);
                sums[WORD_BEHIND_SQUARE] = ADD_PRODUCTS(gu, gu, sums[WORD_BEHIND_SQUARE]);
            }
        }
    }
    ITEMS_SUM(sums, WORD_SUMS, RDO_ITEMS, totals, shared);
    word_error w;
    w.behind = totals[WORD_BEHIND];
    w.square = totals[WORD_SQUARE];
    w.behind_square = totals[WORD_BEHIND_SQUARE];
    for (int k = 0; k < CHANNELS; k++) {
        w.light[k] = totals[WORD_LIGHT + k];
        w.mixed[k] = totals[WORD_MIXED + k];
    }
    return w;
}

/* Finds the colour word of least cost and returns its cost.  The work-items divide the words among themselves. */
float word_rdo_best_colour(const word_error *w, __global const float *restrict colours,
                           __global const float *restrict bits, int count, float lambda, int *word,
                           __local float *shared) {
    float best = MAXFLOAT;
    for (int i = RDO_ITEM; i < count; i += RDO_ITEMS) {
        __global const float *c = colours + i * GSCL_BOOK_DIMS;
        float o = logistic(c[CHANNELS]), first = -w->behind, second = w->behind_square;
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
    return items_least(best, word, shared);
}

projected_splat word_project(int2 cell, __global const float *restrict shape, __global const float *restrict colour,
                             const gscl_word_rdo_settings *settings) {
    splat s;
    s.x = ((float)cell.x + 0.5f) * settings->cell_x;
    s.y = ((float)cell.y + 0.5f) * settings->cell_y;
    splat_set_axes(&s, shape[0], shape[1]);
    s.theta = shape[2];
    s.opacity = logistic(colour[CHANNELS]);
    for (int k = 0; k < CHANNELS; k++) s.colour[k] = colour[k];
    return splat_project(s, settings->view);
}

/* Move 0 stays in the cell, 1 to 4 go to a neighbouring cell. */
#define WORD_RDO_MOVES 5
int2 word_rdo_move(int2 cell, int move) {
    return cell + (int2)(move == 1 ? 1 : move == 2 ? -1 : 0, move == 3 ? 1 : move == 4 ? -1 : 0);
}

/* Optimises cell and colour word of each splat of a batch, each with a work-group of RDO_ITEMS work-items, which all meet
 * at the same barriers.  The shape stays, since another shape would change the drawing order.  A splat that is not worth
 * its bits is dropped: its shape becomes -1.  `boxes`: first and last column, first and last row of the pixels that may
 * change for each splat. */
__kernel GROUP_OF(RDO_ITEMS) void word_rdo(
    __global const int *restrict batch, __global int2 *restrict cells, __global int2 *restrict indices,
    __global const int4 *restrict boxes, __global const float *restrict shapes, __global const float *restrict colours,
    __global const float *restrict shape_bits, __global const float *restrict colour_bits,
    __global float *restrict rendering, __global float *restrict front, __global float *restrict transmittance,
    __global const float *restrict target, gscl_word_rdo_settings settings) {
    __local float shared[SUMS_SHARED];
    const int i = batch[get_group_id(0)];
    const int4 box = boxes[i];
    const int2 cell = cells[i], index = indices[i];
    __global const float *shape = shapes + index.x * GSCL_BOOK_DIMS;
    int2 best_cell = cell, best_index = (int2)(-1, 0);
    projected_splat s = word_project(cell, shape, colours + index.y * GSCL_BOOK_DIMS, &settings);
    word_rdo_remove(&s, box, rendering, front, transmittance, settings.image);
    RDO_SYNCHRONISE(); /* all pixels are without the splat */
    float best = settings.cost_of_dropping;
    const float fixed_cost = settings.lambda * (shape_bits[index.x] + settings.position_bits);
    for (int move = 0; move < WORD_RDO_MOVES; move++) {
        int2 at = word_rdo_move(cell, move);
        int colour = 0;
        bool is_inside = at.x >= 0 && at.y >= 0 && at.x <= settings.last_x && at.y <= settings.last_y;
        if (RDO_ITEMS == 1 && !is_inside) continue;
        s = word_project(at, shape, colours, &settings);
        word_error w = word_rdo_evaluate(&s, rendering, front, transmittance, target, settings.image, shared);
        float cost =
            word_rdo_best_colour(&w, colours, colour_bits, settings.colours, settings.lambda, &colour, shared) +
            fixed_cost;
        if (is_inside && cost < best) {
            best = cost;
            best_cell = at;
            best_index = (int2)(index.x, colour);
        }
    }
    RDO_SYNCHRONISE(); /* all have read the planes and the codes */
    if (RDO_ITEM == 0) {
        indices[i] = best_index;
        cells[i] = best_cell;
    }
    s = word_project(best_cell, shape, colours + best_index.y * GSCL_BOOK_DIMS, &settings);
    if (best_index.x < 0) s.projected[GSCL_PROJECTED_OPACITY] = 0.0f;
    word_rdo_commit(&s, box, rendering, front, transmittance, settings.image);
}
