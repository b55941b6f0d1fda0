/* What a level of the pyramid shows that the next smaller one does not. */
#include <stdlib.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "image/image.h"

#define BLOCK (GSCL_TILE / 2) /* pixels of the smaller level: a tile of the larger one */
#define LEFT_OUT 0.01         /* of the blocks, those that show most: small things count, the odd speck does not */

static int compare_floats(const void *a, const void *b) {
    const float *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* Means of a map's blocks; returns how many there are. */
static size_t block_means(const float *map, size_t width, size_t height, float *means) {
    size_t count = 0;
    for (size_t top = 0; top < height; top += BLOCK)
        for (size_t left = 0; left < width; left += BLOCK) {
            size_t bottom = top + BLOCK < height ? top + BLOCK : height;
            size_t right = left + BLOCK < width ? left + BLOCK : width;
            double sum = 0;
            for (size_t y = top; y < bottom; y++)
                for (size_t x = left; x < right; x++)
                    sum += map[y * width + x];
            means[count++] = (float)(sum / (double)((bottom - top) * (right - left)));
        }
    return count;
}

/* Per pixel of the next smaller level, into `map`. */
static gscl_result read_map(gscl_fit *f, int level, float *map) {
    cl_kernel kernel;
    cl_int width = (cl_int)gscl_level_size(f->width, level), height = (cl_int)gscl_level_size(f->height, level);
    cl_int channels = f->renderer.channels;
    size_t pixels = gscl_fit_level_pixels(f, level + 1);
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->error, pixels * sizeof(float)));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_IMAGE, &f->renderer.options, "detail", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, gscl_groups(pixels, 64), 64, GSCL_ARG_BUFFER(f->levels[level]),
                         GSCL_ARG_BUFFER(f->levels[level + 1]), GSCL_ARG(channels), GSCL_ARG(width), GSCL_ARG(height),
                         GSCL_ARG_BUFFER(f->error)));
    return gscl_buffer_read(f->context, &f->error, 0, map, pixels * sizeof(float));
}

gscl_result gscl_fit_level_residual(gscl_fit *f, int level, double *detail) {
    size_t width = gscl_level_size(f->width, level + 1), height = gscl_level_size(f->height, level + 1);
    float *map = malloc(2 * width * height * sizeof *map);
    if (!map)
        return gscl_fail_memory(f->context);
    gscl_result result = read_map(f, level, map);
    if (result == GSCL_OK) {
        float *means = map + width * height;
        size_t count = block_means(map, width, height, means);
        qsort(means, count, sizeof *means, compare_floats);
        *detail = means[count - 1 - (size_t)(LEFT_OUT * (double)count)];
    }
    free(map);
    return result;
}
