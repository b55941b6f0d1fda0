#include "image/box_sum.h"

#include <stddef.h>

/* Replaces the values of one line, which are `stride` apart, by their window sums. */
static void sum_line(float *line, size_t stride, int n, int radius, double *sums) {
    double total = 0;
    for (int i = 0; i < n; i++)
        sums[i] = total += line[(size_t)i * stride];
    for (int i = 0; i < n; i++) {
        int high = i + radius < n ? i + radius : n - 1, low = i - radius - 1;
        line[(size_t)i * stride] = (float)(sums[high] - (low >= 0 ? sums[low] : 0.0));
    }
}

void gscl_box_sum(float *map, int width, int height, int radius, double *scratch) {
    for (int y = 0; y < height; y++)
        sum_line(map + (size_t)y * (size_t)width, 1, width, radius, scratch);
    for (int x = 0; x < width; x++)
        sum_line(map + x, (size_t)width, height, radius, scratch);
}
