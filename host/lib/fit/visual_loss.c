#include "fit/visual_loss.h"

#include <string.h>

#include "cl/constants.h"
#include "decode/renderer.h"
#include "fit/tunables.h"
#include "runtime/mapping.h"

#define GROUP 16   /* work-items; few, so that small scales still occupy all cores */
#define PLANES 3   /* X, Y, B */
#define MIN_SIDE 8 /* pixels of the smallest scale */
#define LUMA 1     /* of PLANES */

/* The weights of SSIMULACRA 2.1: of the mean and the 4-norm of structure, artefacts and lost detail.  Those below 0.01
 * are left out, and those of the finest scale. */
static const gscl_visual_weights loss_weights[PLANES][GSCL_VISUAL_SCALES] = {
    {{{0}},
     {{0, 1.104173f, 0, 0, 0, 0}},
     {{0, 1.842246f, 0, 11.441173f, 0, 0}},
     {{0, 1.878759f, 0, 10.949070f, 0, 0}},
     {{0, 0, 0.967794f, 0.998177f, 0, 0}}},
    {{{0}},
     {{0, 6.683678f, 0, 0, 0, 1.027890f}},
     {{225.205153f, 19.213238f, 0, 0, 0, 0}},
     {{176.393176f, 24.433010f, 0, 0.285208f, 0, 0}},
     {{0, 34.779063f, 0, 44.835625f, 0, 0}}},
    {{{0}},
     {{0}},
     {{0}},
     {{0, 8.826983f, 0, 23.192433f, 0, 0}},
     {{95.108050f, 0, 0.986398f, 171.266726f, 0.983438f, 0.980786f}}},
};

static bool has_weight(int plane, int scale) {
    for (int j = 0; j < GSCL_VISUAL_SUMS; j++)
        if (loss_weights[plane][scale].weight[j] > 0)
            return true;
    return false;
}

void gscl_visual_free(gscl_visual *v) {
    for (int i = 0; i < GSCL_MAX_LEVELS; i++) {
        gscl_visual_buffers *b = &v->scales[i];
        gscl_buffer *buffers[] = {&b->target, &b->statistics, &b->linear, &b->xyb, &b->rows, &b->maps, &b->by_colour};
        for (size_t k = 0; k < sizeof buffers / sizeof *buffers; k++)
            gscl_buffer_free(buffers[k]);
    }
    gscl_buffer *buffers[] = {&v->moments, &v->direct, &v->by_xyb, &v->curvature, &v->row_sums, &v->shares, &v->loss};
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

/* Where a plane begins among plain ones, floats. */
static cl_ulong plain_plane_at(const visual_step *s, int plane) {
    return (cl_ulong)plane * plain_bytes(s) / sizeof(float);
}

/* Likewise, its statistics, which are two planes. */
static cl_ulong statistics_at(const visual_step *s, int plane) {
    return 2 * plain_plane_at(s, plane);
}

/* The first scale that has terms.  Large images begin at a smaller one, which bounds the memory. */
static int first_scale(const gscl_visual_comparison *c) {
    int first = c->level > 0 ? c->level : 1;
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

/* Whether the loss has this plane at this scale.  Grey images have luma alone. */
static bool has_plane(const visual_step *s, int plane) {
    return s->scale >= first_scale(s->comparison) && has_weight(plane, s->scale) &&
           (plane == LUMA || s->comparison->options->colours == 3);
}

static gscl_result find_kernel(const visual_step *s, const char *name, cl_kernel *kernel) {
    return gscl_kernel(s->context, GSCL_PROGRAM_VISUAL, s->comparison->options, name, kernel);
}

static size_t pixel_groups(const visual_step *s) {
    return gscl_chunk_groups(s->context, s->shape.width, s->shape.height, GROUP);
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

static cl_ulong padded_plane_at(const visual_step *s, int plane) {
    return (cl_ulong)plane * (cl_ulong)s->shape.stride * (cl_ulong)(s->shape.height + 2 * GSCL_SSIM_MARGIN);
}

/* Converts planes of the level to linear light, at its own size or, if that has no terms, at half of it. */
static gscl_result make_first_linear(const visual_step *s, const gscl_buffer *planes) {
    const gscl_visual_comparison *c = s->comparison;
    cl_kernel kernel;
    if (s->scale > c->level) {
        const cl_int width = (cl_int)gscl_pyramid_width(c->pyramid, c->level);
        const cl_int height = (cl_int)gscl_pyramid_height(c->pyramid, c->level);
        GSCL_TRY(find_kernel(s, "visual_linear_half", &kernel));
        return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), GROUP, GSCL_ARG_BUFFER(*planes), GSCL_ARG(width),
                           GSCL_ARG(height), GSCL_ARG(s->shape), GSCL_ARG_BUFFER(s->buffers->linear));
    }
    const cl_int count = c->options->colours * s->shape.width * s->shape.height;
    GSCL_TRY(find_kernel(s, "visual_linear", &kernel));
    return GSCL_LAUNCH(s->context, kernel, gscl_chunk_groups(s->context, count, 1, GROUP), GROUP,
                       GSCL_ARG_BUFFER(*planes), GSCL_ARG(count), GSCL_ARG_BUFFER(s->buffers->linear));
}

/* The first scale with buffers: the level, if it has terms, or the next. */
static int linear_scale(const gscl_visual_comparison *c) {
    return first_scale(c) > c->level ? c->level + 1 : c->level;
}

/* Converts planes of the level to linear light, and halves them down to the last scale. */
static gscl_result make_linear(gscl_visual *v, const gscl_visual_comparison *c, const gscl_buffer *planes) {
    const int from = linear_scale(c), last = last_scale(c);
    const size_t colours = (size_t)c->options->colours;
    for (int scale = from; scale <= last; scale++) {
        const visual_step s = step_of(v, c, scale);
        GSCL_TRY(gscl_buffer_reserve_image(s.context, &s.buffers->linear, colours * plain_bytes(&s)));
        if (scale == from)
            GSCL_TRY(make_first_linear(&s, planes));
        for (size_t k = 0; k < colours && scale > from; k++)
            GSCL_TRY(gscl_pyramid_halve(c->pyramid, scale - 1, k, &v->scales[scale - 1].linear, &s.buffers->linear));
    }
    return GSCL_OK;
}

static gscl_result make_xyb(const visual_step *s, gscl_buffer *xyb) {
    cl_kernel kernel;
    GSCL_TRY(reserve_padded(s, xyb, PLANES));
    GSCL_TRY(find_kernel(s, "visual_xyb", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), GROUP, GSCL_ARG_BUFFER(s->buffers->linear),
                       GSCL_ARG(s->shape), GSCL_ARG_BUFFER(*xyb));
}

static gscl_result blur_rows(const visual_step *s, const gscl_buffer *rendering, int plane) {
    cl_kernel kernel;
    const cl_ulong plane_at = padded_plane_at(s, plane);
    GSCL_TRY(reserve_padded(s, &s->buffers->rows, 4));
    GSCL_TRY(find_kernel(s, "visual_blur_rows", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), GROUP, GSCL_ARG_BUFFER(*rendering),
                       GSCL_ARG_BUFFER(s->buffers->target), GSCL_ARG(plane_at), GSCL_ARG(s->shape),
                       GSCL_ARG_BUFFER(s->buffers->rows));
}

/* ---- The target ---- */

/* The mean and the variance of one plane of the target. */
static gscl_result make_statistics(const visual_step *s, int plane) {
    cl_kernel kernel;
    const cl_ulong to_at = statistics_at(s, plane);
    GSCL_TRY(blur_rows(s, &s->buffers->target, plane));
    GSCL_TRY(find_kernel(s, "visual_statistics", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), GROUP, GSCL_ARG_BUFFER(s->buffers->rows),
                       GSCL_ARG(s->shape), GSCL_ARG_BUFFER(s->buffers->statistics), GSCL_ARG(to_at));
}

/* Measures the target of the comparison's level. */
static gscl_result make_target(gscl_visual *v, const gscl_visual_comparison *c) {
    if (v->has_target && v->level == c->level)
        return GSCL_OK;
    v->has_target = false;
    GSCL_TRY(make_linear(v, c, &c->pyramid->levels[c->level]));
    for (int scale = first_scale(c); scale <= last_scale(c); scale++) {
        const visual_step s = step_of(v, c, scale);
        GSCL_TRY(make_xyb(&s, &s.buffers->target));
        GSCL_TRY(gscl_buffer_reserve_image(s.context, &s.buffers->statistics, 2 * PLANES * plain_bytes(&s)));
        for (int plane = 0; plane < PLANES; plane++)
            if (has_plane(&s, plane))
                GSCL_TRY(make_statistics(&s, plane));
    }
    v->level = c->level;
    v->has_target = true;
    return GSCL_OK;
}

/* ---- The derivative ---- */

/* The terms of a plane, their sums, and what the derivative by each map's values is. */
static gscl_result sum_terms(const visual_step *s, int plane) {
    gscl_visual *v = s->visual;
    cl_kernel kernel;
    const cl_ulong plane_at = padded_plane_at(s, plane), target_at = statistics_at(s, plane);
    const gscl_visual_comparison *c = s->comparison;
    const cl_float unit = c->share * (float)gscl_pyramid_pixels(c->pyramid, c->level) / 2000.0f;
    GSCL_TRY(gscl_buffer_reserve_image(s->context, &v->moments, 3 * plain_bytes(s)));
    GSCL_TRY(gscl_buffer_reserve(s->context, &v->row_sums, (size_t)s->shape.height * GSCL_VISUAL_SUMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve(s->context, &v->shares, GSCL_VISUAL_SUMS * sizeof(float)));
    GSCL_TRY(find_kernel(s, "visual_terms_row", &kernel));
    GSCL_TRY(GSCL_LAUNCH(s->context, kernel, (size_t)s->shape.height, 1, GSCL_ARG_BUFFER(s->buffers->rows),
                         GSCL_ARG_BUFFER(s->buffers->statistics), GSCL_ARG(target_at), GSCL_ARG_BUFFER(s->buffers->xyb),
                         GSCL_ARG_BUFFER(s->buffers->target), GSCL_ARG(plane_at), GSCL_ARG(s->shape),
                         GSCL_ARG_BUFFER(v->moments), GSCL_ARG_BUFFER(v->row_sums)));
    GSCL_TRY(find_kernel(s, "visual_shares", &kernel));
    return GSCL_LAUNCH(s->context, kernel, 1, 1, GSCL_ARG_BUFFER(v->row_sums), GSCL_ARG(s->shape),
                       GSCL_ARG(loss_weights[plane][s->scale]), GSCL_ARG(unit), GSCL_ARG_BUFFER(v->shares),
                       GSCL_ARG_BUFFER(v->loss));
}

/* The derivative by a plane of XYB, from its terms. */
static gscl_result differentiate_terms(const visual_step *s, int plane) {
    gscl_visual *v = s->visual;
    cl_kernel kernel;
    const cl_ulong plane_at = padded_plane_at(s, plane), to_at = plain_plane_at(s, plane);
    const cl_ulong target_at = statistics_at(s, plane);
    GSCL_TRY(reserve_padded(s, &s->buffers->maps, 4));
    GSCL_TRY(gscl_buffer_reserve_image(s->context, &v->direct, 2 * plain_bytes(s)));
    GSCL_TRY(find_kernel(s, "visual_maps", &kernel));
    GSCL_TRY(GSCL_LAUNCH(s->context, kernel, pixel_groups(s), GROUP, GSCL_ARG_BUFFER(v->moments),
                         GSCL_ARG_BUFFER(s->buffers->statistics), GSCL_ARG(target_at), GSCL_ARG_BUFFER(s->buffers->xyb),
                         GSCL_ARG_BUFFER(s->buffers->target), GSCL_ARG(plane_at), GSCL_ARG(s->shape),
                         GSCL_ARG_BUFFER(v->shares), GSCL_ARG_BUFFER(s->buffers->maps), GSCL_ARG_BUFFER(v->direct)));
    GSCL_TRY(find_kernel(s, "visual_blur_maps", &kernel));
    GSCL_TRY(GSCL_LAUNCH(s->context, kernel, pixel_groups(s), GROUP, GSCL_ARG_BUFFER(s->buffers->maps),
                         GSCL_ARG(s->shape), GSCL_ARG_BUFFER(s->buffers->rows)));
    GSCL_TRY(find_kernel(s, "visual_by_plane", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), GROUP, GSCL_ARG_BUFFER(s->buffers->rows),
                       GSCL_ARG_BUFFER(v->direct), GSCL_ARG_BUFFER(s->buffers->xyb),
                       GSCL_ARG_BUFFER(s->buffers->target), GSCL_ARG(plane_at), GSCL_ARG(s->shape),
                       GSCL_ARG_BUFFER(v->by_xyb), GSCL_ARG(to_at), GSCL_ARG_BUFFER(v->curvature));
}

/* The derivative by the linear colours of a scale, with those of smaller scales. */
static gscl_result differentiate_scale(const visual_step *s, bool has_smaller) {
    gscl_visual *v = s->visual;
    cl_kernel kernel;
    cl_int has = has_smaller ? 8 : 0;
    const size_t colours = (size_t)s->comparison->options->colours;
    const bool has_terms = s->scale >= first_scale(s->comparison);
    const size_t plane = has_terms ? plain_bytes(s) : sizeof(float);
    GSCL_TRY(gscl_buffer_reserve_image(s->context, &v->by_xyb, PLANES * plane));
    GSCL_TRY(gscl_buffer_reserve_image(s->context, &v->curvature, plane));
    GSCL_TRY(gscl_buffer_reserve_image(s->context, &s->buffers->by_colour, (colours + 1) * plain_bytes(s)));
    if (has_terms)
        GSCL_TRY(make_xyb(s, &s->buffers->xyb));
    /* Luma comes last: its curvature is kept. */
    static const int planes[PLANES] = {0, 2, LUMA};
    for (int i = 0; i < PLANES; i++) {
        if (!has_plane(s, planes[i]))
            continue;
        has |= 1 << planes[i];
        GSCL_TRY(blur_rows(s, &s->buffers->xyb, planes[i]));
        GSCL_TRY(sum_terms(s, planes[i]));
        GSCL_TRY(differentiate_terms(s, planes[i]));
    }
    const gscl_buffer *smaller = has_smaller ? &v->scales[s->scale + 1].by_colour : &v->curvature;
    GSCL_TRY(find_kernel(s, "visual_by_colour", &kernel));
    return GSCL_LAUNCH(s->context, kernel, pixel_groups(s), GROUP, GSCL_ARG_BUFFER(v->by_xyb),
                       GSCL_ARG_BUFFER(v->curvature), GSCL_ARG_BUFFER(s->buffers->linear), GSCL_ARG(s->shape),
                       GSCL_ARG_BUFFER(*smaller), GSCL_ARG(has), GSCL_ARG_BUFFER(s->buffers->by_colour));
}

/* The derivative of the visual loss by linear colours, of the size of linear_scale. */
static gscl_result differentiate(gscl_visual *v, const gscl_visual_comparison *c) {
    const int from = linear_scale(c), last = last_scale(c);
    gscl_context *context = c->pyramid->context;
    GSCL_TRY(make_target(v, c));
    GSCL_TRY(make_linear(v, c, c->rendering));
    GSCL_TRY(gscl_buffer_reserve(context, &v->loss, sizeof(float)));
    GSCL_TRY(gscl_buffer_zero(context, &v->loss, 0, sizeof(float)));
    for (int scale = last; scale >= from; scale--) {
        const visual_step s = step_of(v, c, scale);
        GSCL_TRY(differentiate_scale(&s, scale < last));
    }
    if (last >= from)
        return GSCL_OK;
    const visual_step s = step_of(v, c, from); /* no scale is large enough */
    const size_t size = ((size_t)c->options->colours + 1) * plain_bytes(&s);
    GSCL_TRY(gscl_buffer_reserve_image(context, &s.buffers->by_colour, size));
    return gscl_buffer_zero(context, &s.buffers->by_colour, 0, size);
}

gscl_result gscl_visual_derivative(gscl_visual *v, const gscl_visual_comparison *c, gscl_buffer *derivative) {
    const visual_step s = step_of(v, c, c->level);
    const size_t channels = (size_t)c->pyramid->channels;
    const cl_int is_half = linear_scale(c) > c->level;
    cl_kernel kernel;
    GSCL_TRY(differentiate(v, c));
    GSCL_TRY(gscl_buffer_reserve_image(s.context, derivative, channels * plain_bytes(&s)));
    GSCL_TRY(find_kernel(&s, "visual_derivative", &kernel));
    return GSCL_LAUNCH(s.context, kernel, pixel_groups(&s), GROUP,
                       GSCL_ARG_BUFFER(v->scales[c->level + is_half].by_colour), GSCL_ARG(is_half),
                       GSCL_ARG_BUFFER(*c->rendering), GSCL_ARG_BUFFER(c->pyramid->levels[c->level]), GSCL_ARG(s.shape),
                       GSCL_ARG_BUFFER(*derivative));
}

gscl_result gscl_visual_model(gscl_visual *v, const gscl_visual_comparison *c, float curvature, gscl_buffer *model) {
    const visual_step s = step_of(v, c, c->level);
    const size_t channels = (size_t)c->pyramid->channels;
    const cl_int is_half = linear_scale(c) > c->level;
    const cl_float share = curvature;
    cl_kernel kernel;
    GSCL_TRY(differentiate(v, c));
    GSCL_TRY(gscl_buffer_reserve_image(s.context, model, (channels + 2) * plain_bytes(&s)));
    GSCL_TRY(find_kernel(&s, "visual_model", &kernel));
    return GSCL_LAUNCH(s.context, kernel, pixel_groups(&s), GROUP,
                       GSCL_ARG_BUFFER(v->scales[c->level + is_half].by_colour), GSCL_ARG(is_half),
                       GSCL_ARG_BUFFER(*c->rendering), GSCL_ARG_BUFFER(c->pyramid->levels[c->level]), GSCL_ARG(s.shape),
                       GSCL_ARG(share), GSCL_ARG_BUFFER(*model));
}

gscl_result gscl_visual_read_loss(const gscl_visual *v, gscl_context *context, double *loss) {
    cl_float value = 0;
    GSCL_TRY(gscl_buffer_read(context, &v->loss, 0, &value, sizeof value));
    *loss = value;
    return GSCL_OK;
}
