#include "fit/ssim_weights.h"

#include "decode/renderer.h"
#include "image/metrics.h"

/* The scales of MS-SSIM with the largest exponents.  The finest is left out: in smooth places its small windows measure
 * only noise. */
#define SCALES 3
#define FIRST_SCALE 1

/* Adds a level's weights, from the source alone or from a rendering of that level's size, to those behind the first
 * level's planes. */
static gscl_result weights_add(const gscl_pyramid *p, gscl_ssim *ssim, const gscl_kernel_options *options, int level,
                               const gscl_buffer *rendering, float share, const gscl_buffer *planes) {
    gscl_buffer part = {0};
    gscl_kernel *kernel;
    const gscl_enlargement enlargement = {.from_width = (int32_t)gscl_pyramid_width(p, level),
                                          .from_height = (int32_t)gscl_pyramid_height(p, level),
                                          .width = (int32_t)gscl_pyramid_width(p, p->first_level),
                                          .height = (int32_t)gscl_pyramid_height(p, p->first_level),
                                          .shift = level - p->first_level,
                                          .share = share};
    size_t pixels = gscl_pyramid_pixels(p, p->first_level);
    uint64_t to_at = pixels * (size_t)p->channels;
    gscl_result result = gscl_ssim_weights(ssim, p->context, options, enlargement.from_width, enlargement.from_height,
                                           rendering, &p->levels[level], &part);
    if (result == GSCL_OK)
        result = gscl_image_kernel(p->context, "add_enlarged", &kernel);
    if (result == GSCL_OK)
        result = GSCL_LAUNCH(p->context, kernel, gscl_groups(pixels, GSCL_IMAGE_GROUP), GSCL_IMAGE_GROUP,
                             GSCL_ARG_BUFFER(part), GSCL_ARG(enlargement), GSCL_ARG_BUFFER(*planes), GSCL_ARG(to_at));
    gscl_buffer_free(&part);
    return result;
}

gscl_result gscl_weights_build(const gscl_pyramid *p, gscl_ssim *ssim, const gscl_kernel_options *options) {
    const gscl_buffer *first = &p->levels[p->first_level];
    size_t channels = (size_t)p->channels, plane = gscl_pyramid_pixels(p, p->first_level) * sizeof(float);
    GSCL_TRY(gscl_buffer_zero(p->context, first, channels * plane, plane));
    for (int i = 0; i < SCALES; i++) {
        int level = i + 1 < p->first_level ? p->first_level : i + 1 > p->last_level ? p->last_level : i + 1;
        float exponent = (float)gscl_ms_ssim_exponents[FIRST_SCALE + i];
        GSCL_TRY(weights_add(p, ssim, options, level, NULL, exponent, first));
    }
    for (int level = p->first_level; level < p->last_level; level++)
        GSCL_TRY(gscl_pyramid_halve(p, level, channels, &p->levels[level], &p->levels[level + 1]));
    return GSCL_OK;
}

/* Raises the contrast of the first level into the adapted planes, by contrast gains at half its size. */
static gscl_result raise_contrast(const gscl_pyramid *p, const gscl_buffer *gains, const gscl_buffer *adapted) {
    int32_t channels = p->channels, width = (int32_t)gscl_pyramid_width(p, p->first_level),
            height = (int32_t)gscl_pyramid_height(p, p->first_level);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_image_kernel(p->context, "raise_contrast", &kernel));
    return GSCL_LAUNCH(p->context, kernel, gscl_groups(gscl_pyramid_pixels(p, p->first_level), GSCL_IMAGE_GROUP),
                       GSCL_IMAGE_GROUP, GSCL_ARG_BUFFER(p->levels[p->first_level]), GSCL_ARG_BUFFER(*gains),
                       GSCL_ARG(channels), GSCL_ARG(width), GSCL_ARG(height), GSCL_ARG_BUFFER(*adapted));
}

/* Halves the rendering into `half`, then writes the adapted planes; `half` and `gains` are scratch. */
static gscl_result adapt_planes(const gscl_pyramid *p, gscl_ssim *ssim, const gscl_kernel_options *options,
                                const gscl_buffer *rendering, gscl_buffer *half, gscl_buffer *gains,
                                gscl_buffer *adapted) {
    int level = p->first_level + 1;
    size_t channels = (size_t)p->channels, plane = gscl_pyramid_pixels(p, p->first_level) * sizeof(float);
    GSCL_TRY(gscl_buffer_reserve_image(p->context, half, gscl_pyramid_pixels(p, level) * channels * sizeof(float)));
    for (size_t k = 0; k < channels; k++)
        GSCL_TRY(gscl_pyramid_halve(p, p->first_level, k, rendering, half));
    GSCL_TRY(gscl_buffer_reserve_image(p->context, adapted, (channels + 1) * plane));
    GSCL_TRY(gscl_buffer_copy(p->context, &p->levels[p->first_level], adapted, channels * plane, plane));
    GSCL_TRY(weights_add(p, ssim, options, level, half, 1.0f, adapted));
    GSCL_TRY(gscl_ssim_contrast_gains(ssim, p->context, options, (int)gscl_pyramid_width(p, level),
                                      (int)gscl_pyramid_height(p, level), gains));
    return raise_contrast(p, gains, adapted);
}

gscl_result gscl_weights_adapt(const gscl_pyramid *p, gscl_ssim *ssim, const gscl_kernel_options *options,
                               const gscl_buffer *rendering, gscl_buffer *adapted) {
    gscl_buffer half = {0}, gains = {0};
    gscl_result result = adapt_planes(p, ssim, options, rendering, &half, &gains, adapted);
    gscl_buffer_free(&half);
    gscl_buffer_free(&gains);
    return result;
}
