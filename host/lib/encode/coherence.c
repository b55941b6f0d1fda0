#include "encode/coherence.h"

#include <math.h>
#include <stdlib.h>

#include "encode/tunables.h"
#include "image/box_sum.h"
#include "runtime/elementary.h"

/* One plane of the image at a level, the mean of all channels. */
typedef struct field {
    int width, height;
    float *values;
} field;

/* The structure tensor, at each pixel: gx gx - gy gy, 2 gx gy and gx gx + gy gy. */
typedef struct tensor {
    float *difference, *mixed, *sum;
} tensor;

static void structure_tensor(const field *f, tensor *t) {
    for (int y = 0; y < f->height; y++)
        for (int x = 0; x < f->width; x++) {
            int left = x ? x - 1 : x, right = x < f->width - 1 ? x + 1 : x;
            int up = y ? y - 1 : y, down = y < f->height - 1 ? y + 1 : y;
            float gx = f->values[y * f->width + right] - f->values[y * f->width + left];
            float gy = f->values[down * f->width + x] - f->values[up * f->width + x];
            size_t at = (size_t)y * (size_t)f->width + (size_t)x;
            t->difference[at] = gx * gx - gy * gy;
            t->mixed[at] = 2 * gx * gy;
            t->sum[at] = gx * gx + gy * gy;
        }
}

/* `planes`: scratch for three planes of the field's size; `line`: for the field's longer side. */
static double coherence_of(const field *f, int radius, float *planes, double *line) {
    size_t pixels = (size_t)f->width * (size_t)f->height;
    tensor t = {planes, planes + pixels, planes + 2 * pixels};
    double directed = 0, all = 0;
    structure_tensor(f, &t);
    for (int i = 0; i < 3; i++)
        gscl_box_sum(planes + (size_t)i * pixels, f->width, f->height, radius, line);
    for (size_t i = 0; i < pixels; i++) {
        directed += gscl_hypot(t.difference[i], t.mixed[i]);
        all += t.sum[i];
    }
    return all > 0 ? directed / all : 0;
}

gscl_result gscl_edge_coherence(gscl_context *context, const gscl_image *image, int level, double splats,
                                double *coherence) {
    field f = {(int)gscl_level_size(image->width, level), (int)gscl_level_size(image->height, level), NULL};
    const size_t pixels = (size_t)f.width * (size_t)f.height,
                 longer = (size_t)(f.width > f.height ? f.width : f.height);
    const double distance = sqrt((double)pixels / fmax(splats, 1));
    float *planes = malloc(4 * pixels * sizeof *planes);
    double *line = malloc(longer * sizeof *line);
    const bool has_memory = planes && line;
    if (has_memory) {
        f.values = planes + 3 * pixels;
        gscl_image_to_planes(image, 1, false, level, f.values);
        *coherence = coherence_of(&f, (int)rint(gscl_encode_tunables.coherence_window * distance) + 1, planes, line);
    }
    free(planes);
    free(line);
    return has_memory ? GSCL_OK : gscl_fail_memory(context);
}
