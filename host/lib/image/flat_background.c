#include "image/flat_background.h"

#include <math.h>
#include <stdlib.h>

#include "cl/constants.h"
#include "image/tunables.h"

static size_t bin_of(const float *planes, size_t pixels, int channels, size_t at) {
    const int bits = gscl_image_tunables.histogram_bits;
    size_t bin = 0;
    for (int k = 0; k < channels; k++) {
        float v = planes[(size_t)k * pixels + at];
        v = v < 0.0f ? 0.0f : v > 1.0f ? 1.0f : v;
        bin = bin << bits | (size_t)(v * ((float)(1 << bits) - 0.01f));
    }
    return bin;
}

/* Whether pixel `at` has the colour; `pixels`: number of pixels of a plane. */
static bool has_colour(const float *planes, size_t pixels, int channels, const float colour[4], size_t at) {
    for (int k = 0; k < channels; k++)
        if (fabsf(planes[(size_t)k * pixels + at] - colour[k]) > gscl_image_tunables.colour_tolerance)
            return false;
    return true;
}

/* The fullest bin of the histogram, most of which is the flat background if there is one.  `members`: the pixels in it.
 * False: out of memory. */
static bool find_fullest_bin(const float *planes, size_t pixels, int channels, size_t *fullest, size_t *members) {
    const size_t bins = (size_t)1 << (gscl_image_tunables.histogram_bits * channels);
    uint32_t *counts = calloc(bins, sizeof *counts);
    if (!counts)
        return false;
    for (size_t i = 0; i < pixels; i++)
        counts[bin_of(planes, pixels, channels, i)]++;
    *fullest = 0;
    for (size_t b = 1; b < bins; b++)
        *fullest = counts[b] > counts[*fullest] ? b : *fullest;
    *members = counts[*fullest];
    free(counts);
    return true;
}

/* The mean colour of the pixels in a bin of the histogram. */
static void find_mean_colour(const float *planes, size_t pixels, int channels, size_t bin, float colour[4]) {
    double sums[4] = {0};
    size_t members = 0;
    for (size_t i = 0; i < pixels; i++) {
        if (bin_of(planes, pixels, channels, i) != bin)
            continue;
        members++;
        for (int k = 0; k < channels; k++)
            sums[k] += planes[(size_t)k * pixels + i];
    }
    for (int k = 0; k < channels; k++)
        colour[k] = (float)(sums[k] / (double)members);
}

/* The share of the tiles in which all pixels have this colour. */
static double flat_tiles(const float *planes, size_t width, size_t height, int channels, const float colour[4]) {
    size_t tiles = 0, flat_count = 0;
    for (size_t top = 0; top < height; top += GSCL_TILE)
        for (size_t left = 0; left < width; left += GSCL_TILE) {
            size_t bottom = top + GSCL_TILE < height ? top + GSCL_TILE : height;
            size_t right = left + GSCL_TILE < width ? left + GSCL_TILE : width;
            bool same = true;
            for (size_t y = top; y < bottom && same; y++)
                for (size_t x = left; x < right && same; x++)
                    same = has_colour(planes, width * height, channels, colour, y * width + x);
            tiles++;
            flat_count += same;
        }
    return (double)flat_count / (double)tiles;
}

bool gscl_find_flat_background(const float *planes, uint32_t width, uint32_t height, int channels,
                               gscl_flat_background *flat) {
    size_t pixels = (size_t)width * height, bin, members, same = 0;
    *flat = (gscl_flat_background){.pixels = 0};
    if (!find_fullest_bin(planes, pixels, channels, &bin, &members))
        return false;
    if ((double)members < gscl_image_tunables.min_background * (double)pixels)
        return true;
    find_mean_colour(planes, pixels, channels, bin, flat->colour);
    for (size_t i = 0; i < pixels; i++)
        same += has_colour(planes, pixels, channels, flat->colour, i);
    if ((double)same < gscl_image_tunables.min_background * (double)pixels)
        return true;
    flat->pixels = (double)same / (double)pixels;
    flat->tiles = flat_tiles(planes, width, height, channels, flat->colour);
    return true;
}

double gscl_background_share_of_non_flat_tiles(const gscl_flat_background *flat) {
    return flat->tiles < 1 ? (flat->pixels - flat->tiles) / (1 - flat->tiles) : 0;
}
