#include "fit/pyramid.h"

#include "cl/constants.h"
#include "decode/renderer.h"
#include "fit/tunables.h"
#include "image/image.h"

uint32_t gscl_pyramid_width(const gscl_pyramid *p, int level) {
    return gscl_level_size(p->width, level);
}
uint32_t gscl_pyramid_height(const gscl_pyramid *p, int level) {
    return gscl_level_size(p->height, level);
}
size_t gscl_pyramid_pixels(const gscl_pyramid *p, int level) {
    return (size_t)gscl_pyramid_width(p, level) * gscl_pyramid_height(p, level);
}

gscl_result gscl_image_kernel(gscl_context *context, const char *name, gscl_kernel **kernel) {
    static const gscl_kernel_options none;
    return gscl_kernel_find(context, GSCL_PROGRAM_IMAGE, &none, name, kernel);
}

gscl_result gscl_pyramid_halve(const gscl_pyramid *p, int level, size_t channel, const gscl_buffer *from,
                               const gscl_buffer *to) {
    gscl_kernel *kernel;
    GSCL_TRY(gscl_image_kernel(p->context, "halve", &kernel));
    int32_t from_width = (int32_t)gscl_pyramid_width(p, level), from_height = (int32_t)gscl_pyramid_height(p, level);
    int32_t width = (int32_t)gscl_pyramid_width(p, level + 1), height = (int32_t)gscl_pyramid_height(p, level + 1);
    size_t pixels = gscl_pyramid_pixels(p, level + 1);
    uint64_t from_at = channel * gscl_pyramid_pixels(p, level), to_at = channel * pixels;
    return GSCL_LAUNCH(p->context, kernel, gscl_groups(pixels, GSCL_IMAGE_GROUP), GSCL_IMAGE_GROUP,
                       GSCL_ARG_BUFFER(*from), GSCL_ARG(from_at), GSCL_ARG(from_width), GSCL_ARG(from_height),
                       GSCL_ARG_BUFFER(*to), GSCL_ARG(to_at), GSCL_ARG(width), GSCL_ARG(height));
}

/* Makes room for a level and its weights. */
static gscl_result reserve_level(gscl_pyramid *p, int level) {
    const size_t plane = gscl_pyramid_pixels(p, level) * sizeof(float), channels = (size_t)p->channels;
    const size_t weights = (size_t)p->weighted; /* their planes */
    GSCL_TRY(gscl_buffer_reserve_image(p->context, &p->levels[level], (channels + weights) * plane));
    if (p->weighted != GSCL_WEIGHTED_LUMA)
        return GSCL_OK;
    return gscl_buffer_zero(p->context, &p->levels[level], channels * plane, weights * plane);
}

/* Makes a level from the next larger one. */
static gscl_result pyramid_make_level(gscl_pyramid *p, int level) {
    GSCL_TRY(reserve_level(p, level));
    for (size_t k = 0; k < (size_t)p->channels; k++)
        GSCL_TRY(gscl_pyramid_halve(p, level - 1, k, &p->levels[level - 1], &p->levels[level]));
    return GSCL_OK;
}

gscl_result gscl_pyramid_create(gscl_pyramid *p, gscl_context *context, uint32_t width, uint32_t height,
                                int first_level, int channels, int weighted, const float *planes) {
    p->context = context;
    p->width = width;
    p->height = height;
    p->first_level = p->last_level = first_level;
    p->channels = channels;
    p->weighted = weighted;
    GSCL_TRY(reserve_level(p, first_level));
    GSCL_TRY(gscl_buffer_write(context, &p->levels[first_level], 0, planes,
                               gscl_pyramid_pixels(p, first_level) * (size_t)channels * sizeof(float)));
    uint32_t shorter = width < height ? width : height, min_side = (uint32_t)gscl_fit_tunables.min_level_side;
    while (p->last_level + 1 < GSCL_MAX_LEVELS && gscl_level_size(shorter, p->last_level + 1) >= min_side)
        GSCL_TRY(pyramid_make_level(p, ++p->last_level));
    return GSCL_OK;
}

void gscl_pyramid_release_smaller(gscl_pyramid *p, int level) {
    if (p->weighted == GSCL_WEIGHTED_PIXELS)
        return;
    for (int i = level + 1; i <= p->last_level; i++)
        gscl_buffer_free(&p->levels[i]);
}

gscl_result gscl_pyramid_restore(gscl_pyramid *p, int level) {
    int larger = level;
    while (!p->levels[larger].memory) /* the first level is never released */
        larger--;
    while (larger < level)
        GSCL_TRY(pyramid_make_level(p, ++larger));
    return GSCL_OK;
}

void gscl_pyramid_free(gscl_pyramid *p) {
    for (int i = 0; i < GSCL_MAX_LEVELS; i++)
        gscl_buffer_free(&p->levels[i]);
}
