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
    for (int i = 0; i < GSCL_MAX_LEVELS; i++) {
        gscl_visual_buffers *b = &v->scales[i];
        gscl_buffer *buffers[] = {&b->target, &b->statistics,   &b->luminance, &b->luma,
                                  &b->rows,   &b->by_luminance, &b->maps};
        for (size_t k = 0; k < sizeof buffers / sizeof *buffers; k++)
            gscl_buffer_free(buffers[k]);
    }
    gscl_buffer *buffers[] = {&v->moments, &v->direct, &v->row_sums, &v->shares, &v->loss};
    for (size_t k = 0; k < sizeof buffers / sizeof *buffers; k++)
        gscl_buffer_free(buffers[k]);
    memset(v, 0, sizeof *v);
}

/* One scale in one call. */
typedef struct visual_step {
    gscl_visual *visual;
    const gscl_visual_comparison *comparison;
    gscl_context *context;
    int scale;
    gscl_visual_scale shape;
    gscl_visual_buffers *buffers;
} visual_step;

static visual_step step_of(gscl_visual *v, const gscl_visual_comparison *c, int scale) {
    const int width = (int)gscl_pyramid_width(c->pyramid, scale), height = (int)gscl_pyramid_height(c->pyramid, scale);
    return (visual_step){.visual = v,
                         .comparison = c,
                         .context = c->pyramid->context,
                         .scale = scale,
                         .shape = {.width = width, .height = height, .stride = width + 2 * GSCL_SSIM_MARGIN},
                         .buffers = &v->scales[scale]};
}

static size_t plain_bytes(const visual_step *s) {
    return (size_t)s->shape.width * (size_t)s->shape.height * sizeof(float);
}

/* The first scale that has terms.  Large images begin at a smaller one, which bounds the memory. */
static int first_scale(const gscl_visual_comparison *c) {
    int first = c->level > GSCL_VISUAL_FIRST_SCALE ? c->level : GSCL_VISUAL_FIRST_SCALE;
    while (gscl_pyramid_pixels(c->pyramid, first) > (size_t)gscl_fit_tunables.visual_max_pixels)
        first++;
    return first;
}

/* The last one; below the first, there is none. */
static int last_scale(const gscl_visual_comparison *c) {
    int last = first_scale(c) - 1;
    while (last + 1 < GSCL_VISUAL_SCALES && gscl_pyramid_width(c->pyramid, last + 1) >= MIN_SIDE &&
           gscl_pyramid_height(c->pyramid, last + 1) >= MIN_SIDE)
        last++;
    return last;
}

static gscl_result find_kernel(const visual_step *s, const char *name, gscl_kernel **kernel) {
    return gscl_kernel_find(s->context, GSCL_PROGRAM_VISUAL, s->comparison->options, name, kernel);
}

static size_t pixel_groups(const visual_step *s) {
    return gscl_chunk_groups(s->context, s->shape.width, s->shape.height);
}

/* Makes padded planes, whose margins are zeros. */
static gscl_result reserve_padded(const visual_step *s, gscl_buffer *buffer, size_t planes) {
    const size_t rows = (size_t)(s->shape.height + 2 * GSCL_SSIM_MARGIN);
    const size_t size = planes * rows * (size_t)s->shape.stride * sizeof(float);
    if (buffer->memory)
        return GSCL_OK;
    GSCL_TRY(gscl_buffer_reserve_image(s->context, buffer, size));
    return gscl_buffer_zero(s->context, buffer, 0, size);
}

/* Measures the luminance of the level's planes, at its own size or, if that has no terms, at half of it. */
static gscl_result make_first_luminance(const visual_step *s, const gscl_buffer *planes) {
    const gscl_visual_comparison *c = s->comparison;
    const int32_t width = (int32_t)gscl_pyramid_width(c->pyramid, c->level);
    const int32_t height = (int32_t)gscl_pyramid_height(c->pyramid, c->level);
    gscl_kernel *kernel;
    if (s->scale == c->level) {
        GSCL_TRY(find_kernel(s, "visual_luminance", &kernel));
        return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), gscl_chunk_group_size(s->context),
                           GSCL_ARG_BUFFER(*planes), GSCL_ARG(s->shape), GSCL_ARG_BUFFER(s->buffers->luminance));
    }
    GSCL_TRY(find_kernel(s, "visual_luminance_half", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), gscl_chunk_group_size(s->context), GSCL_ARG_BUFFER(*planes),
                       GSCL_ARG(width), GSCL_ARG(height), GSCL_ARG(s->shape), GSCL_ARG_BUFFER(s->buffers->luminance));
}

/* The first scale with buffers: the level, if it has terms, or the next. */
static int largest_scale(const gscl_visual_comparison *c) {
    return first_scale(c) > c->level ? c->level + 1 : c->level;
}

/* Measures the luminance of the level's planes, and halves it down to the last scale. */
static gscl_result make_luminance(gscl_visual *v, const gscl_visual_comparison *c, const gscl_buffer *planes) {
    const int from = largest_scale(c), last = last_scale(c);
    for (int scale = from; scale <= last; scale++) {
        const visual_step s = step_of(v, c, scale);
        GSCL_TRY(gscl_buffer_reserve_image(s.context, &s.buffers->luminance, plain_bytes(&s)));
        if (scale == from)
            GSCL_TRY(make_first_luminance(&s, planes));
        else
            GSCL_TRY(
                gscl_pyramid_halve(c->pyramid, scale - 1, 0, &v->scales[scale - 1].luminance, &s.buffers->luminance));
    }
    return GSCL_OK;
}

static gscl_result make_luma(const visual_step *s, gscl_buffer *luma) {
    gscl_kernel *kernel;
    GSCL_TRY(reserve_padded(s, luma, 1));
    GSCL_TRY(find_kernel(s, "visual_luma", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), gscl_chunk_group_size(s->context),
                       GSCL_ARG_BUFFER(s->buffers->luminance), GSCL_ARG(s->shape), GSCL_ARG_BUFFER(*luma));
}

static gscl_result blur_rows(const visual_step *s, const gscl_buffer *luma) {
    gscl_kernel *kernel;
    GSCL_TRY(reserve_padded(s, &s->buffers->rows, 4));
    GSCL_TRY(find_kernel(s, "visual_blur_rows", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), gscl_chunk_group_size(s->context), GSCL_ARG_BUFFER(*luma),
                       GSCL_ARG_BUFFER(s->buffers->target), GSCL_ARG(s->shape), GSCL_ARG_BUFFER(s->buffers->rows));
}

/* ---- The target ---- */

/* Its mean and its variance. */
static gscl_result make_statistics(const visual_step *s) {
    gscl_kernel *kernel;
    GSCL_TRY(blur_rows(s, &s->buffers->target));
    GSCL_TRY(gscl_buffer_reserve_image(s->context, &s->buffers->statistics, 2 * plain_bytes(s)));
    GSCL_TRY(find_kernel(s, "visual_statistics", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), gscl_chunk_group_size(s->context),
                       GSCL_ARG_BUFFER(s->buffers->rows), GSCL_ARG(s->shape), GSCL_ARG_BUFFER(s->buffers->statistics));
}

/* Measures the target of the comparison's level. */
static gscl_result make_target(gscl_visual *v, const gscl_visual_comparison *c) {
    if (v->has_target && v->level == c->level)
        return GSCL_OK;
    v->has_target = false;
    GSCL_TRY(make_luminance(v, c, &c->pyramid->levels[c->level]));
    for (int scale = first_scale(c); scale <= last_scale(c); scale++) {
        const visual_step s = step_of(v, c, scale);
        GSCL_TRY(make_luma(&s, &s.buffers->target));
        GSCL_TRY(make_statistics(&s));
    }
    v->level = c->level;
    v->has_target = true;
    return GSCL_OK;
}

/* ---- The derivative ---- */

/* The error counts at the first scale alone. */
static gscl_visual_weights weights_of(const visual_step *s) {
    gscl_visual_weights weights = loss_weights[s->scale];
    if (s->scale == first_scale(s->comparison))
        weights.weight[GSCL_VISUAL_PEAKS] = gscl_fit_tunables.visual_peaks;
    return weights;
}

/* The terms of a scale, their sums, and what the derivative by each map's values is. */
static gscl_result sum_terms(const visual_step *s) {
    gscl_visual *v = s->visual;
    gscl_kernel *kernel;
    const gscl_visual_comparison *c = s->comparison;
    const gscl_visual_weights weights = weights_of(s);
    const float unit = c->share * (float)gscl_pyramid_pixels(c->pyramid, c->level) / 2000.0f;
    GSCL_TRY(gscl_buffer_reserve_image(s->context, &v->moments, 3 * plain_bytes(s)));
    GSCL_TRY(gscl_buffer_reserve(s->context, &v->row_sums, (size_t)s->shape.height * GSCL_VISUAL_SUMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve(s->context, &v->shares, GSCL_VISUAL_SUMS * sizeof(float)));
    GSCL_TRY(find_kernel(s, "visual_terms_row", &kernel));
    GSCL_TRY(GSCL_LAUNCH(s->context, kernel, (size_t)s->shape.height, gscl_sum_group_size(s->context),
                         GSCL_ARG_BUFFER(s->buffers->rows), GSCL_ARG_BUFFER(s->buffers->statistics),
                         GSCL_ARG_BUFFER(s->buffers->luma), GSCL_ARG_BUFFER(s->buffers->target), GSCL_ARG(s->shape),
                         GSCL_ARG_BUFFER(v->moments), GSCL_ARG_BUFFER(v->row_sums)));
    GSCL_TRY(find_kernel(s, "visual_shares", &kernel));
    return GSCL_LAUNCH(s->context, kernel, 1, gscl_sum_group_size(s->context), GSCL_ARG_BUFFER(v->row_sums),
                       GSCL_ARG(s->shape), GSCL_ARG(weights), GSCL_ARG(unit), GSCL_ARG_BUFFER(v->shares),
                       GSCL_ARG_BUFFER(v->loss));
}

/* The derivatives by what the terms are made of, blurred along rows. */
static gscl_result differentiate_terms(const visual_step *s) {
    gscl_visual *v = s->visual;
    gscl_kernel *kernel;
    GSCL_TRY(reserve_padded(s, &s->buffers->maps, 4));
    GSCL_TRY(gscl_buffer_reserve_image(s->context, &v->direct, 2 * plain_bytes(s)));
    GSCL_TRY(find_kernel(s, "visual_maps", &kernel));
    GSCL_TRY(GSCL_LAUNCH(s->context, kernel, pixel_groups(s), gscl_chunk_group_size(s->context),
                         GSCL_ARG_BUFFER(v->moments), GSCL_ARG_BUFFER(s->buffers->statistics),
                         GSCL_ARG_BUFFER(s->buffers->luma), GSCL_ARG_BUFFER(s->buffers->target), GSCL_ARG(s->shape),
                         GSCL_ARG_BUFFER(v->shares), GSCL_ARG_BUFFER(s->buffers->maps), GSCL_ARG_BUFFER(v->direct)));
    GSCL_TRY(find_kernel(s, "visual_blur_maps", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), gscl_chunk_group_size(s->context),
                       GSCL_ARG_BUFFER(s->buffers->maps), GSCL_ARG(s->shape), GSCL_ARG_BUFFER(s->buffers->rows));
}

/* The derivative by the luminance of a scale, with those of smaller scales. */
static gscl_result differentiate_scale(const visual_step *s, bool has_smaller) {
    gscl_visual *v = s->visual;
    gscl_kernel *kernel;
    const bool has_terms = s->scale >= first_scale(s->comparison);
    const int32_t has = (has_terms ? 1 : 0) | (has_smaller ? 2 : 0); /* HAS_TERMS, HAS_SMALLER */
    const gscl_buffer *buffers[] = {&s->buffers->rows, &v->direct, &s->buffers->luma, &s->buffers->target,
                                    &v->scales[s->scale + 1].by_luminance};
    if (has_terms) {
        GSCL_TRY(make_luma(s, &s->buffers->luma));
        GSCL_TRY(blur_rows(s, &s->buffers->luma));
        GSCL_TRY(sum_terms(s));
        GSCL_TRY(differentiate_terms(s));
    }
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
        if (!buffers[i]->memory) /* not read: any buffer will do */
            buffers[i] = &v->loss;
    GSCL_TRY(gscl_buffer_reserve_image(s->context, &s->buffers->by_luminance, 2 * plain_bytes(s)));
    GSCL_TRY(find_kernel(s, "visual_by_luminance", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), gscl_chunk_group_size(s->context),
                       GSCL_ARG_BUFFER(*buffers[0]), GSCL_ARG_BUFFER(*buffers[1]), GSCL_ARG_BUFFER(*buffers[2]),
                       GSCL_ARG_BUFFER(*buffers[3]), GSCL_ARG(s->shape), GSCL_ARG_BUFFER(*buffers[4]), GSCL_ARG(has),
                       GSCL_ARG_BUFFER(s->buffers->by_luminance));
}

/* The derivative of the visual loss by luminance, of the size of largest_scale. */
static gscl_result differentiate(gscl_visual *v, const gscl_visual_comparison *c) {
    const int from = largest_scale(c), last = last_scale(c);
    gscl_context *context = c->pyramid->context;
    GSCL_TRY(make_target(v, c));
    GSCL_TRY(make_luminance(v, c, c->rendering));
    GSCL_TRY(gscl_buffer_reserve(context, &v->loss, sizeof(float)));
    GSCL_TRY(gscl_buffer_zero(context, &v->loss, 0, sizeof(float)));
    for (int scale = last; scale >= from; scale--) {
        const visual_step s = step_of(v, c, scale);
        GSCL_TRY(differentiate_scale(&s, scale < last));
    }
    if (last >= from)
        return GSCL_OK;
    const visual_step s = step_of(v, c, from); /* no scale is large enough */
    GSCL_TRY(gscl_buffer_reserve_image(context, &s.buffers->by_luminance, 2 * plain_bytes(&s)));
    return gscl_buffer_zero(context, &s.buffers->by_luminance, 0, 2 * plain_bytes(&s));
}

gscl_result gscl_visual_derivative(gscl_visual *v, const gscl_visual_comparison *c, gscl_buffer *derivative) {
    const visual_step s = step_of(v, c, c->level);
    const size_t channels = (size_t)c->pyramid->channels;
    const int32_t is_half = largest_scale(c) > c->level;
    gscl_kernel *kernel;
    GSCL_TRY(differentiate(v, c));
    GSCL_TRY(gscl_buffer_reserve_image(s.context, derivative, channels * plain_bytes(&s)));
    GSCL_TRY(find_kernel(&s, "visual_derivative", &kernel));
    return GSCL_LAUNCH(s.context, kernel, pixel_groups(&s), gscl_chunk_group_size(s.context),
                       GSCL_ARG_BUFFER(v->scales[c->level + is_half].by_luminance), GSCL_ARG(is_half),
                       GSCL_ARG_BUFFER(*c->rendering), GSCL_ARG_BUFFER(c->pyramid->levels[c->level]), GSCL_ARG(s.shape),
                       GSCL_ARG_BUFFER(*derivative));
}

gscl_result gscl_visual_model(gscl_visual *v, const gscl_visual_comparison *c, float curvature, gscl_buffer *model) {
    const visual_step s = step_of(v, c, c->level);
    const int32_t is_half = largest_scale(c) > c->level;
    const float share = curvature;
    gscl_kernel *kernel;
    GSCL_TRY(differentiate(v, c));
    GSCL_TRY(find_kernel(&s, "visual_model", &kernel));
    return GSCL_LAUNCH(s.context, kernel, pixel_groups(&s), gscl_chunk_group_size(s.context),
                       GSCL_ARG_BUFFER(v->scales[c->level + is_half].by_luminance), GSCL_ARG(is_half),
                       GSCL_ARG_BUFFER(*c->rendering), GSCL_ARG(s.shape), GSCL_ARG(share), GSCL_ARG_BUFFER(*model));
}

gscl_result gscl_visual_read_loss(const gscl_visual *v, gscl_context *context, double *loss) {
    float value = 0;
    GSCL_TRY(gscl_buffer_read(context, &v->loss, 0, &value, sizeof value));
    *loss = value;
    return GSCL_OK;
}
