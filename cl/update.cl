/* From gradient slots to parameters: gradients, Adam, and the projection for the next step.
 *
 * A work-item takes SPLAT_LANES splats, or, where SLOT_ITEMS > 1, a work-group takes one. */

#if SLOT_ITEMS == 1
/* Sums the slots of splats `first` to `first + lanes_used`, SLOT floats each, row by row of tiles and so always in the
 * same order. */
void slots_sum(float *restrict sums, size_t first, int lanes_used, __global const gscl_link_grid *restrict grids,
               __global const int *restrict links, __global const float *restrict slots,
               __local float *restrict unused) {
    for (int k = 0; k < SPLAT_LANES * SLOT; k++) sums[k] = 0.0f;
    for (int lane = 0; lane < lanes_used; lane++) {
        gscl_link_grid grid = grids[first + (size_t)lane];
        for (int i = grid.first; i < grid.first + grid.count; i++) {
            if (links[i] < 0) continue;
            __global const float *slot = slots + (size_t)links[i] * SLOT;
            UNROLL
            for (int k = 0; k < SLOT; k++) sums[lane * SLOT + k] += slot[k];
        }
    }
}
#else
#define SUMMED_AT_ONCE (SLOT_ITEMS / SLOT) /* slots whose floats the work-items of a group read at once */
/* The same for one splat by all work-items of a group, each of which adds one sum of every SUMMED_AT_ONCE-th slot. */
void slots_sum(float *restrict sums, size_t first, int lanes_used, __global const gscl_link_grid *restrict grids,
               __global const int *restrict links, __global const float *restrict slots,
               __local float *restrict shared) {
    const gscl_link_grid grid = grids[first];
    int item = (int)get_local_id(0);
    float own = 0.0f;
    if (item < SUMMED_AT_ONCE * SLOT)
        for (int i = item / SLOT; i < grid.count; i += SUMMED_AT_ONCE) {
            int slot = links[grid.first + i];
            if (slot >= 0) own += slots[(size_t)slot * SLOT + (size_t)(item % SLOT)];
        }
    shared[item] = own;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int k = 0; k < SLOT; k++) {
        sums[k] = 0.0f;
        for (int j = 0; j < SUMMED_AT_ONCE; j++) sums[k] += shared[j * SLOT + k];
    }
}
#endif

/* Sum `k` of each splat. */
#define LANE_SUM(k) LOAD_LANES(sums + (k), SLOT)

/* Chain rule from the sums, which are in the splats' own frames, to the parameters.  `s`, `projected`: the splats as
 * they were drawn. */
void gradient_from_sums(vfloat *restrict gradient, const float *restrict sums, splat s,
                        __global const float *restrict projected, gscl_view view) {
    vfloat e1 = axis_at_level(s.s1, view.blur), e2 = axis_at_level(s.s2, view.blur);
    /* gauss = 2^-(u^2 + v^2): each derivative of the exponent brings a factor 2 ln 2. */
    const float factor = 2.0f * M_LN2_F;
    vfloat du = factor * LANE_SUM(GSCL_SLOT_U), dv = factor * LANE_SUM(GSCL_SLOT_V);
    gradient[GSCL_X] = view.inv_scale * fma(LOAD_LANES(projected + GSCL_PROJECTED_UX, GSCL_PROJECTED), du,
                                            LOAD_LANES(projected + GSCL_PROJECTED_VX, GSCL_PROJECTED) * dv);
    gradient[GSCL_Y] = view.inv_scale * view.row_scale *
                       fma(LOAD_LANES(projected + GSCL_PROJECTED_UY, GSCL_PROJECTED), du,
                           LOAD_LANES(projected + GSCL_PROJECTED_VY, GSCL_PROJECTED) * dv);
    if (TEXTURE) {
        /* d/dcentre of cos(2 pi (k.d - h)) = 2 pi k sin(...), and sin is cos a quarter of a turn later. */
        vfloat dwave = 2.0f * M_PI_F * LANE_SUM(SLOT_WAVE) * view.inv_scale;
        gradient[GSCL_X] = fma(LOAD_LANES(projected + GSCL_PROJECTED_WAVE_X, GSCL_PROJECTED), dwave, gradient[GSCL_X]);
        gradient[GSCL_Y] = fma(LOAD_LANES(projected + GSCL_PROJECTED_WAVE_Y, GSCL_PROJECTED), dwave * view.row_scale,
                               gradient[GSCL_Y]);
    }
    gradient[GSCL_LOG_S1] = factor * LANE_SUM(GSCL_SLOT_UU) * (s.s1 / e1) * (s.s1 / e1);
    gradient[GSCL_LOG_S2] = factor * LANE_SUM(SLOT_VV) * (s.s2 / e2) * (s.s2 / e2);
    gradient[GSCL_THETA] = ROTATION ? factor * LANE_SUM(GSCL_SLOT_UV) * (e1 / e2 - e2 / e1) : (vfloat)(0.0f);
    gradient[GSCL_OPACITY] = OPACITY ? LANE_SUM(SLOT_OPACITY) * s.opacity * (1.0f - s.opacity) : (vfloat)(0.0f);
    UNROLL
    for (int k = 0; k < CHANNELS; k++) gradient[GSCL_COLOUR + k] = LANE_SUM(SLOT_COLOUR + k);
}

/* The number of fitted parameters, and whether parameter `k` is one of them with these build options. */
#define FITTED (GSCL_COLOUR + CHANNELS)
#define IS_FITTED(k) (((k) != GSCL_THETA || ROTATION) && ((k) != GSCL_OPACITY || OPACITY))

/* Rotates (x, y) by the angle whose cosine and sine are given. */
void rotate_by(vfloat *restrict x, vfloat *restrict y, vfloat c, vfloat s) {
    vfloat rotated = c * *x - s * *y;
    *y = fma(c, *y, s * *x);
    *x = rotated;
}

/* The learning rate of each parameter.  That of the centre is in lengths of the axes.  That of the angle falls with the
 * aspect ratio, about by its power 3/4.  Both keep the effect of a step on the rendering alike for all shapes. */
void learning_rates(vfloat *restrict rates, const vfloat *restrict p) {
    vfloat s1 = exp(p[GSCL_LOG_S1]), s2 = exp(p[GSCL_LOG_S2]);
    vfloat roundness = sqrt(2.0f / (1.0f + fmax(s1, s2) / fmin(s1, s2)));
    rates[GSCL_X] = GSCL_RATE_POSITION * s1;
    rates[GSCL_Y] = GSCL_RATE_POSITION * s2;
    rates[GSCL_LOG_S1] = rates[GSCL_LOG_S2] = (vfloat)(GSCL_RATE_SHAPE);
    rates[GSCL_THETA] = GSCL_RATE_ANGLE * roundness * sqrt(roundness);
    rates[GSCL_OPACITY] = (vfloat)(GSCL_RATE_OPACITY);
    UNROLL
    for (int k = 0; k < CHANNELS; k++) rates[GSCL_COLOUR + k] = (vfloat)(GSCL_RATE_COLOUR);
}

/* Adam for one parameter of each splat: updates its moments, which are GSCL_PARAMS floats apart, and returns the step
 * to subtract.  `correct1`, `correct2`: corrections of the bias of the moments. */
ALWAYS_INLINE vfloat adam_update(vfloat gradient, vfloat rate, vfloat correct1, vfloat correct2,
                                 __global float *first_moment, __global float *second_moment) {
    vfloat m =
        fma((vfloat)(GSCL_ADAM_BETA1), LOAD_LANES(first_moment, GSCL_PARAMS), (1.0f - GSCL_ADAM_BETA1) * gradient);
    vfloat v = fma((vfloat)(GSCL_ADAM_BETA2), LOAD_LANES(second_moment, GSCL_PARAMS),
                   (1.0f - GSCL_ADAM_BETA2) * gradient * gradient);
    store_lanes(m, first_moment, GSCL_PARAMS);
    store_lanes(v, second_moment, GSCL_PARAMS);
    return rate * (m * correct1) / (sqrt(v * correct2) + GSCL_ADAM_EPSILON);
}

/* One step of Adam on the parameters `p`, with the bias correction of each splat's own age.  Moments of the centre are
 * in the splat's own frame. */
void adam(vfloat *restrict p, __global float *restrict first_moment, __global float *restrict second_moment, vfloat age,
          const vfloat *restrict gradient, float rate) {
    vfloat correct1 = rate / (1.0f - exp2(GSCL_ADAM_LOG2_BETA1 * age)),
           correct2 = 1.0f / (1.0f - exp2(GSCL_ADAM_LOG2_BETA2 * age));
    const unit_vector d = axis_direction(p[GSCL_THETA]);
    vfloat steps[FITTED], rates[FITTED];
    learning_rates(rates, p);
    UNROLL
    for (int k = 0; k < FITTED; k++) steps[k] = gradient[k];
    rotate_by(&steps[GSCL_X], &steps[GSCL_Y], d.x, -d.y);
    UNROLL
    for (int k = 0; k < FITTED; k++)
        if (IS_FITTED(k))
            steps[k] = adam_update(steps[k], rates[k], correct1, correct2, first_moment + k, second_moment + k);
    rotate_by(&steps[GSCL_X], &steps[GSCL_Y], d.x, d.y);
    UNROLL
    for (int k = 0; k < FITTED; k++)
        if (IS_FITTED(k)) p[k] -= steps[k];
}

/* Clamps the parameters to their bounds.  An excess of the aspect ratio is shared by the two axes. */
void clamp_params(vfloat *restrict p, gscl_limits b) {
    p[GSCL_X] = clamp(p[GSCL_X], (vfloat)(0.0f), (vfloat)(b.width));
    p[GSCL_Y] = clamp(p[GSCL_Y], (vfloat)(0.0f), (vfloat)(b.height));
    vfloat difference = p[GSCL_LOG_S1] - p[GSCL_LOG_S2];
    vfloat excess = fmax(0.5f * (fabs(difference) - b.log_aspect), (vfloat)(0.0f));
    excess = difference < 0.0f ? -excess : excess;
    p[GSCL_LOG_S1] = clamp(p[GSCL_LOG_S1] - excess, (vfloat)(b.log_min), (vfloat)(b.log_max));
    p[GSCL_LOG_S2] = clamp(p[GSCL_LOG_S2] + excess, (vfloat)(b.log_min), (vfloat)(b.log_max));
    p[GSCL_OPACITY] = clamp(p[GSCL_OPACITY], (vfloat)(-GSCL_MAX_LOGIT), (vfloat)(GSCL_MAX_LOGIT));
    UNROLL
    for (int k = 0; k < CHANNELS; k++)
        p[GSCL_COLOUR + k] = clamp(p[GSCL_COLOUR + k], (vfloat)(b.colour_min), (vfloat)(b.colour_max));
}

/* The first splat of a work-item, or of its group, and the work-items of a group. */
#define FIRST_SPLAT (SLOT_ITEMS > 1 ? get_group_id(0) : get_global_id(0) * SPLAT_LANES)
#define STEP_ITEMS (SLOT_ITEMS > 1 ? SLOT_ITEMS : SPLAT_ITEMS)

/* The gradients of the splats of a work-item, as they were drawn: of splat `i` and the ones after it, *lanes_used in all.
 * False for a work-item that has nothing left to do: it is behind the last splat, or another of its work-group goes on. */
bool gather(vfloat *restrict gradient, __global const float *restrict params, __global const float *restrict steps,
            gscl_gather_settings drawn, __global const float *restrict projected,
            __global const gscl_link_grid *restrict grids, __global const int *restrict links,
            __global const float *restrict slots, __local float *restrict shared, size_t i, int *restrict lanes_used) {
    float sums[SPLAT_LANES * MAX_SLOT];
    if (SLOT_ITEMS == 1 && i >= (size_t)drawn.splats) return false;
    *lanes_used = min(drawn.splats - (int)i, SPLAT_LANES);
    slots_sum(sums, i, *lanes_used, grids, links, slots, shared);
    if (SLOT_ITEMS > 1 && get_local_id(0) > 0) return false; /* before anything is read that the first one writes */
    splat s = splat_quantise(splat_load(params + i * GSCL_PARAMS, *lanes_used), steps);
    gradient_from_sums(gradient, sums, s, projected + i * GSCL_PROJECTED, drawn.view);
    return true;
}

/* Gives the first `fixed` lanes the parameters that are stored. */
void keep_params(vfloat *restrict p, __global const float *restrict params, int fixed, int lanes_used) {
    for (int k = 0; k < FITTED; k++) p[k] = select(p[k], LOAD_PARAM(params, k, lanes_used), LANES_BELOW(fixed));
}

/* One step of Adam for splats from `i` on, then the projection of the (quantised) result. */
void take_step(__global float *restrict params, __global float *restrict first_moment,
               __global float *restrict second_moment, __global int *restrict ages, const vfloat *restrict gradient,
               __global const float *restrict steps, gscl_adam_settings settings,
               __global const gscl_fit_control *restrict control, __global float *restrict projected,
               __global float *restrict ellipse_bounds, __global int4 *restrict boxes, size_t i, int lanes_used) {
    const size_t at = i * GSCL_PARAMS;
    vfloat p[FITTED];
    settings.limits.log_max = control->log_max;
    UNROLL
    for (int k = 0; k < FITTED; k++) p[k] = LOAD_PARAM(params + at, k, lanes_used);
    vint age = LOAD_LANES_INT(ages + i) + 1;
    store_lanes_int(age, ages + i, 1);
    adam(p, first_moment + at, second_moment + at, MASK_TAIL(TO_VFLOAT(age), lanes_used), gradient,
         settings.limits.rate);
    clamp_params(p, settings.limits);
    if ((int)i < settings.fixed) keep_params(p, params + at, settings.fixed - (int)i, lanes_used);
    UNROLL
    for (int k = 0; k < FITTED; k++)
        if (IS_FITTED(k)) store_lanes(p[k], params + at + k, GSCL_PARAMS);
    splat_store_projected(splat_quantise(splat_load(params + at, lanes_used), steps), settings.view, i, projected,
                          ellipse_bounds, boxes);
}
