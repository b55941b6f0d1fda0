/* Squared errors that stand for MS-SSIM: a weight for each pixel, and targets of more contrast (cl/ssim.cl). */
#include "fit/fit.h"
#include "image/image.h"

/* The scales of MS-SSIM that count most, and their exponents (Wang et al. 2003).  The finest is left out: its windows
 * are so small that in smooth places they see only noise. */
#define SCALES 3
static const float shares[SCALES] = {0.2856f, 0.3001f, 0.2363f};

const gscl_buffer *gscl_fit_weighted_target(const gscl_fit *f) {
    return f->level == f->first_level && f->adapted.memory ? &f->adapted : &f->levels[f->level];
}

/* Adds a level's weights, judged without a picture or of one at that level, to those behind the first level's planes. */
static gscl_result add_weights(gscl_fit *f, int level, const gscl_buffer *picture, float share,
                               const gscl_buffer *planes) {
    gscl_buffer part = {0};
    cl_kernel kernel;
    cl_int from_width = (cl_int)gscl_level_size(f->width, level),
           from_height = (cl_int)gscl_level_size(f->height, level);
    cl_int width = (cl_int)gscl_level_size(f->width, f->first_level),
           height = (cl_int)gscl_level_size(f->height, f->first_level);
    cl_int shift = level - f->first_level;
    size_t pixels = gscl_fit_level_pixels(f, f->first_level);
    cl_ulong to_at = pixels * (size_t)f->renderer.channels;
    gscl_result result = gscl_ssim_weights(&f->ssim, f->context, &f->renderer.options, from_width, from_height, picture,
                                           &f->levels[level], &part);
    if (result == GSCL_OK)
        result = gscl_kernel(f->context, GSCL_PROGRAM_IMAGE, &f->renderer.options, "add_enlarged", &kernel);
    if (result == GSCL_OK)
        result = GSCL_LAUNCH(f->context, kernel, gscl_groups(pixels, 64), 64, GSCL_ARG_BUFFER(part),
                             GSCL_ARG(from_width), GSCL_ARG(from_height), GSCL_ARG(shift), GSCL_ARG(share),
                             GSCL_ARG_BUFFER(*planes), GSCL_ARG(to_at), GSCL_ARG(width), GSCL_ARG(height));
    gscl_buffer_free(&part);
    return result;
}

gscl_result gscl_fit_build_weights(gscl_fit *f) {
    const gscl_buffer *first = &f->levels[f->first_level];
    size_t channels = (size_t)f->renderer.channels, plane = gscl_fit_level_pixels(f, f->first_level) * sizeof(float);
    GSCL_TRY(gscl_buffer_zero(f->context, first, channels * plane, plane));
    for (int i = 0; i < SCALES; i++) {
        int level = i + 1 < f->first_level ? f->first_level : i + 1 > f->last_level ? f->last_level : i + 1;
        GSCL_TRY(add_weights(f, level, NULL, shares[i], first));
    }
    for (int level = f->first_level; level < f->last_level; level++)
        GSCL_TRY(gscl_fit_halve(f, level, channels, &f->levels[level], &f->levels[level + 1]));
    return GSCL_OK;
}

/* Raises the contrast of the target, by the gains at half its size, into the adapted planes. */
static gscl_result raise_contrast(gscl_fit *f, const gscl_buffer *gains) {
    cl_int channels = f->renderer.channels, width = (cl_int)gscl_level_size(f->width, f->first_level),
           height = (cl_int)gscl_level_size(f->height, f->first_level);
    cl_kernel kernel;
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_IMAGE, &f->renderer.options, "raise_contrast", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_groups(gscl_fit_level_pixels(f, f->first_level), 64), 64,
                       GSCL_ARG_BUFFER(f->levels[f->first_level]), GSCL_ARG_BUFFER(*gains), GSCL_ARG(channels),
                       GSCL_ARG(width), GSCL_ARG(height), GSCL_ARG_BUFFER(f->adapted));
}

/* With the picture at half its size: judges it, and makes the adapted target and weights. */
static gscl_result adapt_to(gscl_fit *f, gscl_buffer *half, gscl_buffer *gains) {
    int level = f->first_level + 1;
    size_t channels = (size_t)f->renderer.channels, plane = gscl_fit_level_pixels(f, f->first_level) * sizeof(float);
    GSCL_TRY(gscl_buffer_reserve_image(f->context, half, gscl_fit_level_pixels(f, level) * channels * sizeof(float)));
    for (size_t k = 0; k < channels; k++)
        GSCL_TRY(gscl_fit_halve(f, f->first_level, k, &f->renderer.image, half));
    GSCL_TRY(gscl_buffer_reserve_image(f->context, &f->adapted, (channels + 1) * plane));
    GSCL_TRY(gscl_buffer_copy(f->context, &f->levels[f->first_level], &f->adapted, channels * plane, plane));
    GSCL_TRY(add_weights(f, level, half, 1.0f, &f->adapted));
    GSCL_TRY(gscl_ssim_gains(&f->ssim, f->context, &f->renderer.options, (int)gscl_level_size(f->width, level),
                             (int)gscl_level_size(f->height, level), gains));
    return raise_contrast(f, gains);
}

gscl_result gscl_fit_adapt(gscl_fit *f) {
    gscl_buffer half = {0}, gains = {0};
    if (!f->renderer.options.weighted || f->level != f->first_level || f->first_level == f->last_level)
        return GSCL_OK;
    GSCL_TRY(gscl_renderer_bin(&f->renderer, true));
    GSCL_TRY(gscl_renderer_draw(&f->renderer));
    gscl_result result = adapt_to(f, &half, &gains);
    gscl_buffer_free(&half);
    gscl_buffer_free(&gains);
    return result;
}
