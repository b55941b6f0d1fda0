#include "image/synthetic_image.h"

#include <math.h>
#include <stdlib.h>

#define LEAVES 4000
#define MIN_RADIUS 3.0 /* pixels; the density of radii falls with their third power */
#define MAX_RADIUS 200.0

typedef struct leaf {
    double x, y, radius;
    double colour[3], slope_x[3], slope_y[3]; /* slopes of the colour, per radius */
} leaf;

static double random_unit(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 40) / (double)(1 << 24);
}

static leaf random_leaf(uint64_t *random, uint32_t width, uint32_t height) {
    const double share = random_unit(random), small = 1 / (MIN_RADIUS * MIN_RADIUS),
                 large = 1 / (MAX_RADIUS * MAX_RADIUS);
    leaf l = {.x = random_unit(random) * width, .y = random_unit(random) * height};
    l.radius = 1 / sqrt(large + share * (small - large));
    const double grey = random_unit(random);
    for (int k = 0; k < 3; k++) {
        l.colour[k] = 255 * (0.75 * grey + 0.25 * random_unit(random));
        l.slope_x[k] = 60 * (random_unit(random) - 0.5);
        l.slope_y[k] = 60 * (random_unit(random) - 0.5);
    }
    return l;
}

static void draw_leaf(const leaf *l, gscl_image *image) {
    uint8_t *pixels = image->pixels;
    const int x0 = (int)fmax(l->x - l->radius, 0), x1 = (int)fmin(l->x + l->radius + 1, image->width);
    const int y0 = (int)fmax(l->y - l->radius, 0), y1 = (int)fmin(l->y + l->radius + 1, image->height);
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            const double dx = (x + 0.5 - l->x) / l->radius, dy = (y + 0.5 - l->y) / l->radius;
            if (dx * dx + dy * dy > 1)
                continue;
            for (int k = 0; k < 3; k++)
                pixels[3 * ((size_t)y * image->width + (size_t)x) + (size_t)k] =
                    (uint8_t)fmin(fmax(l->colour[k] + dx * l->slope_x[k] + dy * l->slope_y[k], 0), 255);
        }
}

bool synthetic_image_make(gscl_image *image, uint32_t width, uint32_t height) {
    uint64_t random = 1;
    *image = (gscl_image){.width = width, .height = height, .channels = 3, .sample = GSCL_SAMPLE_U8};
    image->pixels = calloc((size_t)width * height, 3);
    if (!image->pixels)
        return false;
    for (int i = 0; i < LEAVES; i++) {
        const leaf l = random_leaf(&random, width, height);
        draw_leaf(&l, image);
    }
    return true;
}
