/* Choosing codes by rate and distortion.
 *
 * A pass changes each splat once.  It removes the splat from the rendering, evaluates a few other codes and the
 * rendering without the splat, and commits the choice of least cost: squared error + lambda * bits.  The change of
 * error is exact: the rendering P and (in `normalized`) the sum of weights D are kept per pixel and changed in place.
 * While the splat is removed, adding it with weight w and colour c changes a pixel to P + s (c - P), s = w / (D + w)
 * (`sum`: P + w c).  The error is therefore a quadratic in c, whose coefficients are summed in one pass over the
 * outline; choosing colour codes needs no further pass.  Splats that are changed at once do not touch each other's
 * pixels (host/lib/scalar/rdo_groups.h). */

/* Error of a colour c, relative to no splat: fixed + sum_k (2 linear_k c_k + square c_k^2). */
typedef struct {
    float fixed, linear[CHANNELS], square;
    float error; /* without the splat, under its weight */
#if WEIGHTED == GSCL_WEIGHTED_LUMA
    float luma_linear, luma_square; /* likewise for the luma of c */
#endif
} quadratic;

/* The error as a function of colour, for a splat of this geometry and wave that is not in the rendering.  With colour 0
 * it leaves `residual`, to which a colour c adds s c at each pixel. */
inline quadratic error_of_colour(const projected_splat *a, __global const float *restrict rendering,
                                 __global const float *restrict weights, __global const float *restrict target,
                                 int width, int height, ulong plane) {
    outline o = outline_of(a, width, height);
    pix error_sum = (pix)(0.0f), before = (pix)(0.0f), after = (pix)(0.0f), square = (pix)(0.0f), linear[CHANNELS];
    for (int k = 0; k < CHANNELS; k++) linear[k] = (pix)(0.0f);
#if WEIGHTED == GSCL_WEIGHTED_LUMA
    pix luma_square = (pix)(0.0f), luma_linear = (pix)(0.0f);
#endif
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
#if WEIGHTED == GSCL_WEIGHTED_PIXELS
            weight = PIX_LOAD(target + CHANNELS * plane + at);
#elif WEIGHTED == GSCL_WEIGHTED_LUMA
            pix luma_error = -PIX_LOAD(target + (CHANNELS + 1) * plane + at), luma_change = (pix)(0.0f);
#endif
            pix weighted = weight * s;
            square = fma(weighted, s, square);
            UNROLL
            for (int k = 0; k < CHANNELS; k++) {
                pix p = PIX_LOAD(rendering + k * plane + at), error = p - PIX_LOAD(target + k * plane + at);
                pix residual = BLEND == GSCL_NORMALIZED ? fma(-s, p, error) : error;
                if (TEXTURE && k < COLOURS) residual = fma(s, wave, residual);
                linear[k] = fma(weighted, residual, linear[k]);
                before = fma(weight * error, error, before);
                error_sum = fma(weighted * error, error, error_sum);
                after = fma(weight * residual, residual, after);
#if WEIGHTED == GSCL_WEIGHTED_LUMA
                if (k >= COLOURS) continue;
                luma_error = fma((pix)(luma_share(k)), p, luma_error);
                luma_change = fma((pix)(luma_share(k)), residual - error, luma_change);
#endif
            }
#if WEIGHTED == GSCL_WEIGHTED_LUMA
            pix luma_weight = PIX_LOAD(target + CHANNELS * plane + at);
            pix luma_after = luma_error + luma_change;
            error_sum = fma(luma_weight * s * luma_error, luma_error, error_sum);
            after = fma(luma_weight * luma_change, luma_error + luma_after, after);
            luma_linear = fma(luma_weight * s, luma_after, luma_linear);
            luma_square = fma(luma_weight * s, s, luma_square);
#endif
        }
    }
    quadratic q;
    q.fixed = pix_sum(after - before);
    q.square = pix_sum(square);
    q.error = pix_sum(error_sum);
    for (int k = 0; k < CHANNELS; k++) q.linear[k] = pix_sum(linear[k]);
#if WEIGHTED == GSCL_WEIGHTED_LUMA
    q.luma_linear = pix_sum(luma_linear);
    q.luma_square = pix_sum(luma_square);
#endif
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
#if WEIGHTED == GSCL_WEIGHTED_LUMA
    float luma = 0.0f;
    for (int k = 0; k < COLOURS; k++) luma = fma(luma_share(k), colour[k], luma);
    cost += luma * fma(q->luma_square, luma, 2.0f * q->luma_linear);
#endif
    return cost;
}

/* Improves the colour codes one at a time, step by step; returns the cost of the best.  The ranges are copied, because
 * Mesa's compiler fails on a run-time index into a struct that was passed by value. */
inline float colour_descend(const quadratic *q, gscl_codes *c, __global const float *restrict tables,
                            gscl_rdo_settings t) {
    const int min[4] = {t.min[0], t.min[1], t.min[2], t.min[3]}, max[4] = {t.max[0], t.max[1], t.max[2], t.max[3]};
    float best = colour_cost(q, c, tables, t);
    for (int round = 0; round < 6; round++) {
        bool better = false;
        for (int k = 0; k < 4; k++) {
            if (COLOURS == 1 && (k == 1 || k == 2)) continue;
            if (!ALPHA_CHANNEL && k == 3) continue;
            for (int step = -1; step <= 1; step += 2) {
                gscl_codes other = *c;
                other.code[GSCL_CODE_LUMA + k] += step;
                if (other.code[GSCL_CODE_LUMA + k] < min[k] || other.code[GSCL_CODE_LUMA + k] > max[k]) continue;
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

/* Moves to neighbouring codes.  Move 0 changes nothing but the colour. */
#define MOVES (GSCL_RDO_MOVES + (OPACITY ? GSCL_RDO_OPACITY_MOVES : 0))
/* Each of these moves is one step up; the move after it is one step down. */
#define MOVE_ANGLE 7
#define MOVE_X 9
#define MOVE_Y 11
#define MOVE_OPACITY 13

/* One step along x or y.  Across the cells of the class it goes along the major axis, else to the next part of a cell.
 * False when it leaves the image. */
inline bool centre_move(gscl_codes *c, bool along_x, int step, const splat_grid *g, float theta) {
    int *moved = &c->code[along_x ? GSCL_CODE_X : GSCL_CODE_Y];
    int *other = &c->code[along_x ? GSCL_CODE_Y : GSCL_CODE_X];
    int parts = along_x ? g->parts.y : g->parts.x, other_cells = along_x ? g->cells.y : g->cells.x;
    *moved += step;
    if (parts > 1) {
        float slope = along_x ? sin(theta) / cos(theta) : cos(theta) / sin(theta);
        *other += (int)rint((float)(step * parts) * slope);
    }
    return *moved >= 0 && *moved < (along_x ? g->cells.x : g->cells.y) && *other >= 0 && *other < other_cells;
}

/* Makes a move; false when it leaves the code's range.  When an axis changes, position and angle are quantised again
 * with their new steps. */
inline bool codes_move(gscl_codes *c, int move, __global const gscl_major_entry *majors,
                       __global const gscl_aspect_entry *aspects, gscl_rdo_settings t) {
    const int major_step[MOVES] = {0, 1, -1, 1, -1, 0, 0};
    const int aspect_step[MOVES] = {0, 0, 0, 1, -1, -1, 1};
    if (!ANISOTROPY && aspect_step[move] != 0) return false;
    if (!ROTATION && (move == MOVE_ANGLE || move == MOVE_ANGLE + 1)) return false;
    if (move >= MOVE_OPACITY) {
        c->code[GSCL_CODE_OPACITY] += move == MOVE_OPACITY ? 1 : -1;
        return OPACITY && c->code[GSCL_CODE_OPACITY] >= 0 && (float)c->code[GSCL_CODE_OPACITY] < t.opacity_levels;
    }
    splat_grid g = codes_grid(c, majors, aspects);
    if (move == MOVE_X || move == MOVE_X + 1 || move == MOVE_Y || move == MOVE_Y + 1) {
        bool along_x = move == MOVE_X || move == MOVE_X + 1;
        return centre_move(c, along_x, move == (along_x ? MOVE_X : MOVE_Y) ? 1 : -1, &g, codes_theta(c, aspects));
    }
    if (move == 0) return true;
    float2 centre = codes_centre(c, &g);
    int angles = aspects[c->code[GSCL_CODE_ASPECT]].angles;
    float turn = (float)c->code[GSCL_CODE_ANGLE] / (float)angles;
    c->code[GSCL_CODE_MAJOR] += major_step[move];
    c->code[GSCL_CODE_ASPECT] += aspect_step[move];
    if (c->code[GSCL_CODE_MAJOR] < 0 || c->code[GSCL_CODE_ASPECT] < 0 || c->code[GSCL_CODE_MAJOR] > GSCL_MAX_SCALE ||
        c->code[GSCL_CODE_ASPECT] > c->code[GSCL_CODE_MAJOR])
        return false;
    angles = aspects[c->code[GSCL_CODE_ASPECT]].angles;
    if (aspect_step[move] != 0) c->code[GSCL_CODE_ANGLE] = (int)rint(turn * (float)angles) % angles;
    if (move == MOVE_ANGLE || move == MOVE_ANGLE + 1) {
        if (angles < 2) return false;
        c->code[GSCL_CODE_ANGLE] = (c->code[GSCL_CODE_ANGLE] + (move == MOVE_ANGLE ? 1 : angles - 1)) % angles;
    }
    g = codes_grid(c, majors, aspects);
    codes_set_centre(c, centre, &g, codes_theta(c, aspects));
    return true;
}

/* What the direction adds to the bits of an angle. */
inline float codes_direction_bits(const gscl_codes *c, __global const gscl_rdo_tables *tables) {
    int aspect = c->code[GSCL_CODE_ASPECT], angles = tables->aspects[aspect].angles;
    if (!ROTATION || angles < 2) return 0.0f;
    int bin = (2 * GSCL_DIRECTIONS * c->code[GSCL_CODE_ANGLE] + angles) / (2 * angles) % GSCL_DIRECTIONS;
    return tables->direction_bits[min(aspect / 2, GSCL_DIRECTION_ROWS - 1)][bin];
}

/* Whether the outline stays within the pixels of the task. */
inline bool task_contains(gscl_rdo_task task, const projected_splat *a) {
    return outline_is_within(a, (int4)(task.x0, task.x1, task.y0, task.y1));
}

/* The part of the price of an elongated splat that is due at this shape. */
inline float elongation(splat s) {
    float ratio = fmax(s.s1, s.s2) / fmin(s.s1, s.s2);
    return clamp(0.5f * log2(ratio) - 1.0f, 0.0f, 1.0f);
}

/* First kernel for a group: removes its splats from the rendering. */
__kernel void rdo_remove(gscl_rdo_pass pass, __global const gscl_rdo_task *restrict tasks,
                         __global const gscl_codes *restrict all, __global const gscl_rdo_tables *restrict tables,
                         __global float *restrict rendering, __global float *restrict weights) {
    int task = (int)get_global_id(0);
    if (task >= pass.count) return;
    gscl_codes now = all[tasks[pass.start + task].splat];
    splat s = codes_splat(&now, tables->majors, tables->aspects, pass.settings);
    projected_splat a = splat_project(s, pass.view);
    rendering_change(&a, -1.0f, rendering, weights, pass.width, pass.height, (ulong)pass.width * (ulong)pass.height);
}

/* Second kernel for a group: evaluates one move of one splat. */
__kernel void rdo_evaluate(gscl_rdo_pass pass, __global const gscl_rdo_task *restrict tasks,
                           __global const gscl_codes *restrict all, __global const gscl_rdo_tables *restrict tables,
                           __global const float *restrict rendering, __global const float *restrict weights,
                           __global const float *restrict target, __global gscl_move_outcome *restrict outcomes) {
    int task = (int)get_global_id(0) / MOVES, move = (int)get_global_id(0) % MOVES;
    if (task >= pass.count) return;
    gscl_rdo_task own = tasks[pass.start + task];
    gscl_codes now = all[own.splat];
    gscl_move_outcome outcome = {MAXFLOAT, {0, 0, 0, 0}};
    __global const float *bits = tables->bits;
    float other_bits = wave_bits(&now, bits);
    bool possible = codes_move(&now, move, tables->majors, tables->aspects, pass.settings);
    if (possible) {
        splat s = codes_splat(&now, tables->majors, tables->aspects, pass.settings);
        projected_splat a = splat_project(s, pass.view);
        if (move == 0 || task_contains(own, &a)) {
            quadratic q = error_of_colour(&a, rendering, weights, target, pass.width, pass.height,
                                          (ulong)pass.width * (ulong)pass.height);
            outcome.cost = colour_descend(&q, &now, bits, pass.settings);
            float gain = pass.settings.lambda * colour_bits(&now, bits) - outcome.cost; /* of squared error */
            outcome.cost += pass.settings.elongation_price * elongation(s) * fmax(q.error - gain, 0.0f);
            if (OPACITY) other_bits += bits[GSCL_BITS_OPACITY + now.code[GSCL_CODE_OPACITY]];
            outcome.cost += pass.settings.lambda *
                            (pass.bits_per_splat + other_bits + tables->majors[now.code[GSCL_CODE_MAJOR]].bits +
                             tables->aspects[now.code[GSCL_CODE_ASPECT]].bits +
                             tables->shape_bits[now.code[GSCL_CODE_MAJOR]][now.code[GSCL_CODE_ASPECT]] +
                             codes_direction_bits(&now, tables));
            for (int k = 0; k < 4; k++) outcome.colour[k] = now.code[GSCL_CODE_LUMA + k];
        }
    }
    outcomes[(size_t)task * MOVES + move] = outcome;
}

/* Third kernel for a group: adds the splats with their best codes to the rendering.  The major code of a splat that is
 * not worth its bits becomes -1. */
__kernel void rdo_commit(gscl_rdo_pass pass, __global const gscl_rdo_task *restrict tasks,
                         __global gscl_codes *restrict all, __global const gscl_rdo_tables *restrict tables,
                         __global float *restrict rendering, __global float *restrict weights,
                         __global const float *restrict target, __global const gscl_move_outcome *restrict outcomes) {
    int task = (int)get_global_id(0), best = -1;
    if (task >= pass.count) return;
    int i = tasks[pass.start + task].splat;
    ulong plane = (ulong)pass.width * (ulong)pass.height;
    outcomes += (size_t)task * MOVES;
    float lowest = pass.cost_of_dropping;
    for (int move = 0; move < MOVES; move++)
        if (outcomes[move].cost < lowest) {
            lowest = outcomes[move].cost;
            best = move;
        }
    gscl_codes choice = all[i];
    if (best < 0) {
        all[i].code[GSCL_CODE_MAJOR] = -1;
        return;
    }
    codes_move(&choice, best, tables->majors, tables->aspects, pass.settings);
    for (int k = 0; k < 4; k++) choice.code[GSCL_CODE_LUMA + k] = outcomes[best].colour[k];
#if TEXTURE
    texture_choose(&choice, tables->majors, tables->aspects, tables->bits, pass.settings, pass.view, rendering, weights,
                   target, pass.width, pass.height, plane);
#endif
    all[i] = choice;
    splat s = codes_splat(&choice, tables->majors, tables->aspects, pass.settings);
    projected_splat a = splat_project(s, pass.view);
    rendering_change(&a, 1.0f, rendering, weights, pass.width, pass.height, plane);
}

/* Draws the rendering and the sums of weights that a pass starts from. */
__kernel void rdo_begin(__global const float *restrict splats, __global const uint *restrict entries,
                        __global const int2 *restrict tile_ranges, __constant float *background,
                        __global float *restrict rendering, __global float *restrict weights, gscl_image_shape shape) {
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
            pix_store_clipped(c.colour[k][r], rendering + k * plane + (size_t)(p.y + r) * shape.width + p.x, p.lanes);
}
