#include "scalar/search_plan.h"

#include <math.h>

#include "scalar/tunables.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

/* The coarsest level with `pixels` pixels; 0 where none has them. */
static int coarsest_level(double source_pixels, double pixels) {
    int level = 0;
    while (ldexp(source_pixels, -2 * (level + 1)) >= pixels)
        level++;
    return level;
}

int gscl_search_level(double source_pixels, size_t splats) {
    const double distance = tunables->search_distance;
    return coarsest_level(source_pixels, fmax(tunables->search_pixels, (double)splats * distance * distance));
}

int gscl_search_final_level(double source_pixels, int level, bool waves) {
    const double pixels = waves ? tunables->search_wave_pixels : tunables->search_final_pixels;
    const int final = coarsest_level(source_pixels, pixels);
    return final < level ? final : level;
}

int gscl_search_rounds(double source_pixels, int level, int rounds) {
    return (int)ceil(rounds * fmin(1, tunables->search_pixels / ldexp(source_pixels, -2 * level)));
}
