#include "fit/visual_loss.h"

#include <string.h>

#include "cl/constants.h"
#include "decode/renderer.h"
#include "fit/tunables.h"
#include "runtime/mapping.h"

#define MIN_SIDE 8 /* pixels of the smallest scale */

/* The weights of SSIMULACRA 2.1 in luma: of the mean and the 4-norm of structure, artefacts and lost detail.  Those below
 * 0.01 are left out. */
static const gscl_visual_weights loss_weights[GSCL_VISUAL_SCALES] = {
    [2] = {{225.205153f, 19.213238f, 0, 0, 0, 0}},
    [3] = {{176.393176f, 24.433010f, 0, 0.285208f, 0, 0}},
    [4] = {{0, 34.779063f, 0, 44.835625f, 0, 0}},
};

void gscl_visual_free(gscl_visual *v) {
    gscl_buffer *buffers[] = {&v->target, &v->statistics, &v->luminance, &v->luma,         &v->rows,
                              &v->maps,   &v->moments,    &v->direct,    &v->by_luminance, &v->row_sums,
                              &v->shares, &v->losses,     &v->loss};
    for (size_t k = 0; k < sizeof buffers / sizeof *buffers; k++)
        gscl_buffer_free(buffers[k]);
    for (int i = 0; i < GSCL_VISUAL_SCALES; i++)
        gscl_buffer_free(&v->larger[i]);
    memset(v, 0, sizeof *v);
}

/* ---- Scales ---- */

static gscl_visual_scale scale_at(const gscl_pyramid *p, int level) {
    const int width = (int)gscl_pyramid_width(p, level), height = (int)gscl_pyramid_height(p, level);
    return (gscl_visual_scale){.width = width, .height = height, .stride = width + 2 * GSCL_SSIM_MARGIN};
}

static size_t plain_floats(const gscl_visual_scale *s) {
    return (size_t)s->width * (size_t)s->height;
}

static size_t padded_floats(const gscl_visual_scale *s) {
    return (size_t)s->stride * (size_t)(s->height + 2 * GSCL_SSIM_MARGIN);
}

/* The first scale that has terms.  Large images begin at a smaller one, which bounds the memory. */
static int first_scale(const gscl_visual_comparison *c) {
    int first = c->level > GSCL_VISUAL_FIRST_SCALE ? c->level : GSCL_VISUAL_FIRST_SCALE;
    while (gscl_pyramid_pixels(c->pyramid, first) > (size_t)gscl_fit_tunables.visual_max_pixels)
        first++;
    return first;
}

/* Lays out the scales that have terms. */
static void set_scales(gscl_visual *v, const gscl_visual_comparison *c) {
    int32_t before = 0, padded_before = 0;
    v->first = first_scale(c);
    v->scales = (gscl_visual_scales){.count = 0};
    for (int level = v->first; level < GSCL_VISUAL_SCALES; level++) {
        gscl_visual_scale scale = scale_at(c->pyramid, level);
        if (scale.width < MIN_SIDE || scale.height < MIN_SIDE)
            return;
        scale.before = before;
        scale.padded_before = padded_before;
        before += (int32_t)plain_floats(&scale);
        padded_before += (int32_t)padded_floats(&scale);
        v->scales.scale[v->scales.count++] = scale;
    }
}

static const gscl_visual_scale *last_scale(const gscl_visual *v) {
    return &v->scales.scale[v->scales.count - 1];
}

/* Rows of all scales. */
static size_t row_count(const gscl_visual *v) {
    size_t rows = 0;
    for (int k = 0; k < v->scales.count; k++)
        rows += (size_t)v->scales.scale[k].height;
    return rows;
}

/* Makes room for `planes` planes of all scales. */
static gscl_result reserve_plain(gscl_visual *v, gscl_context *context, gscl_buffer *buffer, size_t planes) {
    const gscl_visual_scale *last = last_scale(v);
    const size_t floats = (size_t)last->before + plain_floats(last);
    return gscl_buffer_reserve_image(context, buffer, planes * floats * sizeof(float));
}

/* The same of padded planes, whose margins are zeros. */
static gscl_result reserve_padded(gscl_visual *v, gscl_context *context, gscl_buffer *buffer, size_t planes) {
    const gscl_visual_scale *last = last_scale(v);
    const size_t size = planes * ((size_t)last->padded_before + padded_floats(last)) * sizeof(float);
    GSCL_TRY(gscl_buffer_reserve_image(context, buffer, size));
    return gscl_buffer_zero(context, buffer, 0, size);
}

static gscl_result reserve_buffers(gscl_visual *v, gscl_context *context) {
    const size_t sums = GSCL_VISUAL_SUMS * sizeof(float);
    GSCL_TRY(reserve_padded(v, context, &v->target, 1));
    GSCL_TRY(reserve_padded(v, context, &v->luma, 1));
    GSCL_TRY(reserve_padded(v, context, &v->rows, 4));
    GSCL_TRY(reserve_padded(v, context, &v->maps, 4));
    GSCL_TRY(reserve_plain(v, context, &v->statistics, 2));
    GSCL_TRY(reserve_plain(v, context, &v->luminance, 1));
    GSCL_TRY(reserve_plain(v, context, &v->moments, 3));
    GSCL_TRY(reserve_plain(v, context, &v->direct, 2));
    GSCL_TRY(reserve_plain(v, context, &v->by_luminance, 2));
    GSCL_TRY(gscl_buffer_reserve(context, &v->row_sums, row_count(v) * sums));
    GSCL_TRY(gscl_buffer_reserve(context, &v->shares, GSCL_VISUAL_TERM_SCALES * sums));
    return gscl_buffer_reserve(context, &v->losses, GSCL_VISUAL_TERM_SCALES * sizeof(float));
}

/* ---- Launches ---- */

static gscl_result find_kernel(const gscl_visual_comparison *c, const char *name, gscl_kernel **kernel) {
    return gscl_kernel_find(c->pyramid->context, GSCL_PROGRAM_VISUAL, c->options, name, kernel);
}

static size_t pixel_groups(const gscl_visual_comparison *c, const gscl_visual_scale *s) {
    return gscl_chunk_groups(c->pyramid->context, s->width, s->height);
}

/* Measures the luminance of the level's planes, at its own size or, if that has no terms, at half of it. */
static gscl_result make_first_luminance(const gscl_visual *v, const gscl_visual_comparison *c,
                                        const gscl_buffer *planes, const gscl_buffer *luminance) {
    gscl_context *context = c->pyramid->context;
    const gscl_visual_scale full = scale_at(c->pyramid, c->level), half = scale_at(c->pyramid, c->level + 1);
    gscl_kernel *kernel;
    if (v->first == c->level) {
        GSCL_TRY(find_kernel(c, "visual_luminance", &kernel));
        return GSCL_LAUNCH(context, kernel, pixel_groups(c, &full), gscl_chunk_group_size(context),
                           GSCL_ARG_BUFFER(*planes), GSCL_ARG(full), GSCL_ARG_BUFFER(*luminance));
    }
    GSCL_TRY(find_kernel(c, "visual_luminance_half", &kernel));
    return GSCL_LAUNCH(context, kernel, pixel_groups(c, &half), gscl_chunk_group_size(context),
                       GSCL_ARG_BUFFER(*planes), GSCL_ARG(full.width), GSCL_ARG(full.height), GSCL_ARG(half),
                       GSCL_ARG_BUFFER(*luminance));
}

static gscl_result halve_luminance(gscl_visual *v, const gscl_visual_comparison *c) {
    gscl_context *context = c->pyramid->context;
    gscl_kernel *kernel;
    if (v->scales.count == 1)
        return GSCL_OK;
    GSCL_TRY(find_kernel(c, "visual_halve_strip", &kernel));
    return GSCL_LAUNCH(context, kernel, (size_t)last_scale(v)->height, gscl_sum_group_size(context),
                       GSCL_ARG(v->scales), GSCL_ARG_BUFFER(v->luminance));
}

/* Measures the luminance of the level's planes at all scales. */
static gscl_result make_luminance(gscl_visual *v, const gscl_visual_comparison *c, const gscl_buffer *planes) {
    gscl_context *context = c->pyramid->context;
    const int from = v->first > c->level ? c->level + 1 : c->level;
    for (int level = from; level <= v->first; level++) {
        gscl_buffer *luminance = level == v->first ? &v->luminance : &v->larger[level];
        if (level < v->first)
            GSCL_TRY(
                gscl_buffer_reserve_image(context, luminance, gscl_pyramid_pixels(c->pyramid, level) * sizeof(float)));
        if (level == from)
            GSCL_TRY(make_first_luminance(v, c, planes, luminance));
        else
            GSCL_TRY(gscl_pyramid_halve(c->pyramid, level - 1, 0, &v->larger[level - 1], luminance));
    }
    return halve_luminance(v, c);
}

/* Makes luma of the luminance, and its sums along rows with the target. */
static gscl_result make_luma(gscl_visual *v, const gscl_visual_comparison *c, const gscl_buffer *luma) {
    gscl_context *context = c->pyramid->context;
    gscl_kernel *kernel;
    GSCL_TRY(find_kernel(c, "visual_luma_row", &kernel));
    return GSCL_LAUNCH(context, kernel, row_count(v), gscl_sum_group_size(context), GSCL_ARG_BUFFER(v->luminance),
                       GSCL_ARG(v->scales), GSCL_ARG_BUFFER(*luma), GSCL_ARG_BUFFER(v->target),
                       GSCL_ARG_BUFFER(v->rows));
}

/* The mean and the variance of the target. */
static gscl_result make_statistics(gscl_visual *v, const gscl_visual_comparison *c) {
    gscl_context *context = c->pyramid->context;
    gscl_kernel *kernel;
    GSCL_TRY(find_kernel(c, "visual_statistics_row", &kernel));
    return GSCL_LAUNCH(context, kernel, row_count(v), gscl_sum_group_size(context), GSCL_ARG_BUFFER(v->rows),
                       GSCL_ARG(v->scales), GSCL_ARG_BUFFER(v->statistics));
}

/* Measures the target of the comparison's level. */
static gscl_result make_target(gscl_visual *v, const gscl_visual_comparison *c) {
    if (v->has_target && v->level == c->level)
        return GSCL_OK;
    v->has_target = false;
    set_scales(v, c);
    if (v->scales.count > 0) {
        GSCL_TRY(reserve_buffers(v, c->pyramid->context));
        GSCL_TRY(make_luminance(v, c, &c->pyramid->levels[c->level]));
        GSCL_TRY(make_luma(v, c, &v->target));
        GSCL_TRY(make_statistics(v, c));
    }
    v->level = c->level;
    v->has_target = true;
    return GSCL_OK;
}

/* ---- The derivative ---- */

/* The error counts at the first scale alone. */
static gscl_visual_scale_weights weights_of(const gscl_visual *v) {
    gscl_visual_scale_weights weights = {0};
    for (int k = 0; k < v->scales.count; k++)
        weights.scale[k] = loss_weights[v->first + k];
    weights.scale[0].weight[GSCL_VISUAL_PEAKS] = gscl_fit_tunables.visual_peaks;
    return weights;
}

/* The terms, their sums, and what the derivative by each map's values is. */
static gscl_result sum_terms(gscl_visual *v, const gscl_visual_comparison *c) {
    gscl_context *context = c->pyramid->context;
    const gscl_visual_scale_weights weights = weights_of(v);
    const float unit = c->share * (float)gscl_pyramid_pixels(c->pyramid, c->level) / 2000.0f;
    gscl_kernel *kernel;
    GSCL_TRY(find_kernel(c, "visual_terms_row", &kernel));
    GSCL_TRY(GSCL_LAUNCH(context, kernel, row_count(v), gscl_sum_group_size(context), GSCL_ARG_BUFFER(v->rows),
                         GSCL_ARG_BUFFER(v->statistics), GSCL_ARG_BUFFER(v->luma), GSCL_ARG_BUFFER(v->target),
                         GSCL_ARG(v->scales), GSCL_ARG_BUFFER(v->moments), GSCL_ARG_BUFFER(v->row_sums)));
    GSCL_TRY(find_kernel(c, "visual_shares", &kernel));
    return GSCL_LAUNCH(context, kernel, (size_t)v->scales.count, gscl_sum_group_size(context),
                       GSCL_ARG_BUFFER(v->row_sums), GSCL_ARG(v->scales), GSCL_ARG(weights), GSCL_ARG(unit),
                       GSCL_ARG_BUFFER(v->shares), GSCL_ARG_BUFFER(v->losses));
}

/* The derivatives by what the terms are made of, blurred along rows, and that by luminance. */
static gscl_result differentiate_terms(gscl_visual *v, const gscl_visual_comparison *c) {
    gscl_context *context = c->pyramid->context;
    const size_t group_size = gscl_sum_group_size(context);
    gscl_kernel *kernel;
    GSCL_TRY(find_kernel(c, "visual_maps_row", &kernel));
    GSCL_TRY(GSCL_LAUNCH(context, kernel, row_count(v), group_size, GSCL_ARG_BUFFER(v->moments),
                         GSCL_ARG_BUFFER(v->statistics), GSCL_ARG_BUFFER(v->luma), GSCL_ARG_BUFFER(v->target),
                         GSCL_ARG(v->scales), GSCL_ARG_BUFFER(v->shares), GSCL_ARG_BUFFER(v->maps),
                         GSCL_ARG_BUFFER(v->direct), GSCL_ARG_BUFFER(v->rows)));
    GSCL_TRY(find_kernel(c, "visual_by_luminance_strip", &kernel));
    return GSCL_LAUNCH(context, kernel, (size_t)last_scale(v)->height, group_size, GSCL_ARG_BUFFER(v->rows),
                       GSCL_ARG_BUFFER(v->direct), GSCL_ARG_BUFFER(v->luma), GSCL_ARG_BUFFER(v->target),
                       GSCL_ARG(v->scales), GSCL_ARG_BUFFER(v->by_luminance), GSCL_ARG_BUFFER(v->losses),
                       GSCL_ARG_BUFFER(v->loss));
}

/* Where no scale is large enough, there is no loss. */
static gscl_result differentiate_nothing(gscl_visual *v, const gscl_visual_comparison *c) {
    const size_t size = 2 * gscl_pyramid_pixels(c->pyramid, v->first) * sizeof(float);
    gscl_context *context = c->pyramid->context;
    GSCL_TRY(gscl_buffer_zero(context, &v->loss, 0, sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve_image(context, &v->by_luminance, size));
    return gscl_buffer_zero(context, &v->by_luminance, 0, size);
}

/* The derivative of the visual loss by luminance, of the size of the first scale. */
static gscl_result differentiate(gscl_visual *v, const gscl_visual_comparison *c) {
    GSCL_TRY(make_target(v, c));
    GSCL_TRY(gscl_buffer_reserve(c->pyramid->context, &v->loss, sizeof(float)));
    if (v->scales.count == 0)
        return differentiate_nothing(v, c);
    GSCL_TRY(make_luminance(v, c, c->rendering));
    GSCL_TRY(make_luma(v, c, &v->luma));
    GSCL_TRY(sum_terms(v, c));
    return differentiate_terms(v, c);
}

gscl_result gscl_visual_derivative(gscl_visual *v, const gscl_visual_comparison *c, gscl_buffer *derivative) {
    gscl_context *context = c->pyramid->context;
    const gscl_visual_scale s = scale_at(c->pyramid, c->level);
    const size_t channels = (size_t)c->pyramid->channels;
    gscl_kernel *kernel;
    GSCL_TRY(differentiate(v, c));
    const int32_t halvings = v->first - c->level;
    GSCL_TRY(gscl_buffer_reserve_image(context, derivative, channels * plain_floats(&s) * sizeof(float)));
    GSCL_TRY(find_kernel(c, "visual_derivative", &kernel));
    return GSCL_LAUNCH(context, kernel, pixel_groups(c, &s), gscl_chunk_group_size(context),
                       GSCL_ARG_BUFFER(v->by_luminance), GSCL_ARG(halvings), GSCL_ARG_BUFFER(*c->rendering),
                       GSCL_ARG_BUFFER(c->pyramid->levels[c->level]), GSCL_ARG(s), GSCL_ARG_BUFFER(*derivative));
}

gscl_result gscl_visual_model(gscl_visual *v, const gscl_visual_comparison *c, float curvature, gscl_buffer *model) {
    gscl_context *context = c->pyramid->context;
    const gscl_visual_scale s = scale_at(c->pyramid, c->level);
    const float share = curvature;
    gscl_kernel *kernel;
    GSCL_TRY(differentiate(v, c));
    const int32_t halvings = v->first - c->level;
    GSCL_TRY(find_kernel(c, "visual_model", &kernel));
    return GSCL_LAUNCH(context, kernel, pixel_groups(c, &s), gscl_chunk_group_size(context),
                       GSCL_ARG_BUFFER(v->by_luminance), GSCL_ARG(halvings), GSCL_ARG_BUFFER(*c->rendering),
                       GSCL_ARG(s), GSCL_ARG(share), GSCL_ARG_BUFFER(*model));
}

gscl_result gscl_visual_read_loss(const gscl_visual *v, gscl_context *context, double *loss) {
    float value = 0;
    GSCL_TRY(gscl_buffer_read(context, &v->loss, 0, &value, sizeof value));
    *loss = value;
    return GSCL_OK;
}
