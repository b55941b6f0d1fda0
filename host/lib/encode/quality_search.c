#include "encode/quality_search.h"

#include <math.h>

#include "runtime/elementary.h"

#define MAX_OCTAVES 3.0  /* by which the size changes at a time */
#define LEAST_STEP 0.015 /* octaves */

static double limited(double value, double low, double high) {
    return fmin(fmax(value, low), high);
}

/* The measure's scale, on which quality grows by about the same for each doubling of the bytes: quality itself or, where
 * equal images have a finite one, the logarithm of the distance to it.  Equal images have a finite place on it, too. */
static double scale_of(const gscl_quality_tunables *t, double quality) {
    return t->perfect > 0 ? -gscl_log2(fmax(t->perfect - quality, 0.01)) : fmin(quality, 200);
}

/* Octaves of size between two places on the scale, as the slope expects them. */
static double octaves_between(const gscl_quality_search *s, double from, double to) {
    return limited((to - from) / s->slope, -MAX_OCTAVES, MAX_OCTAVES);
}

static double octaves_to(const gscl_quality_search *s, double from_quality, double quality) {
    return octaves_between(s, scale_of(s->tunables, from_quality), scale_of(s->tunables, quality));
}

/* Takes the slope between two points, where they are far enough from each other. */
static void learn_slope(gscl_quality_search *s, gscl_quality_point a, gscl_quality_point b) {
    const gscl_quality_tunables *t = s->tunables;
    const double octaves = a.bytes > 0 && b.bytes > 0 ? gscl_log2(b.bytes / a.bytes) : 0;
    if (fabs(octaves) < t->slope_octaves)
        return;
    const double slope = (scale_of(t, b.quality) - scale_of(t, a.quality)) / octaves;
    s->slope = limited(slope, t->per_doubling / t->slope_range, t->per_doubling * t->slope_range);
}

/* Sets the next size, this many octaves from another. */
static void set_size(gscl_quality_search *s, double from_bytes, double octaves) {
    s->bytes = limited(floor(from_bytes * gscl_exp2(octaves)), 1, s->max_bytes);
}

gscl_quality_search gscl_quality_search_begin(const gscl_quality_tunables *t, double target, double pixels,
                                              bool has_probes) {
    const struct gscl_encode_tunables *e = &gscl_encode_tunables;
    gscl_quality_search s = {.tunables = t,
                             .target = target,
                             .max_bytes = fmax(floor(pixels * e->max_bpp / 8), e->max_bytes),
                             .is_probe = has_probes,
                             .slope = has_probes ? t->per_doubling / t->probe_slope : t->per_doubling,
                             .best_quality = -INFINITY};
    set_size(&s, fmax(e->first_bpp * pixels / 8, e->min_bytes), octaves_to(&s, t->first_quality, target));
    s.bytes = fmax(s.bytes, e->min_bytes);
    return s;
}

static void add_probe(gscl_quality_search *s, double quality) {
    const gscl_quality_tunables *t = s->tunables;
    const gscl_quality_point probe = {s->bytes, quality};
    learn_slope(s, s->probe, probe);
    s->probe = probe;
    s->probes++;
    const double sought = (scale_of(t, s->target + t->aim) - t->probe_offset) / t->probe_gain;
    const double octaves = octaves_between(s, scale_of(t, quality), sought);
    set_size(s, probe.bytes, octaves);
    s->is_probe = s->probes < t->max_probes && fabs(octaves) > t->probe_octaves && s->bytes != probe.bytes;
    if (!s->is_probe)
        s->slope *= t->probe_slope;
}

/* The next size: where a line through the two known sizes meets the aim, or one size and the slope. */
static void choose_size(gscl_quality_search *s) {
    const gscl_quality_tunables *t = s->tunables;
    const double aim = s->target + t->aim;
    const gscl_quality_point low = s->low, high = s->high;
    if (low.bytes > 0 && high.bytes > 0) {
        const double from = scale_of(t, low.quality), to = scale_of(t, high.quality);
        const double share = limited((scale_of(t, aim) - from) / (to - from), 0.1, 0.9);
        set_size(s, low.bytes, share * gscl_log2(high.bytes / low.bytes));
    } else if (low.bytes > 0) {
        set_size(s, low.bytes, fmax(octaves_to(s, low.quality, aim), LEAST_STEP));
    } else {
        set_size(s, high.bytes, fmin(octaves_to(s, high.quality, aim), -LEAST_STEP));
    }
}

/* Whether the sizes between the two known ones differ too little to be tried. */
static bool is_narrow(const gscl_quality_search *s) {
    const double gap = s->high.bytes - s->low.bytes;
    return s->high.bytes > 0 && gap <= fmax(gscl_encode_tunables.narrow_bytes,
                                            s->low.bytes > 0 ? gscl_encode_tunables.narrow_share * s->high.bytes : 0);
}

static bool add_trial(gscl_quality_search *s, double quality) {
    const bool reached = quality >= s->target;
    const gscl_quality_point trial = {s->bytes, quality};
    gscl_quality_point *side = reached ? &s->high : &s->low;
    learn_slope(s, *side, trial);
    *side = trial;
    s->best_quality = fmax(s->best_quality, quality);
    s->trials++;
    s->done = (reached ? quality <= s->target + s->tunables->tolerance : s->bytes >= s->max_bytes) || is_narrow(s) ||
              s->trials == gscl_encode_tunables.max_trials;
    if (!s->done)
        choose_size(s);
    return reached;
}

bool gscl_quality_search_add(gscl_quality_search *s, double quality) {
    if (!s->is_probe)
        return add_trial(s, quality);
    add_probe(s, quality);
    return false;
}
