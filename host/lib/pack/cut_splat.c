#include "pack/cut_splat.h"

#include <math.h>

#include "runtime/elementary.h"

static const double pi = 3.14159265358979323846;

/* A splat by its moments. */
typedef struct moments {
    double centre[2], variance[2], covariance; /* pixels */
} moments;

static moments moments_of(const gscl_splat *s) {
    const double c = gscl_cos(s->theta), n = gscl_sin(s->theta);
    const double a = (double)s->sigma1 * s->sigma1, b = (double)s->sigma2 * s->sigma2;
    return (moments){.centre = {s->x, s->y},
                     .variance = {c * c * a + n * n * b, n * n * a + c * c * b},
                     .covariance = c * n * (a - b)};
}

/* The part of a normal distribution beyond t standard deviations, over the density there, and over the same for t = 0:
 * 1 for t = 0.  By Boyd's approximation, within 1.2 %. */
static double relative_mills_ratio(double t) {
    return sqrt(2 * pi) / ((pi - 1) * t + sqrt(t * t + 2 * pi));
}

/* Moves the centre to the side that it lies beyond.  Returns by how many standard deviations. */
static double cut_at_side(moments *m, int across, double most) {
    const double side = fmin(fmax(m->centre[across], 0), most), move = side - m->centre[across];
    const double slope = m->covariance / m->variance[across], t = fabs(move) / sqrt(m->variance[across]);
    const double rest = m->variance[!across] - slope * m->covariance, ratio = relative_mills_ratio(t);
    if (move == 0)
        return 0;
    m->centre[across] = side;
    m->centre[!across] += slope * move;
    m->variance[across] *= ratio * ratio;
    m->covariance = slope * m->variance[across];
    m->variance[!across] = rest + slope * m->covariance;
    return t;
}

gscl_cut gscl_cut_at_sides(gscl_splat *splat, const double most[2]) {
    moments m = moments_of(splat);
    const double by_x = cut_at_side(&m, 0, most[0]), by_y = cut_at_side(&m, 1, most[1]);
    const double x = fmin(fmax(m.centre[0], 0), most[0]),
                 y = m.centre[1]; /* along a slanting splat x may have left again */
    splat->wave_phase -= (float)(splat->wave_x * (x - splat->x) + splat->wave_y * (y - splat->y));
    splat->x = (float)x;
    splat->y = (float)y;
    gscl_splat_set_covariance(splat, m.variance[0], m.covariance, m.variance[1]);
    return (gscl_cut){by_x, by_y, gscl_exp(-(by_x * by_x + by_y * by_y) / 2)};
}
