#include <stdlib.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/tunables.h"

gscl_result gscl_fit_begin_loss(gscl_fit *f) {
    cl_kernel kernel;
    cl_int tiles = (cl_int)gscl_renderer_tiles(&f->renderer);
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &f->renderer.options, "sum_loss", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, 1, 1, GSCL_ARG_BUFFER(f->tile_loss), GSCL_ARG(tiles),
                         GSCL_ARG_BUFFER(f->loss)));
    return gscl_buffer_read_async(f->context, &f->loss, &f->reading->loss, sizeof f->reading->loss);
}

double gscl_fit_read_loss(const gscl_fit *f) {
    return (double)f->reading->loss / ((double)gscl_fit_level_pixels(f) * f->renderer.channels);
}

gscl_result gscl_fit_loss(gscl_fit *f, double *loss) {
    GSCL_TRY(gscl_fit_begin_loss(f));
    GSCL_TRY(gscl_finish(f->context));
    *loss = gscl_fit_read_loss(f);
    return GSCL_OK;
}

/* Reads the squared error per pixel of planes against a target of `level`'s size. */
static gscl_result read_error(gscl_fit *f, const gscl_buffer *planes, const gscl_buffer *target, int level,
                              cl_int weighted, float *error) {
    cl_kernel kernel;
    size_t pixels = gscl_pyramid_pixels(&f->pyramid, level);
    cl_int channels = f->renderer.channels, count = (cl_int)pixels;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->error, pixels * sizeof(float)));
    GSCL_TRY(gscl_image_kernel(f->context, "squared_error", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, gscl_groups(pixels, GSCL_IMAGE_GROUP), GSCL_IMAGE_GROUP,
                         GSCL_ARG_BUFFER(*planes), GSCL_ARG_BUFFER(*target), GSCL_ARG(channels), GSCL_ARG(weighted),
                         GSCL_ARG(count), GSCL_ARG_BUFFER(f->error)));
    return gscl_buffer_read(f->context, &f->error, 0, error, pixels * sizeof(float));
}

/* The sum of read_error over the level. */
static gscl_result sum_error(gscl_fit *f, const gscl_buffer *planes, const gscl_buffer *target, int level,
                             cl_int weighted, double *sum) {
    size_t pixels = gscl_pyramid_pixels(&f->pyramid, level);
    float *error = malloc(pixels * sizeof *error);
    if (!error)
        return gscl_fail_memory(f->context);
    gscl_result result = read_error(f, planes, target, level, weighted, error);
    *sum = 0;
    for (size_t i = 0; i < pixels && result == GSCL_OK; i++)
        *sum += error[i];
    free(error);
    return result;
}

gscl_result gscl_fit_error(gscl_fit *f, float *error) {
    GSCL_TRY(gscl_fit_render(f));
    return read_error(f, &f->renderer.image, gscl_fit_weighted_target(f), f->level, f->renderer.options.weighted,
                      error);
}

gscl_result gscl_fit_rendering_error(gscl_fit *f, double *sum) {
    GSCL_TRY(gscl_fit_render(f));
    GSCL_TRY(gscl_fit_renew_model_at(f, &f->renderer.image, gscl_fit_tunables.curvature_of_steps));
    return gscl_fit_distortion(f, &f->renderer.image, sum);
}

gscl_result gscl_fit_error_sum(gscl_fit *f, const gscl_buffer *planes, double *sum) {
    return sum_error(f, planes, gscl_fit_weighted_target(f), f->level, f->renderer.options.weighted, sum);
}

gscl_result gscl_fit_distortion(gscl_fit *f, const gscl_buffer *planes, double *sum) {
    double loss;
    if (f->model_level != f->level)
        return gscl_fit_error_sum(f, planes, sum);
    GSCL_TRY(sum_error(f, planes, &f->pyramid.levels[f->level], f->level, GSCL_WEIGHTED_NOT, sum));
    GSCL_TRY(gscl_visual_read_loss(&f->visual, f->context, &loss));
    *sum += 2 * loss;
    return GSCL_OK;
}

gscl_result gscl_fit_mse_against_source(gscl_fit *f, const gscl_buffer *planes, double *mse) {
    int level = f->pyramid.first_level;
    double sum;
    GSCL_TRY(sum_error(f, planes, &f->pyramid.levels[level], level, GSCL_WEIGHTED_NOT, &sum));
    *mse = sum / ((double)gscl_pyramid_pixels(&f->pyramid, level) * f->renderer.channels);
    return GSCL_OK;
}
