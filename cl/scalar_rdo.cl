/* Choosing codes by rate and distortion.
 *
 * A pass visits each splat once.  From one pass over the splat's pixels it knows the cost of each colour, the cost of the
 * rendering without the splat, and a model of the cost of other places and shapes.  The most promising of these are
 * evaluated exactly, and the choice of least cost is committed: squared error + lambda * bits.  The change of error is
 * exact: the rendering P and (in `normalized`) the sum of weights D are kept per pixel and changed in place.  Splats that
 * are visited at once do not touch each other's pixels (host/lib/scalar/rdo_groups.h); each has a work-group. */

/* What all visits of a pass share. */
typedef struct {
    rdo_planes planes;
    gscl_rdo_settings settings;
    gscl_view view;
    float bits_per_splat, cost_of_dropping;
    __global const gscl_rdo_tables *tables;
} rdo_visit_context;

/* A splat's choice of codes, and its cost relative to no splat. */
typedef struct {
    gscl_codes codes;
    float cost;
} rdo_choice;

ITEMS_INLINE void codes_project(projected_splat *a, const gscl_codes *c, const rdo_visit_context *v) {
    *a = splat_project(codes_splat(c, v->tables, v->settings), v->view);
}

ITEMS_INLINE void codes_geometry_of(splat_geometry *g, const gscl_codes *c, const rdo_visit_context *v) {
    *g = codes_geometry(c, v->tables->majors, v->tables->aspects, v->settings);
}

/* The cost of all codes but the colour's: bits, and the price of elongation.  `error` and `gain`: the squared error under
 * the splat's weight without it, and what it removes. */
ITEMS_INLINE float shape_cost(const gscl_codes *c, const splat_geometry *g, float error, float gain,
                              const rdo_visit_context *v) {
    float price = v->settings.elongation_price * elongation(g->major - g->minor);
    return fma(price, fmax(error - gain, 0.0f), v->settings.lambda * (v->bits_per_splat + codes_bits(c, v->tables)));
}

/* Chooses the colour of a place and shape whose quadratic is known; returns the cost. */
ITEMS_INLINE float choose_colour(gscl_codes *c, const quadratic *q, const rdo_visit_context *v) {
    splat_geometry g;
    codes_geometry_of(&g, c, v);
    float bits, error = colour_descend(q, c, v->tables, v->settings, &bits), price = v->settings.lambda * bits;
    float cost = error + price;
    return cost + shape_cost(c, &g, q->error, price - cost, v);
}

/* The same for the colour of the present place and shape, which one work-item chooses for all. */
ITEMS_INLINE float choose_first_colour(gscl_codes *c, const quadratic *q, const rdo_visit_context *v,
                                       __local float *shared) {
#if RDO_ITEMS > 1
    gscl_codes chosen = *c;
    if (RDO_ITEM == 0) {
        const float cost = choose_colour(&chosen, q, v);
        codes_offer(&chosen, cost, OFFERS(shared));
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    return codes_take(c, MAXFLOAT, 1, OFFERS(shared));
#else
    return choose_colour(c, q, v);
#endif
}

/* ---- Moves ---- */

/* The predicted cost of a move from `now`, whose cost is known.  MAXFLOAT: the move is not possible. */
ITEMS_INLINE float predict_move(int move, const rdo_choice *now, const splat_geometry *from, const projected_splat *a,
                                const splat_model *m, const rdo_visit_context *v) {
    gscl_codes other = now->codes;
    if (!codes_move(&other, move, v->tables, v->settings)) return MAXFLOAT;
    if (move >= MOVE_OPACITY) return -MAXFLOAT;
    splat_geometry to;
    codes_geometry_of(&to, &other, v);
    float change[MODEL_PARAMS];
    geometry_change(from, &to, a, v->view, change);
    float bits = codes_bits(&other, v->tables) - codes_bits(&now->codes, v->tables);
    float price = elongation(to.major - to.minor) - elongation(from->major - from->minor);
    return now->cost + model_change(m, change) + v->settings.lambda * bits +
           v->settings.elongation_price * price * m->colour.error;
}

#if RDO_ITEMS > 1
/* Lists the moves that the model predicts to pay, the best first; returns their number.  The others of `moves` are 0.  Each
 * work-item predicts a move, and puts it at the place that follows from the costs of all. */
ITEMS_INLINE int promising_moves(int *moves, const rdo_choice *now, const projected_splat *a, const splat_model *m,
                                 const rdo_visit_context *v, __local float *shared) {
    __local float *costs = shared, *listed = shared + MOVES;
    const float limit = now->cost + v->settings.move_slack * v->settings.lambda;
    splat_geometry from;
    int count = 0;
    codes_geometry_of(&from, &now->codes, v);
    if (RDO_ITEM < MAX_EVALUATED_MOVES) listed[RDO_ITEM] = 0.0f;
    for (int move = 1 + RDO_ITEM; move < MOVES; move += RDO_ITEMS) {
        float cost = predict_move(move, now, &from, a, m, v);
        costs[move] = cost < limit ? cost : MAXFLOAT;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int move = 1 + RDO_ITEM; move < MOVES; move += RDO_ITEMS) {
        int place = 0;
        for (int other = 1; other < MOVES; other++)
            place += costs[other] < costs[move] || (costs[other] == costs[move] && other < move);
        if (costs[move] < MAXFLOAT && place < EVALUATED_MOVES) listed[place] = (float)move;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    UNROLL
    for (int i = 0; i < MAX_EVALUATED_MOVES; i++) {
        moves[i] = (int)listed[i];
        count += moves[i] > 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE); /* all have read them */
    return count;
}
#else
/* Lists the moves that the model predicts to pay, the best first; returns their number.  The others of `moves` are 0. */
int promising_moves(int *moves, const rdo_choice *now, const projected_splat *a, const splat_model *m,
                    const rdo_visit_context *v, __local float *shared) {
    float costs[MAX_EVALUATED_MOVES];
    const float limit = now->cost + v->settings.move_slack * v->settings.lambda;
    splat_geometry from;
    int count = 0;
    codes_geometry_of(&from, &now->codes, v);
    for (int i = 0; i < EVALUATED_MOVES; i++) moves[i] = 0;
    for (int move = 1; move < MOVES; move++) {
        float cost = predict_move(move, now, &from, a, m, v);
        if (!(cost < limit)) continue;
        int place = count < EVALUATED_MOVES ? count++ : EVALUATED_MOVES;
        for (; place > 0 && cost < costs[place - 1]; place--)
            if (place < EVALUATED_MOVES) {
                costs[place] = costs[place - 1];
                moves[place] = moves[place - 1];
            }
        if (place < EVALUATED_MOVES) {
            costs[place] = cost;
            moves[place] = move;
        }
    }
    return count;
}
#endif

/* Whether the outline stays within the pixels of the task. */
bool task_contains(gscl_rdo_task task, const projected_splat *a) {
    return outline_is_within(a, (int4)(task.x0, task.x1, task.y0, task.y1));
}

#if RDO_ITEMS > 1
/* Evaluates moves exactly, while the splat is not in the rendering, and keeps the best where it costs less.  Each team has a
 * move, of which its work-items share the pixels. */
ITEMS_INLINE void try_moves(const int *moves, int count, const gscl_codes *now, rdo_choice *best, gscl_rdo_task task,
                            const rdo_visit_context *v, __local float *shared) {
    const int team = TEAM_NUMBER(MOVE_TEAM);
    gscl_codes other = *now;
    projected_splat a;
    quadratic q;
    int move = 0;
    UNROLL
    for (int i = 0; i < MAX_EVALUATED_MOVES; i++) move = i == team ? moves[i] : move;
    codes_move(&other, move, v->tables, v->settings);
    codes_project(&a, &other, v);
    error_of_colour(&q, &a, &v->planes, shared);
    if (RDO_ITEM % MOVE_TEAM == 0) {
        const float cost = choose_colour(&other, &q, v);
        codes_offer(&other, task_contains(task, &a) ? cost : MAXFLOAT, OFFERS(shared) + team * OFFER);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    best->cost = codes_take(&best->codes, best->cost, count, OFFERS(shared));
}
#else
/* Evaluates moves exactly, while the splat is not in the rendering, and keeps the best where it costs less. */
void try_moves(const int *moves, int count, const gscl_codes *now, rdo_choice *best, gscl_rdo_task task,
               const rdo_visit_context *v, __local float *shared) {
    for (int i = 0; i < count; i++) {
        gscl_codes other = *now;
        codes_move(&other, moves[i], v->tables, v->settings);
        projected_splat a;
        quadratic q;
        codes_project(&a, &other, v);
        error_of_colour(&q, &a, &v->planes, shared);
        float cost = choose_colour(&other, &q, v);
        if (task_contains(task, &a) && cost < best->cost) {
            best->cost = cost;
            best->codes = other;
        }
    }
}
#endif

/* ---- Visits ---- */

ITEMS_INLINE bool codes_equal(const gscl_codes *a, const gscl_codes *b) {
    bool equal = true;
    ITEMS_UNROLL
    for (int k = 0; k < GSCL_CODE_COUNT; k++) equal = equal && a->code[k] == b->code[k];
    return equal;
}

/* Whether a wave may pay: it has one, or a scan is due and the error under it is worth the bits of a wave. */
ITEMS_INLINE bool wave_may_pay(const gscl_codes *c, const splat_model *m, const rdo_visit_context *v) {
    if (!TEXTURE) return false;
    float bits = v->tables->bits[GSCL_BITS_TEXTURED] - v->tables->bits[GSCL_BITS_PLAIN];
    return c->code[GSCL_CODE_AMPLITUDE] > 0 || (v->settings.scan && m->error2 > COLOURS * v->settings.lambda * bits);
}

ITEMS_INLINE bool codes_moved(const gscl_codes *a, const gscl_codes *b) {
    bool moved = false;
    ITEMS_UNROLL
    for (int k = GSCL_CODE_MAJOR; k <= GSCL_CODE_Y; k++) moved = moved || a->code[k] != b->code[k];
    return moved;
}

/* Visits a splat once; returns whether its place or shape changed.  Work-groups of many work-items go on where a single one
 * leaves, with a splat that was dropped, too, which changes nothing: PoCL fails on barriers behind several ways out. */
ITEMS_INLINE bool visit_splat(gscl_codes *codes, gscl_rdo_task task, const rdo_visit_context *v,
                              __local float *shared) {
    rdo_choice best = {*codes, 0.0f};
    int moves[MAX_EVALUATED_MOVES];
    projected_splat a;
    splat_model m;
    codes_project(&a, codes, v);
    model_of(&m, &a, &v->planes, shared);
    best.cost = choose_first_colour(&best.codes, &m.colour, v, shared);
    const int count = promising_moves(moves, &best, &a, &m, v, shared);
    const bool has_wave = wave_may_pay(codes, &m, v), may_drop = best.cost >= v->cost_of_dropping;
    if (RDO_ITEMS == 1 && count == 0 && !has_wave && !may_drop && codes_equal(&best.codes, codes)) return false;
    if (RDO_ITEMS == 1) rendering_change(&a, -1.0f, &v->planes);
    try_moves(moves, count, codes, &best, task, v, shared);
    const bool is_dropped = best.cost >= v->cost_of_dropping;
    if (RDO_ITEMS == 1 && is_dropped) {
        codes->code[GSCL_CODE_MAJOR] = -1;
        return false;
    }
#if MAX_TEXTURE
    if (has_wave) texture_choose(&best.codes, v->tables, v->settings, v->view, &v->planes, shared);
#endif
    codes_project(&a, &best.codes, v);
    rendering_change(&a, is_dropped ? 0.0f : 1.0f, &v->planes);
    const bool moved = codes_moved(&best.codes, codes);
    *codes = best.codes;
    if (is_dropped) codes->code[GSCL_CODE_MAJOR] = -1;
    return moved && !is_dropped;
}

/* Visits the splats of one group, each with a work-group of RDO_ITEMS work-items: once, and again where a splat moved, at
 * most pass.settings.visits times.  The major code of a splat that is not worth its bits becomes -1.  *error: of the
 * picture before the pass. */
__kernel GROUP_OF(RDO_ITEMS) void rdo_visit(gscl_rdo_pass pass, __global const gscl_rdo_task *restrict tasks,
                                            __global gscl_codes *restrict all,
                                            __global const gscl_rdo_tables *restrict tables,
                                            __global float *restrict rendering, __global float *restrict weights,
                                            __global const float *restrict target,
                                            __global const float *restrict error) {
    __local float shared[VISIT_SHARED];
    const gscl_rdo_task task = tasks[pass.start + (int)get_group_id(0)];
    rdo_visit_context v;
    v.planes.rendering = rendering;
    v.planes.weights = weights;
    v.planes.target = target;
    v.planes.width = pass.width;
    v.planes.height = pass.height;
    v.planes.plane = (ulong)pass.width * (ulong)pass.height;
    v.settings = pass.settings;
    v.settings.lambda *= *error;
    v.view = pass.view;
    v.bits_per_splat = pass.bits_per_splat;
    v.cost_of_dropping = pass.cost_of_dropping;
    v.tables = tables;
    gscl_codes codes = all[task.splat];
    int visits = pass.settings.visits; /* left */
    while (visits > 0) {
        const bool moved = visit_splat(&codes, task, &v, shared);
        v.settings.scan = 0;
        visits = moved ? visits - 1 : 0;
    }
    RDO_SYNCHRONISE(); /* all have read the codes */
    if (RDO_ITEM == 0) all[task.splat] = codes;
}

/* Draws the rendering and the sums of weights that a pass starts from. */
__kernel GROUP_OF(ITEMS) void rdo_begin(__global const float *restrict splats, __global const uint *restrict entries,
                                        __global const int2 *restrict tile_ranges, __constant float *background,
                                        __global float *restrict rendering, __global float *restrict weights,
                                        gscl_image_shape shape) {
    pixel_block p = pixel_block_of(get_group_id(0), shape);
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
