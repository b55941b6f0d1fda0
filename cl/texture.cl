/* Choosing a splat's wave (the texture effect) by rate and distortion, while the splat is not in the rendering.
 *
 * A wave a cos(2 pi k.d - h) under the splat's weight s changes the error by 2 a l + a^2 q, with l and q from the
 * sums of s e cos, s e sin, s^2 cos^2, s^2 sin^2 and s^2 sin cos over the splat's pixels; e is the error of the
 * rendering with the plain splat in it, added up over the colour channels.  A scan computes the first two sums alone,
 * for all directions at once, and estimates the others from the splat's Gaussian; the best wave of the scan, the
 * present one and its neighbours are then evaluated exactly. */

#if MAX_TEXTURE
#define SCANNED_WAVES 12                  /* the first of all wavelengths */
#define VECTORS (GSCL_DIRECTIONS / LANES) /* of directions */
#define MAX_SCAN_FREQUENCY 0.45f          /* cycles per pixel of the level: finer waves would alias */
#define MAX_SCAN_WAVELENGTH 6.0f          /* in major axes */

/* The plain splat's share s of each pixel of a vector, and with it the error e; both 0 outside the outline. */
ITEMS_INLINE void share_and_error(const projected_splat *plain, const outline *o, int x, int y, int lanes,
                                  const rdo_planes *planes, pix *share, pix *error) {
    size_t at = (size_t)y * planes->width + x;
    __global const float *target = planes->target;
    const ulong plane = planes->plane;
    pix inside = pix_inside(lanes);
    pix s = blend_weight(pix_offsets() + ((float)x + 0.5f - o->x), (float)y + 0.5f - o->y, plain) * inside;
    if (BLEND == GSCL_NORMALIZED) s /= RDO_LOAD_WEIGHTS(planes->weights + at, lanes) + s;
    pix e = (pix)(0.0f), luma = (pix)(0.0f), weight = (pix)(1.0f);
    if (WEIGHTED != GSCL_WEIGHTED_NOT) weight = PIX_LOAD(target + CHANNELS * plane + at);
    if (WEIGHTED == GSCL_WEIGHTED_LUMA) luma = -PIX_LOAD(target + (CHANNELS + 1) * plane + at);
    UNROLL
    for (int k = 0; k < COLOURS; k++) {
        pix p = RDO_LOAD(planes->rendering + k * plane + at, lanes),
            c = (pix)(plain->projected[GSCL_PROJECTED_COLOUR + k]);
        pix error = fma(s, BLEND == GSCL_NORMALIZED ? c - p : c, p - PIX_LOAD(target + k * plane + at));
        e += error;
        if (WEIGHTED == GSCL_WEIGHTED_LUMA)
            luma = fma((pix)(luma_share(k)), fma(s, BLEND == GSCL_NORMALIZED ? c - p : c, p), luma);
    }
    if (WEIGHTED == GSCL_WEIGHTED_PIXELS) { /* with the root of the weight on both, sums of products are weighted */
        pix root = sqrt(weight);
        s *= root;
        e *= root;
    } else if (WEIGHTED == GSCL_WEIGHTED_LUMA) { /* likewise, for a wave that changes luma as much as each colour */
        pix root = sqrt(fma(weight, (pix)(1.0f / COLOURS), (pix)(1.0f)));
        e = fma(weight, luma, e) / root;
        s *= root;
    }
    *share = s;
    *error = e * inside;
}

typedef struct {
    float error_cos, error_sin; /* sums of s e cos, s e sin */
    float share, error2;        /* of s, s e^2 */
    float cos2, sin2, both;     /* of s^2 cos^2, ..., times the number of colour channels */
} wave_sums;

#define TRIED_WAVES 6 /* less than MAX_TEAMS */
#define WAVE_TEAM TEAM_OF(TRIED_WAVES)

/* The sums of a team's own wave. */
ITEMS_INLINE void wave_sums_of(wave_sums *w, const projected_splat *plain, float2 cycles, const rdo_planes *planes,
                               __local float *shared) {
    outline o = outline_of(plain, planes->width, planes->height);
    item_sum sums[7];
    float totals[7];
    ITEMS_UNROLL
    for (int k = 0; k < 7; k++) sums[k] = (item_sum)(0.0f);
    FOR_ROWS(WAVE_TEAM, y, o.rows.x, o.rows.y) {
        int2 columns = outline_columns(&o, y);
        FOR_VECTORS(x, columns.x, columns.y) {
            pix s, e;
            share_and_error(plain, &o, x, y, columns.y - x + 1, planes, &s, &e);
            pix turns = fma(pix_offsets() + ((float)x + 0.5f - o.x), (pix)(cycles.x),
                            (pix)(((float)y + 0.5f - o.y) * cycles.y));
            pix c = s * pix_cos_turns(turns), n = s * pix_cos_turns(turns - 0.25f);
            sums[0] = ADD_PRODUCTS(c, e, sums[0]);
            sums[1] = ADD_PRODUCTS(n, e, sums[1]);
            sums[2] = ADD_LANES(s, sums[2]);
            sums[3] = ADD_PRODUCTS(s * e, e, sums[3]);
            sums[4] = ADD_PRODUCTS(c, c, sums[4]);
            sums[5] = ADD_PRODUCTS(n, n, sums[5]);
            sums[6] = ADD_PRODUCTS(c, n, sums[6]);
        }
    }
    ITEMS_SUM(sums, 7, WAVE_TEAM, totals, shared);
    w->error_cos = totals[0];
    w->error_sin = totals[1];
    w->share = totals[2];
    w->error2 = totals[3];
    w->cos2 = COLOURS * totals[4];
    w->sin2 = COLOURS * totals[5];
    w->both = COLOURS * totals[6];
}

/* Whether the wave explains this part of the squared error under the splat's weight.  By the inequality of Cauchy and
 * Schwarz the squares of the sums are at most half of share * error2: the mean of cos^2 is 1/2. */
ITEMS_INLINE bool wave_explains(const wave_sums *w, float part) {
    return 2.0f * fma(w->error_cos, w->error_cos, w->error_sin * w->error_sin) >= part * w->share * w->error2;
}

/* Finds the phase and the amplitude with the lowest cost for a wave and direction; returns that cost. */
ITEMS_INLINE float wave_choose_codes(gscl_codes *c, const wave_sums *w, float attenuation, __global const float *tables,
                                     gscl_rdo_settings t) {
    float best = MAXFLOAT, step = t.amplitude_step * attenuation;
    int best_phase = 0, best_amplitude = 1;
    for (int phase = 0; phase < GSCL_PHASES; phase++) {
        unit_vector d = direction_of((float)phase * (2.0f * M_PI_F / GSCL_PHASES));
        float l = fma(d.x, w->error_cos, d.y * w->error_sin);
        float q = d.x * d.x * w->cos2 + 2.0f * d.x * d.y * w->both + d.y * d.y * w->sin2;
        if (!(l < 0.0f)) continue;
        float nearest = rint(-l / (fmax(q, 1e-12f) * step));
        for (int below = 0; below < 2; below++) {
            const int amplitude = (int)clamp(nearest - (float)below, 1.0f, (float)GSCL_AMPLITUDES);
            c->code[GSCL_CODE_AMPLITUDE] = amplitude;
            float a = wave_amplitude(amplitude, t) * attenuation;
            float cost = a * fma(a, q, 2.0f * l) + t.lambda * wave_bits(c, tables);
            if (cost < best) {
                best = cost;
                best_phase = phase;
                best_amplitude = amplitude;
            }
        }
    }
    c->code[GSCL_CODE_PHASE] = best_phase;
    c->code[GSCL_CODE_AMPLITUDE] = best_amplitude;
    return best;
}

/* The state of the scan for one wave and one vector of directions: rotation along a row, and sums. */
typedef struct {
    pix step_x, step_y;     /* cycles per pixel */
    pix turn_cos, turn_sin; /* rotation from one pixel to the next */
    pix error_cos, error_sin;
} scan_state;

/* A work-item has the states from its own number on, RDO_ITEMS apart, so that those of a group's fit into registers. */
#define SCAN_STATES (SCANNED_WAVES * VECTORS)
#define OWN_STATES ((SCAN_STATES + RDO_ITEMS - 1) / RDO_ITEMS)
#define STATE_NUMBER(own) ((own)*RDO_ITEMS + RDO_ITEM)
#if RDO_ITEMS > 1
#define FOR_OWN_STATES(own, count)             \
    UNROLL                                     \
    for (int own = 0; own < OWN_STATES; own++) \
        if (STATE_NUMBER(own) < (count))
#else
#define FOR_OWN_STATES(own, count) for (int own = 0; own < (count); own++)
#endif

ITEMS_INLINE void scan_begin(scan_state *states, int count, gscl_view view) {
    FOR_OWN_STATES(own, count) {
        int i = STATE_NUMBER(own);
        pix direction = (pix_offsets() + (float)(i % VECTORS * LANES)) * (0.5f / GSCL_DIRECTIONS); /* turns */
        float cycles = wave_frequency(i / VECTORS) / view.inv_scale;
        states[own].step_x = cycles * pix_cos_turns(direction);
        states[own].step_y = cycles * pix_cos_turns(direction - 0.25f);
        states[own].turn_cos = pix_cos_turns(states[own].step_x);
        states[own].turn_sin = pix_cos_turns(states[own].step_x - 0.25f);
        states[own].error_cos = states[own].error_sin = (pix)(0.0f);
    }
}

/* Adds the pixels of a vector, given as s e, to all states; `dx`, `dy`: its first pixel from the centre. */
ITEMS_INLINE void scan_add(scan_state *states, int count, pix shared_error, int lanes, float dx, float dy) {
    float products[LANES];
    PIX_STORE(shared_error, products);
    FOR_OWN_STATES(own, count) {
        scan_state *s = states + own;
        pix turns = fma((pix)(dx), s->step_x, dy * s->step_y);
        pix c = pix_cos_turns(turns), n = pix_cos_turns(turns - 0.25f);
        pix ec = s->error_cos, es = s->error_sin, tc = s->turn_cos, ts = s->turn_sin;
        for (int j = 0; j < lanes; j++) {
            pix g = (pix)(products[j]);
            ec = fma(g, c, ec);
            es = fma(g, n, es);
            pix next = fma(c, tc, -n * ts);
            n = fma(c, ts, n * tc);
            c = next;
        }
        s->error_cos = ec;
        s->error_sin = es;
    }
}

#if RDO_ITEMS > 1
/* A pixel vector in local memory: s e of each pixel, dx, dy, and whether it is the last of a work-item. */
#define SCAN_DX LANES
#define SCAN_DY (LANES + 1)
#define SCAN_IS_LAST (LANES + 2)
#define SCAN_RECORD (LANES + 3)
#define SCAN_CHUNK (ITEM_SUMS / SCAN_RECORD) /* pixel vectors that are in local memory at once */

/* The pixel vectors of this work-item. */
ITEMS_INLINE int scan_own_vectors(const projected_splat *plain, const rdo_planes *planes) {
    outline o = outline_of(plain, planes->width, planes->height);
    int count = 0;
    FOR_ROWS(RDO_ITEMS, y, o.rows.x, o.rows.y) {
        int2 columns = outline_columns(&o, y);
        FOR_VECTORS(x, columns.x, columns.y) count++;
    }
    return count;
}

/* Stores those pixel vectors of this work-item that are among the SCAN_CHUNK from number `first` on.  `start`: the number of
 * its first; `end`: of the next work-item's. */
ITEMS_INLINE void scan_store(const projected_splat *plain, const rdo_planes *planes, int first, int start, int end,
                             __local float *records) {
    outline o = outline_of(plain, planes->width, planes->height);
    int i = start - first;
    if (start >= first + SCAN_CHUNK || end <= first) return;
    FOR_ROWS(RDO_ITEMS, y, o.rows.x, o.rows.y) {
        int2 columns = outline_columns(&o, y);
        FOR_VECTORS(x, columns.x, columns.y) {
            if (i >= 0 && i < SCAN_CHUNK) {
                __local float *record = records + i * SCAN_RECORD;
                pix s, e;
                share_and_error(plain, &o, x, y, min(columns.y - x + 1, LANES), planes, &s, &e);
                PIX_STORE(s * e, record);
                record[SCAN_DX] = (float)x + 0.5f - o.x;
                record[SCAN_DY] = (float)y + 0.5f - o.y;
                record[SCAN_IS_LAST] = first + i + 1 == end ? 1.0f : 0.0f;
            }
            i++;
        }
    }
}

/* Adds all pixels of the outline to all states.  Each work-item stores its pixel vectors for those that have states; their
 * sums are sums of each work-item's vectors, as those of items_add are. */
ITEMS_INLINE void scan_outline(scan_state *states, int count, const projected_splat *plain, const rdo_planes *planes,
                               __local float *shared) {
    pix total_cos[OWN_STATES], total_sin[OWN_STATES];
    const int3 numbers = items_number(scan_own_vectors(plain, planes), shared);
    UNROLL
    for (int own = 0; own < OWN_STATES; own++) total_cos[own] = total_sin[own] = (pix)(0.0f);
    for (int first = 0; first < numbers.z; first += SCAN_CHUNK) {
        scan_store(plain, planes, first, numbers.x, numbers.y, shared);
        barrier(CLK_LOCAL_MEM_FENCE);
        for (int i = 0; i < min(numbers.z - first, SCAN_CHUNK); i++) {
            __local const float *record = shared + i * SCAN_RECORD;
            scan_add(states, count, PIX_LOAD(record), LANES, record[SCAN_DX], record[SCAN_DY]);
            if (record[SCAN_IS_LAST] == 0.0f) continue;
            UNROLL
            for (int own = 0; own < OWN_STATES; own++) {
                total_cos[own] += states[own].error_cos;
                total_sin[own] += states[own].error_sin;
                states[own].error_cos = states[own].error_sin = (pix)(0.0f);
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    UNROLL
    for (int own = 0; own < OWN_STATES; own++) {
        states[own].error_cos = total_cos[own];
        states[own].error_sin = total_sin[own];
    }
}
#else
/* Adds all pixels of the outline to all states. */
void scan_outline(scan_state *restrict states, int count, const projected_splat *plain, const rdo_planes *planes,
                  __local float *restrict shared) {
    outline o = outline_of(plain, planes->width, planes->height);
    FOR_ROWS(RDO_ITEMS, y, o.rows.x, o.rows.y) {
        int2 columns = outline_columns(&o, y);
        FOR_VECTORS(x, columns.x, columns.y) {
            pix s, e;
            int lanes = min(columns.y - x + 1, LANES);
            share_and_error(plain, &o, x, y, lanes, planes, &s, &e);
            scan_add(states, count, s * e, lanes, (float)x + 0.5f - o.x, (float)y + 0.5f - o.y);
        }
    }
}
#endif

/* The gain of each wave of a state, up to a common factor: cos^2 and sin^2 under the splat's squared weight are
 * (1 +- r) / 2, r = exp(-k' Sigma k). */
ITEMS_INLINE pix scan_score(const projected_splat *plain, const scan_state *s) {
    const float *d = plain->projected;
    float u2 = d[GSCL_PROJECTED_UX] * d[GSCL_PROJECTED_UX] + d[GSCL_PROJECTED_UY] * d[GSCL_PROJECTED_UY];
    float v2 = d[GSCL_PROJECTED_VX] * d[GSCL_PROJECTED_VX] + d[GSCL_PROJECTED_VY] * d[GSCL_PROJECTED_VY];
    pix u = fma(s->step_x, (pix)(d[GSCL_PROJECTED_UX]), s->step_y * d[GSCL_PROJECTED_UY]) / u2;
    pix v = fma(s->step_x, (pix)(d[GSCL_PROJECTED_VX]), s->step_y * d[GSCL_PROJECTED_VY]) / v2;
    /* (2 pi)^2 / (2 ln 2) converts the frame's units to sigmas, 1 / ln 2 the base e to 2. */
    pix r = pix_exp2((2.0f * M_PI_F * M_PI_F / (M_LN2_F * M_LN2_F)) * fma(-u, u, -v * v));
    return s->error_cos * s->error_cos / (1.0f + r) + s->error_sin * s->error_sin / (1.02f - r);
}

/* The wave and direction with the highest score. */
ITEMS_INLINE int2 wave_scan(const projected_splat *plain, float major, gscl_view view, const rdo_planes *planes,
                            __local float *shared) {
    scan_state states[OWN_STATES];
    int waves = 0;
    while (waves < SCANNED_WAVES && (waves == 0 || wave_frequency(waves) * MAX_SCAN_WAVELENGTH * major > 1.0f)) waves++;
    scan_begin(states, waves * VECTORS, view);
    scan_outline(states, waves * VECTORS, plain, planes, shared);
    int best = 0;
    float highest = -1.0f;
    FOR_OWN_STATES(own, waves * VECTORS) {
        float scores[LANES];
        if (wave_frequency(STATE_NUMBER(own) / VECTORS) > MAX_SCAN_FREQUENCY * view.inv_scale) continue;
        PIX_STORE(scan_score(plain, states + own), scores);
        for (int j = 0; j < LANES; j++)
            if (scores[j] > highest) {
                highest = scores[j];
                best = STATE_NUMBER(own) * LANES + j;
            }
    }
    items_least(-highest, &best, shared);
    return (int2)(best / GSCL_DIRECTIONS, best % GSCL_DIRECTIONS);
}

/* The wave and the direction to try at place i: the present ones, their neighbours, those of a scan.  No wave: (-1, 0). */
int2 tried_wave(int i, int2 present, int2 scanned) {
    int w = present.x, d = present.y;
    if (i == TRIED_WAVES - 1) return scanned;
    if (i == 1) d = (d + 1) % GSCL_DIRECTIONS;
    if (i == 2) d = (d + GSCL_DIRECTIONS - 1) % GSCL_DIRECTIONS;
    if (i == 3) w++;
    if (i == 4) w--;
    return present.x >= 0 && i < TRIED_WAVES && w < GSCL_WAVES ? (int2)(w, d) : (int2)(-1, 0);
}

/* A wave to try, and what of it does not depend on the pixels. */
typedef struct {
    gscl_codes codes;
    float2 cycles;
    float attenuation;
    bool is_tried;
} wave_candidate;

ITEMS_INLINE void wave_prepare(wave_candidate *w, const gscl_codes *now, int2 tried,
                               __global const gscl_rdo_tables *tables, gscl_rdo_settings t, gscl_view view) {
    w->codes = *now;
    w->codes.code[GSCL_CODE_WAVE] = tried.x;
    w->codes.code[GSCL_CODE_DIRECTION] = tried.y;
    w->codes.code[GSCL_CODE_AMPLITUDE] = 1;
    splat waved = codes_splat(&w->codes, tables, t);
    projected_splat projected = splat_project(waved, view);
    w->cycles = (float2)(projected.projected[GSCL_PROJECTED_WAVE_X], projected.projected[GSCL_PROJECTED_WAVE_Y]);
    w->attenuation = projected.projected[GSCL_PROJECTED_WAVE_AMPLITUDE] / waved.wave_amplitude;
    w->is_tried = tried.x >= 0 && waved.wave_amplitude > 0.0f; /* else the splat is too long for a wave */
}

/* Chooses the other codes of a wave; returns their cost, MAXFLOAT where it explains too little. */
ITEMS_INLINE float wave_cost(wave_candidate *w, const wave_sums *sums, __global const gscl_rdo_tables *tables,
                             gscl_rdo_settings t) {
    if (!wave_explains(sums, t.min_explained)) return MAXFLOAT;
    return wave_choose_codes(&w->codes, sums, w->attenuation, tables->bits, t);
}

#if RDO_ITEMS > 1
/* Keeps the wave of the lowest cost in `choice` where it is below `best`.  Each team has a wave, of which its work-items share
 * the pixels. */
ITEMS_INLINE void try_waves(gscl_codes *choice, float best, int2 present, int2 scanned, const projected_splat *plain,
                            __global const gscl_rdo_tables *tables, gscl_rdo_settings t, gscl_view view,
                            const rdo_planes *planes, __local float *shared) {
    const int team = TEAM_NUMBER(WAVE_TEAM);
    wave_candidate w;
    wave_sums sums;
    wave_prepare(&w, choice, tried_wave(team, present, scanned), tables, t, view);
    wave_sums_of(&sums, plain, w.cycles, planes, shared);
    if (RDO_ITEM % WAVE_TEAM == 0) {
        const float cost = w.is_tried ? wave_cost(&w, &sums, tables, t) : MAXFLOAT;
        codes_offer(&w.codes, cost, OFFERS(shared) + team * OFFER);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    codes_take(choice, best, TRIED_WAVES, OFFERS(shared));
}
#else
/* Keeps the wave of the lowest cost in `choice` where it is below `best`. */
void try_waves(gscl_codes *choice, float best, int2 present, int2 scanned, const projected_splat *plain,
               __global const gscl_rdo_tables *tables, gscl_rdo_settings t, gscl_view view, const rdo_planes *planes,
               __local float *shared) {
    for (int i = 0; i < TRIED_WAVES; i++) {
        int2 tried = tried_wave(i, present, scanned);
        wave_candidate w;
        if (tried.x < 0) continue;
        wave_prepare(&w, choice, tried, tables, t, view);
        if (!w.is_tried) continue;
        wave_sums sums;
        wave_sums_of(&sums, plain, w.cycles, planes, shared);
        float cost = wave_cost(&w, &sums, tables, t);
        if (cost < best) {
            best = cost;
            *choice = w.codes;
        }
    }
}
#endif

/* Chooses the wave with the lowest cost, or none, for a splat that is not in the rendering. */
ITEMS_INLINE void texture_choose(gscl_codes *c, __global const gscl_rdo_tables *tables, gscl_rdo_settings t,
                                 gscl_view view, const rdo_planes *planes, __local float *shared) {
    int2 present = (int2)(-1, 0), scanned = (int2)(-1, 0);
    if (c->code[GSCL_CODE_AMPLITUDE] > 0) present = (int2)(c->code[GSCL_CODE_WAVE], c->code[GSCL_CODE_DIRECTION]);
    ITEMS_UNROLL
    for (int k = GSCL_CODE_WAVE; k <= GSCL_CODE_AMPLITUDE; k++) c->code[k] = 0;
    splat s = codes_splat(c, tables, t);
    projected_splat plain = splat_project(s, view);
    if (t.scan) scanned = wave_scan(&plain, s.s1, view, planes, shared);
    try_waves(c, t.lambda * tables->bits[GSCL_BITS_PLAIN], present, scanned, &plain, tables, t, view, planes, shared);
}
#endif
