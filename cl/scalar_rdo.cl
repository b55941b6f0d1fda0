/* Choosing code words by rate and distortion.
 *
 * Each visit takes one splat out of the picture, looks at a handful of other codes for it and at leaving it
 * out, and puts back what costs least: squared error + lambda * bits.  The change of error is exact: the
 * picture P and (in `normalized`) the sum of weights D are kept per pixel and changed in place.  With the
 * splat out, giving it weight w and colour c changes a pixel to P + s (c - P), s = w / (D + w) (`sum`: P + w c),
 * so the error is a quadratic in c whose coefficients one walk over the outline adds up; the best colour codes
 * then cost no further walk.  Splats visited together do not touch each other's pixels (host/lib/refine.c). */

/* Error of a colour c, relative to no splat: fixed + sum_k (2 linear_k c_k + square c_k^2). */
typedef struct {
    float fixed, linear[CHANNELS], square;
} quadratic;

/* The error as a function of colour, for a splat of this geometry and wave that is not in the picture: with colour 0 it
 * leaves the residual, of which a colour adds s to each pixel. */
inline quadratic picture_weigh(const projected_splat *a, __global const float *restrict picture,
                               __global const float *restrict weights, __global const float *restrict target, int width,
                               int height, ulong plane) {
    outline o = outline_of(a, width, height);
    pix before = (pix)(0.0f), after = (pix)(0.0f), square = (pix)(0.0f), linear[CHANNELS];
    for (int k = 0; k < CHANNELS; k++) linear[k] = (pix)(0.0f);
    for (int y = o.rows.x; y <= o.rows.y; y++) {
        int2 columns = outline_columns(&o, y);
        for (int x = columns.x; x <= columns.y; x += LANES) {
            size_t at = (size_t)y * width + x;
            pix dx = pix_offsets() + ((float)x + 0.5f - o.x), wave = (pix)(0.0f);
            float dy = (float)y + 0.5f - o.y;
            pix s = blend_weight(dx, dy, a) * pix_inside(columns.y - x + 1);
            if (has_wave(a)) wave = projected_wave(dx, dy, a);
#if BLEND == GSCL_NORMALIZED
            s /= PIX_LOAD(weights + at) + s;
#endif
            pix weight = (pix)(1.0f);
#if WEIGHTED
            weight = PIX_LOAD(target + CHANNELS * plane + at);
#endif
            pix weighted = weight * s;
            square = fma(weighted, s, square);
            UNROLL
            for (int k = 0; k < CHANNELS; k++) {
                pix p = PIX_LOAD(picture + k * plane + at), error = p - PIX_LOAD(target + k * plane + at);
                pix residual = BLEND == GSCL_NORMALIZED ? fma(-s, p, error) : error;
                if (TEXTURE && k < COLOURS) residual = fma(s, wave, residual);
                linear[k] = fma(weighted, residual, linear[k]);
                before = fma(weight * error, error, before);
                after = fma(weight * residual, residual, after);
            }
        }
    }
    quadratic q;
    q.fixed = pix_sum(after - before);
    q.square = pix_sum(square);
    for (int k = 0; k < CHANNELS; k++) q.linear[k] = pix_sum(linear[k]);
    return q;
}

inline float colour_bits(const gscl_codes *c, __global const float *restrict tables) {
    float bits = tables[c->code[GSCL_CODE_LUMA] + GSCL_COLOUR_CODES / 2];
#if COLOURS == 3
    bits += tables[GSCL_COLOUR_CODES + c->code[GSCL_CODE_CO] + GSCL_COLOUR_CODES / 2];
    bits += tables[2 * GSCL_COLOUR_CODES + c->code[GSCL_CODE_CG] + GSCL_COLOUR_CODES / 2];
#endif
#if ALPHA_CHANNEL
    bits += tables[3 * GSCL_COLOUR_CODES + c->code[GSCL_CODE_ALPHA] + GSCL_COLOUR_CODES / 2];
#endif
    return bits;
}

inline float colour_cost(const quadratic *q, const gscl_codes *c, __global const float *restrict tables,
                         gscl_rdo_settings t) {
    float cost = q->fixed + t.lambda * colour_bits(c, tables), colour[CHANNELS];
    codes_colour(c, t, colour);
    for (int k = 0; k < CHANNELS; k++) cost += colour[k] * fma(q->square, colour[k], 2.0f * q->linear[k]);
    return cost;
}

/* Improves the colour codes one at a time, in steps, from where they are; returns the cost of the best. */
inline float colour_descend(const quadratic *q, gscl_codes *c, __global const float *restrict tables,
                            gscl_rdo_settings t) {
    float best = colour_cost(q, c, tables, t);
    for (int round = 0; round < 6; round++) {
        bool better = false;
        for (int k = 0; k < 4; k++) {
            if (COLOURS == 1 && (k == 1 || k == 2)) continue;
            if (!ALPHA_CHANNEL && k == 3) continue;
            for (int step = -1; step <= 1; step += 2) {
                gscl_codes other = *c;
                other.code[GSCL_CODE_LUMA + k] += step;
                if (other.code[GSCL_CODE_LUMA + k] < t.min[k] || other.code[GSCL_CODE_LUMA + k] > t.max[k]) continue;
                float cost = colour_cost(q, &other, tables, t);
                if (cost < best) {
                    best = cost;
                    *c = other;
                    better = true;
                }
            }
        }
        if (!better) break;
    }
    return best;
}

/* Neighbours: 0 is the splat itself. */
#define MOVES (GSCL_RDO_MOVES + (OPACITY ? GSCL_RDO_OPACITY_MOVES : 0))

/* Makes move `move`; false when it leaves the code's range.  When an axis changes, position and angle are
 * written anew on their new steps. */
inline bool codes_move(gscl_codes *c, int move, __global const gscl_minor_entry *minors,
                       __global const gscl_aspect_entry *aspects, gscl_rdo_settings t) {
    const int minor_step[MOVES] = {0, 1, -1, 0, 0, 1, -1};
    const int aspect_step[MOVES] = {0, 0, 0, 1, -1, -1, 1};
    if (!ANISOTROPY && aspect_step[move] != 0) return false;
    if (!ROTATION && (move == 7 || move == 8)) return false;
    if (move >= 13) {
        c->code[GSCL_CODE_OPACITY] += move == 13 ? 1 : -1;
        return OPACITY && c->code[GSCL_CODE_OPACITY] >= 0 && (float)c->code[GSCL_CODE_OPACITY] < t.opacity_levels;
    }
    __global const gscl_minor_entry *m = minors + c->code[GSCL_CODE_MINOR];
    float x = ((float)c->code[GSCL_CODE_X] + 0.5f) * m->step, y = ((float)c->code[GSCL_CODE_Y] + 0.5f) * m->step;
    int angles = aspects[c->code[GSCL_CODE_ASPECT]].angles;
    float turn = (float)c->code[GSCL_CODE_ANGLE] / (float)angles;
    c->code[GSCL_CODE_MINOR] += minor_step[move];
    c->code[GSCL_CODE_ASPECT] += aspect_step[move];
    if (c->code[GSCL_CODE_MINOR] < 0 || c->code[GSCL_CODE_ASPECT] < 0 ||
        c->code[GSCL_CODE_MINOR] + c->code[GSCL_CODE_ASPECT] > GSCL_MAX_SCALE)
        return false;
    m = minors + c->code[GSCL_CODE_MINOR];
    if (minor_step[move] != 0) {
        c->code[GSCL_CODE_X] = clamp((int)(x / m->step), 0, m->cells_x - 1);
        c->code[GSCL_CODE_Y] = clamp((int)(y / m->step), 0, m->cells_y - 1);
    }
    angles = aspects[c->code[GSCL_CODE_ASPECT]].angles;
    if (aspect_step[move] != 0) c->code[GSCL_CODE_ANGLE] = (int)rint(turn * (float)angles) % angles;
    if (move == 7 || move == 8) {
        if (angles < 2) return false;
        c->code[GSCL_CODE_ANGLE] = (c->code[GSCL_CODE_ANGLE] + (move == 7 ? 1 : angles - 1)) % angles;
    }
    if (move >= 9 && move <= 10) c->code[GSCL_CODE_X] += move == 9 ? 1 : -1;
    if (move >= 11 && move <= 12) c->code[GSCL_CODE_Y] += move == 11 ? 1 : -1;
    return c->code[GSCL_CODE_X] >= 0 && c->code[GSCL_CODE_X] < m->cells_x && c->code[GSCL_CODE_Y] >= 0 &&
           c->code[GSCL_CODE_Y] < m->cells_y;
}

/* The visits of one group: visits[start .. start + count). */

/* First the splats are taken out of the picture. */
__kernel void rdo_remove(__global const int *restrict visits, int start, int count,
                         __global const gscl_codes *restrict all, __global const gscl_minor_entry *restrict minors,
                         __global const gscl_aspect_entry *restrict aspects, gscl_rdo_settings t, gscl_view view,
                         __global float *restrict picture, __global float *restrict weights, int width, int height,
                         ulong plane) {
    int visit = (int)get_global_id(0);
    if (visit >= count) return;
    gscl_codes now = all[visits[start + visit]];
    projected_splat a = splat_project(codes_splat(&now, minors, aspects, t), view);
    picture_change(&a, -1.0f, picture, weights, width, height, plane);
}

/* Then every move of each is judged.  `owned`: pixels (x0, x1, y0, y1) that each splat's visit may change; `existence`:
 * bits that any splat costs. */
__kernel void rdo_evaluate(__global const int *restrict visits, int start, int count,
                           __global const gscl_codes *restrict all, __global const int4 *restrict owned,
                           __global const gscl_minor_entry *restrict minors,
                           __global const gscl_aspect_entry *restrict aspects, __global const float *restrict tables,
                           gscl_rdo_settings t, gscl_view view, float existence, __global const float *restrict picture,
                           __global const float *restrict weights, __global const float *restrict target, int width,
                           int height, ulong plane, __global gscl_move_outcome *restrict outcomes) {
    int visit = (int)get_global_id(0) / MOVES, move = (int)get_global_id(0) % MOVES;
    if (visit >= count) return;
    int i = visits[start + visit];
    gscl_codes now = all[i];
    gscl_move_outcome outcome = {MAXFLOAT, {0, 0, 0, 0}};
    float other_bits = wave_bits(&now, tables);
    bool possible = codes_move(&now, move, minors, aspects, t);
    if (possible) {
        projected_splat a = splat_project(codes_splat(&now, minors, aspects, t), view);
        if (move == 0 || outline_is_within(&a, owned[i])) {
            quadratic q = picture_weigh(&a, picture, weights, target, width, height, plane);
            outcome.cost = colour_descend(&q, &now, tables, t);
            if (OPACITY) other_bits += tables[GSCL_BITS_OPACITY + now.code[GSCL_CODE_OPACITY]];
            outcome.cost += t.lambda * (existence + other_bits + minors[now.code[GSCL_CODE_MINOR]].bits +
                                        aspects[now.code[GSCL_CODE_ASPECT]].bits);
            for (int k = 0; k < 4; k++) outcome.colour[k] = now.code[GSCL_CODE_LUMA + k];
        }
    }
    outcomes[(size_t)visit * MOVES + move] = outcome;
}

/* Last the best is put into the picture.  A splat that is not worth its bits gets minor code -1.  `leave_out`: what
 * leaving a splat out costs, 0 (no change of error, no bits), or more than anything. */
__kernel void rdo_commit(__global const int *restrict visits, int start, int count,
                         __global const gscl_move_outcome *restrict outcomes, __global gscl_codes *restrict all,
                         __global const gscl_minor_entry *restrict minors,
                         __global const gscl_aspect_entry *restrict aspects, __global const float *restrict tables,
                         gscl_rdo_settings t, gscl_view view, float leave_out, __global float *restrict picture,
                         __global float *restrict weights, __global const float *restrict target, int width, int height,
                         ulong plane) {
    int visit = (int)get_global_id(0), best = -1;
    if (visit >= count) return;
    int i = visits[start + visit];
    outcomes += (size_t)visit * MOVES;
    float lowest = leave_out;
    for (int move = 0; move < MOVES; move++)
        if (outcomes[move].cost < lowest) {
            lowest = outcomes[move].cost;
            best = move;
        }
    gscl_codes choice = all[i];
    if (best < 0) {
        all[i].code[GSCL_CODE_MINOR] = -1;
        return;
    }
    codes_move(&choice, best, minors, aspects, t);
    for (int k = 0; k < 4; k++) choice.code[GSCL_CODE_LUMA + k] = outcomes[best].colour[k];
#if TEXTURE
    texture_choose(&choice, minors, aspects, tables, t, view, picture, weights, target, width, height, plane);
#endif
    all[i] = choice;
    projected_splat a = splat_project(codes_splat(&choice, minors, aspects, t), view);
    picture_change(&a, 1.0f, picture, weights, width, height, plane);
}

/* Draws the picture and the sums of weights that the visits start from. */
__kernel void rdo_begin(__global const float *restrict splats, __global const uint *restrict entries,
                        __global const int2 *restrict tile_ranges, __constant float *background,
                        __global float *restrict picture, __global float *restrict weights, gscl_image_shape shape) {
    pixel_block p = pixel_block_of(shape);
    const size_t plane = plane_size(shape);
    canvas c;
    int2 range = tile_ranges[p.tile];
    canvas_begin(&c, background);
    canvas_blend(&c, pix_offsets() + ((float)p.x + 0.5f), (float)p.y + 0.5f, p.row0, splats, entries + range.x,
                 range.y - range.x, NULL);
    for (int r = 0; r < p.rows; r++)
        pix_store_clipped(c.weight_sum[r], weights + (size_t)(p.y + r) * shape.width + p.x, p.lanes);
    canvas_end(&c, background);
    for (int r = 0; r < p.rows; r++)
        for (int k = 0; k < CHANNELS; k++)
            pix_store_clipped(c.colour[k][r], picture + k * plane + (size_t)(p.y + r) * shape.width + p.x, p.lanes);
}
