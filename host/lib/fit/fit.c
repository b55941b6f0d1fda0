#include "fit/fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "image/image.h"
#include "runtime/timing.h"

#define SMALLEST_LEVEL_SIDE 32     /* pixels: smaller levels would hold nothing to fit */
#define CHECK_INTERVAL 8           /* steps between looks at how full the tiles' lists are */
#define MOST_CROWD 24.0            /* splats on a tile, on average over those that hold more than the ground, */
#define MOST_SMALL_SIZE_CROWD 48.0 /* more at smaller sizes, which have fewer tiles, */
#define MOST_ALPHA_CROWD 150.0     /* more where splats hide each other and need to be many, */
#define CROWD_OF_SMALL 4.0   /* besides those that are as small as a tile, which touch so many at most: beyond, the */
                             /* longest axes are cut back */
#define QUIET 0.02           /* of the mean loss of a tile: a tile with less sits out steps */
#define LEAST_BUSY_TILES 0.1 /* of the tiles, however large the ground is */
#define CROWD_SHRINK 0.2f    /* by so much (ln) at a time: splats without end would cost time without end */

size_t gscl_fit_level_pixels(const gscl_fit *f, int level) {
    return (size_t)gscl_level_size(f->width, level) * gscl_level_size(f->height, level);
}

uint32_t gscl_fit_level_width(const gscl_fit *f) {
    return gscl_level_size(f->width, f->level);
}
uint32_t gscl_fit_level_height(const gscl_fit *f) {
    return gscl_level_size(f->height, f->level);
}

gscl_stage_id gscl_fit_stage(const gscl_fit *f) {
    static const gscl_stage_id stages[] = {GSCL_STAGE_FIT_FULL, GSCL_STAGE_FIT_HALF, GSCL_STAGE_FIT_QUARTER,
                                           GSCL_STAGE_FIT_EIGHTH};
    return f->level < 4 ? stages[f->level] : GSCL_STAGE_FIT_SMALLER;
}

gscl_result gscl_fit_halve(gscl_fit *f, int level, size_t channel, const gscl_buffer *from, const gscl_buffer *to) {
    cl_kernel kernel;
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_IMAGE, &f->renderer.options, "halve", &kernel));
    cl_int from_width = (cl_int)gscl_level_size(f->width, level),
           from_height = (cl_int)gscl_level_size(f->height, level);
    cl_int width = (cl_int)gscl_level_size(f->width, level + 1), height = (cl_int)gscl_level_size(f->height, level + 1);
    size_t pixels = gscl_fit_level_pixels(f, level + 1);
    cl_ulong from_at = channel * gscl_fit_level_pixels(f, level), to_at = channel * pixels;
    return GSCL_LAUNCH(f->context, kernel, gscl_groups(pixels, 64), 64, GSCL_ARG_BUFFER(*from), GSCL_ARG(from_at),
                       GSCL_ARG(from_width), GSCL_ARG(from_height), GSCL_ARG_BUFFER(*to), GSCL_ARG(to_at),
                       GSCL_ARG(width), GSCL_ARG(height));
}

static gscl_result build_pyramid(gscl_fit *f, const float *planes) {
    size_t channels = (size_t)f->renderer.channels, count = channels + (size_t)f->renderer.options.weighted;
    size_t pixels = gscl_fit_level_pixels(f, f->first_level);
    GSCL_TRY(gscl_buffer_reserve_image(f->context, &f->levels[f->first_level], pixels * count * sizeof(float)));
    GSCL_TRY(gscl_buffer_write(f->context, &f->levels[f->first_level], 0, planes, pixels * channels * sizeof(float)));
    uint32_t shorter = f->width < f->height ? f->width : f->height;
    f->last_level = f->first_level;
    while (f->last_level + 1 < GSCL_MAX_LEVELS && gscl_level_size(shorter, f->last_level + 1) >= SMALLEST_LEVEL_SIDE) {
        int level = f->last_level++;
        GSCL_TRY(gscl_buffer_reserve_image(f->context, &f->levels[level + 1],
                                           gscl_fit_level_pixels(f, level + 1) * count * sizeof(float)));
        for (size_t k = 0; k < channels; k++)
            GSCL_TRY(gscl_fit_halve(f, level, k, &f->levels[level], &f->levels[level + 1]));
    }
    return GSCL_OK;
}

/* The mean of each plane: the background that fits best where no splat reaches. */
static void mean_colour(const gscl_fit *f, const float *planes, float background[4]) {
    size_t pixels = gscl_fit_level_pixels(f, f->first_level);
    for (int k = 0; k < f->renderer.channels; k++) {
        double sum = 0;
        for (size_t i = 0; i < pixels; i++)
            sum += planes[(size_t)k * pixels + i];
        background[k] = (float)(sum / (double)pixels);
    }
}

gscl_result gscl_fit_create(gscl_fit *f, gscl_context *context, const gscl_kernel_options *options, uint32_t width,
                            uint32_t height, int first_level, const float *planes) {
    memset(f, 0, sizeof *f);
    gscl_stage(context, GSCL_STAGE_PYRAMID);
    f->context = context;
    f->width = width;
    f->height = height;
    f->first_level = first_level;
    f->ssim_weight = 0.5f; /* paper, section 3.4 */
    GSCL_TRY(gscl_renderer_create(&f->renderer, context, options));
    f->renderer.program = GSCL_PROGRAM_FIT;
    GSCL_TRY(gscl_buffer_reserve(context, &f->loss, sizeof(cl_float)));
    GSCL_TRY(build_pyramid(f, planes));
    if (options->weighted)
        GSCL_TRY(gscl_fit_build_weights(f));
    mean_colour(f, planes, f->background);
    float longer = (float)(width > height ? width : height);
    f->limits = (gscl_limits){.width = (float)width,
                              .height = (float)height,
                              .log_min = logf(0.5f),
                              .log_max = logf(longer),
                              .log_aspect = logf(64.0f),
                              .colour_min = options->blend == GSCL_SUM ? -1.0f : 0.0f,
                              .colour_max = 1.0f};
    if (f->limits.log_max < f->limits.log_min)
        f->limits.log_max = f->limits.log_min;
    GSCL_TRY(gscl_renderer_set_splats(&f->renderer, NULL, 0, f->background));
    return gscl_fit_set_level(f, first_level);
}

gscl_result gscl_fit_set_flat_background(gscl_fit *f, const gscl_flat_background *ground) {
    f->ground = *ground;
    memcpy(f->background, ground->colour, sizeof f->background);
    return gscl_renderer_set_splats(&f->renderer, NULL, 0, f->background);
}

void gscl_fit_free(gscl_fit *f) {
    gscl_renderer_free(&f->renderer);
    gscl_ssim_free(&f->ssim);
    gscl_buffer_free(&f->derivative);
    gscl_buffer_free(&f->adapted);
    for (int i = 0; i < GSCL_MAX_LEVELS; i++)
        gscl_buffer_free(&f->levels[i]);
    gscl_buffer *buffers[] = {&f->gradients, &f->first_moment, &f->second_moment, &f->ages, &f->slots,
                              &f->tile_loss, &f->wakes,        &f->loss,          &f->error};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        gscl_buffer_free(buffers[i]);
}

/* No tile sits out a step until losses have been looked at again. */
static gscl_result wake_tiles(gscl_fit *f) {
    size_t bytes = (size_t)f->renderer.view.tiles_x * (size_t)f->renderer.view.tiles_y * sizeof(cl_int);
    f->quiet = 0;
    f->has_losses = false;
    f->step = 0;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->wakes, bytes));
    return gscl_buffer_zero(f->context, &f->wakes, 0, bytes);
}

gscl_result gscl_fit_set_level(gscl_fit *f, int level) {
    f->level = level < f->first_level ? f->first_level : level > f->last_level ? f->last_level : level;
    GSCL_TRY(gscl_renderer_set_view(&f->renderer, f->level, 0, 0, gscl_fit_level_width(f), gscl_fit_level_height(f)));
    size_t tiles = (size_t)f->renderer.view.tiles_x * (size_t)f->renderer.view.tiles_y;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->tile_loss, tiles * sizeof(float)));
    GSCL_TRY(wake_tiles(f));
    f->steps_since_check = CHECK_INTERVAL;
    return gscl_renderer_project(&f->renderer);
}

/* Room for `count` splats, keeping the optimiser's state. */
static gscl_result reserve(gscl_fit *f, size_t count) {
    if (count <= f->capacity)
        return GSCL_OK;
    count = gscl_room_for_splats(count + count / 4);
    size_t row = GSCL_PARAMS * sizeof(float), used = (size_t)f->renderer.count * row;
    GSCL_TRY(gscl_renderer_reserve(&f->renderer, count));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->gradients, count * row));
    GSCL_TRY(gscl_buffer_zero(f->context, &f->gradients, 0, count * row)); /* not all are ever written */
    GSCL_TRY(gscl_buffer_grow(f->context, &f->first_moment, count * row, used));
    GSCL_TRY(gscl_buffer_grow(f->context, &f->second_moment, count * row, used));
    GSCL_TRY(
        gscl_buffer_grow(f->context, &f->ages, count * sizeof(cl_int), (size_t)f->renderer.count * sizeof(cl_int)));
    f->capacity = count;
    return GSCL_OK;
}

gscl_result gscl_fit_append(gscl_fit *f, const float *params, size_t count) {
    size_t row = GSCL_PARAMS * sizeof(float), used = (size_t)f->renderer.count;
    GSCL_TRY(reserve(f, used + count));
    GSCL_TRY(gscl_buffer_write(f->context, &f->renderer.params, used * row, params, count * row));
    GSCL_TRY(gscl_buffer_zero(f->context, &f->first_moment, used * row, count * row));
    GSCL_TRY(gscl_buffer_zero(f->context, &f->second_moment, used * row, count * row));
    GSCL_TRY(gscl_buffer_zero(f->context, &f->ages, used * sizeof(cl_int), count * sizeof(cl_int)));
    f->renderer.count += (cl_int)count;
    f->steps_since_check = CHECK_INTERVAL;
    GSCL_TRY(wake_tiles(f)); /* their losses were those of other splats */
    return gscl_renderer_project(&f->renderer);
}

gscl_result gscl_fit_replace(gscl_fit *f, const float *params, size_t count) {
    f->renderer.count = 0;
    return gscl_fit_append(f, params, count);
}

static gscl_result reorder_rows(gscl_fit *f, const gscl_buffer *buffer, size_t row, const size_t *order, size_t kept) {
    size_t count = (size_t)f->renderer.count;
    unsigned char *from = malloc((count + kept) * row + 1), *to = from + count * row;
    if (!from)
        return gscl_fail_memory(f->context);
    gscl_result result = gscl_buffer_read(f->context, buffer, 0, from, count * row);
    for (size_t i = 0; i < kept && result == GSCL_OK; i++)
        memcpy(to + i * row, from + order[i] * row, row);
    if (result == GSCL_OK)
        result = gscl_buffer_write(f->context, buffer, 0, to, kept * row);
    free(from);
    return result;
}

gscl_result gscl_fit_reorder(gscl_fit *f, const size_t *order, size_t kept) {
    size_t row = GSCL_PARAMS * sizeof(float);
    GSCL_TRY(reorder_rows(f, &f->renderer.params, row, order, kept));
    GSCL_TRY(reorder_rows(f, &f->first_moment, row, order, kept));
    GSCL_TRY(reorder_rows(f, &f->second_moment, row, order, kept));
    GSCL_TRY(reorder_rows(f, &f->ages, sizeof(cl_int), order, kept));
    f->renderer.count = (cl_int)kept;
    return gscl_renderer_project(&f->renderer);
}

gscl_result gscl_fit_read(gscl_fit *f, float *params) {
    return gscl_buffer_read(f->context, &f->renderer.params, 0, params,
                            (size_t)f->renderer.count * GSCL_PARAMS * sizeof(float));
}

static gscl_result launch_tiles(gscl_fit *f, const gscl_buffer *picture) {
    gscl_renderer *r = &f->renderer;
    size_t slot =
        (size_t)GSCL_SLOT_SIZE(r->options.shape, r->options.opacity, r->channels, r->options.texture) * sizeof(float);
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->slots, r->entries.size / sizeof(cl_uint) * slot));
    cl_kernel kernel;
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "fit_tiles", &kernel));
    cl_ulong plane = gscl_renderer_plane(r);
    cl_float gain = ldexpf(1.0f, 2 * f->level); /* a level has 4^level fewer pixels to add up */
    return GSCL_LAUNCH(f->context, kernel, (size_t)r->view.tiles_x * (size_t)r->view.tiles_y,
                       gscl_tile_group_size(f->context), GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->entries),
                       GSCL_ARG_BUFFER(r->tile_ranges), GSCL_ARG_BUFFER(r->background), GSCL_ARG_BUFFER(*picture),
                       GSCL_ARG(r->width), GSCL_ARG(r->height), GSCL_ARG(r->view.tiles_x), GSCL_ARG(plane),
                       GSCL_ARG(gain), GSCL_ARG(f->quiet), GSCL_ARG_BUFFER(f->slots), GSCL_ARG_BUFFER(f->tile_loss),
                       GSCL_ARG_BUFFER(f->wakes), GSCL_ARG(f->step));
}

static gscl_result launch_gather(gscl_fit *f) {
    gscl_renderer *r = &f->renderer;
    cl_kernel kernel;
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "gather_gradients", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_groups((size_t)r->count, GSCL_SPLATS_PER_GROUP),
                       gscl_splat_group_size(f->context, GSCL_PROGRAM_FIT), GSCL_ARG_BUFFER(r->params),
                       GSCL_ARG_BUFFER(r->steps), GSCL_ARG(r->count), GSCL_ARG(r->view), GSCL_ARG_BUFFER(r->boxes),
                       GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG_BUFFER(r->entries),
                       GSCL_ARG_BUFFER(r->tile_ranges), GSCL_ARG_BUFFER(f->slots), GSCL_ARG_BUFFER(f->gradients));
}

gscl_result gscl_fit_adam(gscl_fit *f, const gscl_buffer *params, float rate) {
    gscl_renderer *r = &f->renderer;
    cl_kernel kernel;
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "adam_step", &kernel));
    f->limits.rate = rate;
    return GSCL_LAUNCH(f->context, kernel, gscl_groups((size_t)r->count, GSCL_SPLATS_PER_GROUP),
                       gscl_splat_group_size(f->context, GSCL_PROGRAM_FIT), GSCL_ARG_BUFFER(*params),
                       GSCL_ARG_BUFFER(f->first_moment), GSCL_ARG_BUFFER(f->second_moment), GSCL_ARG_BUFFER(f->ages),
                       GSCL_ARG_BUFFER(f->gradients), GSCL_ARG_BUFFER(r->steps), GSCL_ARG(r->count),
                       GSCL_ARG(f->limits), GSCL_ARG(r->view), GSCL_ARG_BUFFER(r->projected),
                       GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG_BUFFER(r->boxes));
}

/* The part of the tiles that hold more than the ground. */
static double busy_tiles(const gscl_fit *f) {
    return fmax(1 - f->ground.tiles, LEAST_BUSY_TILES);
}

static double most_crowd(const gscl_fit *f) {
    const gscl_renderer *r = &f->renderer;
    double large = r->options.blend == GSCL_ALPHA ? MOST_ALPHA_CROWD
                   : f->level > f->first_level    ? MOST_SMALL_SIZE_CROWD
                                                  : MOST_CROWD;
    return busy_tiles(f) * large + CROWD_OF_SMALL * r->count / ((double)r->view.tiles_x * r->view.tiles_y);
}

/* From the losses of the last step; an external loss has none. */
static gscl_result set_quiet(gscl_fit *f) {
    double loss;
    if (!f->has_losses || f->renderer.options.loss == GSCL_LOSS_KIND_EXTERNAL)
        return GSCL_OK;
    GSCL_TRY(gscl_fit_loss(f, &loss));
    f->quiet = (float)(QUIET * loss * f->renderer.channels / busy_tiles(f));
    return GSCL_OK;
}

gscl_result gscl_fit_differentiate(gscl_fit *f) {
    bool check = f->steps_since_check >= CHECK_INTERVAL;
    GSCL_TRY(gscl_renderer_bin(&f->renderer, check));
    f->steps_since_check = check ? 1 : f->steps_since_check + 1;
    if (check && f->renderer.crowd > most_crowd(f))
        f->limits.log_max = fmaxf(f->limits.log_max - CROWD_SHRINK, f->limits.log_min);
    if (check)
        GSCL_TRY(set_quiet(f));
    if (f->renderer.options.loss == GSCL_LOSS_KIND_EXTERNAL) {
        gscl_renderer *r = &f->renderer;
        GSCL_TRY(gscl_renderer_draw(r));
        GSCL_TRY(gscl_ssim_derivative(&f->ssim, f->context, &r->options, r->width, r->height, &r->image,
                                      &f->levels[f->level], f->ssim_weight, &f->derivative));
        GSCL_TRY(launch_tiles(f, &f->derivative));
    } else {
        GSCL_TRY(launch_tiles(f, gscl_fit_weighted_target(f)));
    }
    f->has_losses = true;
    f->step++;
    return launch_gather(f);
}

gscl_result gscl_fit_step(gscl_fit *f, float rate) {
    GSCL_TRY(gscl_fit_differentiate(f));
    return gscl_fit_adam(f, &f->renderer.params, rate);
}

gscl_result gscl_fit_gradients(gscl_fit *f, float *gradients) {
    f->steps_since_check = CHECK_INTERVAL;
    GSCL_TRY(wake_tiles(f));
    GSCL_TRY(gscl_fit_differentiate(f));
    return gscl_buffer_read(f->context, &f->gradients, 0, gradients,
                            (size_t)f->renderer.count * GSCL_PARAMS * sizeof(float));
}

gscl_result gscl_fit_loss(gscl_fit *f, double *loss) {
    cl_kernel kernel;
    cl_int tiles = f->renderer.view.tiles_x * f->renderer.view.tiles_y;
    cl_float sum = 0;
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &f->renderer.options, "sum_loss", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, 1, 1, GSCL_ARG_BUFFER(f->tile_loss), GSCL_ARG(tiles),
                         GSCL_ARG_BUFFER(f->loss)));
    GSCL_TRY(gscl_buffer_read(f->context, &f->loss, 0, &sum, sizeof sum));
    *loss = (double)sum / ((double)gscl_fit_level_pixels(f, f->level) * f->renderer.channels);
    return GSCL_OK;
}

/* Squared error of planes against a goal of `level`'s size, per pixel, read into `error`. */
static gscl_result read_distance(gscl_fit *f, const gscl_buffer *planes, const gscl_buffer *goal, int level,
                                 cl_int weighted, float *error) {
    cl_kernel kernel;
    size_t pixels = gscl_fit_level_pixels(f, level);
    cl_int channels = f->renderer.channels, count = (cl_int)pixels;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->error, pixels * sizeof(float)));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_IMAGE, &f->renderer.options, "squared_error", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, gscl_groups(pixels, 64), 64, GSCL_ARG_BUFFER(*planes),
                         GSCL_ARG_BUFFER(*goal), GSCL_ARG(channels), GSCL_ARG(weighted), GSCL_ARG(count),
                         GSCL_ARG_BUFFER(f->error)));
    return gscl_buffer_read(f->context, &f->error, 0, error, pixels * sizeof(float));
}

/* Squared error of planes against the level's target. */
static gscl_result read_error(gscl_fit *f, const gscl_buffer *planes, float *error) {
    return read_distance(f, planes, gscl_fit_weighted_target(f), f->level, f->renderer.options.weighted, error);
}

static gscl_result draw(gscl_fit *f) {
    GSCL_TRY(gscl_renderer_bin(&f->renderer, true));
    return gscl_renderer_draw(&f->renderer);
}

gscl_result gscl_fit_error(gscl_fit *f, float *error) {
    GSCL_TRY(draw(f));
    return read_error(f, &f->renderer.image, error);
}

gscl_result gscl_fit_drawn_error(gscl_fit *f, double *sum) {
    GSCL_TRY(draw(f));
    return gscl_fit_error_sum(f, &f->renderer.image, sum);
}

gscl_result gscl_fit_error_sum(gscl_fit *f, const gscl_buffer *planes, double *sum) {
    size_t pixels = gscl_fit_level_pixels(f, f->level);
    float *error = malloc(pixels * sizeof *error);
    if (!error)
        return gscl_fail_memory(f->context);
    gscl_result result = read_error(f, planes, error);
    *sum = 0;
    for (size_t i = 0; i < pixels && result == GSCL_OK; i++)
        *sum += error[i];
    free(error);
    return result;
}

gscl_result gscl_fit_mse_against_source(gscl_fit *f, const gscl_buffer *planes, double *mse) {
    size_t pixels = gscl_fit_level_pixels(f, f->first_level);
    float *error = malloc(pixels * sizeof *error);
    if (!error)
        return gscl_fail_memory(f->context);
    gscl_result result = read_distance(f, planes, &f->levels[f->first_level], f->first_level, 0, error);
    double sum = 0;
    for (size_t i = 0; i < pixels && result == GSCL_OK; i++)
        sum += error[i];
    *mse = sum / ((double)pixels * f->renderer.channels);
    free(error);
    return result;
}

gscl_result gscl_fit_target(gscl_fit *f, float *planes) {
    return gscl_buffer_read(f->context, &f->levels[f->level], 0, planes,
                            gscl_fit_level_pixels(f, f->level) * (size_t)f->renderer.channels * sizeof(float));
}
