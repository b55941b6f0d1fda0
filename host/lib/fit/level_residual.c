#include <stdlib.h>

#include "cl/constants.h"
#include "decode/renderer.h"
#include "fit/fit.h"
#include "fit/tunables.h"

#define BLOCK (GSCL_TILE / 2) /* pixels of the smaller level: a tile of the larger one */

static int compare_floats(const void *a, const void *b) {
    const float *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

static double block_mean(const float *map, size_t width, size_t left, size_t top, size_t right, size_t bottom) {
    double sum = 0;
    for (size_t y = top; y < bottom; y++)
        for (size_t x = left; x < right; x++)
            sum += map[y * width + x];
    return sum / (double)((bottom - top) * (right - left));
}

/* Writes the means of a map's blocks; returns how many there are. */
static size_t block_means(const float *map, size_t width, size_t height, float *means) {
    size_t count = 0;
    for (size_t top = 0; top < height; top += BLOCK)
        for (size_t left = 0; left < width; left += BLOCK) {
            size_t bottom = top + BLOCK < height ? top + BLOCK : height;
            size_t right = left + BLOCK < width ? left + BLOCK : width;
            means[count++] = (float)block_mean(map, width, left, top, right, bottom);
        }
    return count;
}

gscl_result gscl_fit_begin_level_residual(gscl_fit *f, int level, float **map) {
    const gscl_pyramid *p = &f->pyramid;
    const int32_t width = (int32_t)gscl_pyramid_width(p, level), height = (int32_t)gscl_pyramid_height(p, level);
    const int32_t channels = p->channels;
    const size_t pixels = gscl_pyramid_pixels(p, level + 1);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->error, pixels * sizeof(float)));
    GSCL_TRY(gscl_image_kernel(f->context, "level_residual", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, gscl_groups(pixels, GSCL_IMAGE_GROUP), GSCL_IMAGE_GROUP,
                         GSCL_ARG_BUFFER(p->levels[level]), GSCL_ARG_BUFFER(p->levels[level + 1]), GSCL_ARG(channels),
                         GSCL_ARG(width), GSCL_ARG(height), GSCL_ARG_BUFFER(f->error)));
    *map = malloc(2 * pixels * sizeof **map); /* and the means */
    return *map ? gscl_buffer_read_async(f->context, &f->error, *map, pixels * sizeof(float))
                : gscl_fail_memory(f->context);
}

double gscl_fit_level_residual(const gscl_fit *f, int level, float *map) {
    const size_t width = gscl_pyramid_width(&f->pyramid, level + 1);
    const size_t height = gscl_pyramid_height(&f->pyramid, level + 1);
    float *means = map + width * height;
    const size_t count = block_means(map, width, height, means);
    qsort(means, count, sizeof *means, compare_floats);
    return means[count - 1 - (size_t)(gscl_fit_tunables.residual_outliers * (double)count)];
}
