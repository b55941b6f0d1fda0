#include "encode/quality_search.h"

#include <math.h>

#include "runtime/elementary.h"

#define MAX_OCTAVES 3.0   /* by which the size changes at a time */
#define FIRST_OCTAVES 2.5 /* by which the first size differs from that of the mean quality */
#define LEAST_STEP 0.015  /* octaves */

static double limited(double value, double low, double high) {
    return fmin(fmax(value, low), high);
}

/* The measure's scale, on which quality grows by about the same for each doubling of the bytes: quality itself or, where
 * equal images have a finite one, the logarithm of the distance to it.  Equal images have a finite place on it, too. */
static double scale_of(const gscl_quality_tunables *t, double quality) {
    return t->perfect > 0 ? -gscl_log2(fmax(t->perfect - quality, 0.01)) : fmin(quality, 200);
}

/* The scale of a complete encode of this size, as a probe of it predicts. */
static double predicted_scale(const gscl_quality_search *s, double probe_quality) {
    const gscl_quality_tunables *t = s->tunables;
    return t->probe_gain * scale_of(t, probe_quality) + t->probe_octave * gscl_log2(8 * s->bytes / s->pixels) +
           t->probe_offset;
}

/* Octaves of size between two places on the scale, as the slope expects them. */
static double octaves_between(const gscl_quality_search *s, double from, double to, double limit) {
    return limited((to - from) / s->slope, -limit, limit);
}

static double octaves_to(const gscl_quality_search *s, double from_quality, double quality) {
    return octaves_between(s, scale_of(s->tunables, from_quality), scale_of(s->tunables, quality), MAX_OCTAVES);
}

/* Takes the slope between two points, where they are far enough from each other. */
static void learn_slope(gscl_quality_search *s, gscl_quality_point a, gscl_quality_point b) {
    const gscl_quality_tunables *t = s->tunables;
    const double octaves = a.bytes > 0 ? gscl_log2(b.bytes / a.bytes) : 0;
    if (fabs(octaves) < t->slope_octaves)
        return;
    s->slope =
        limited((b.scale - a.scale) / octaves, t->per_doubling / t->slope_range, t->per_doubling * t->slope_range);
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
                             .pixels = pixels,
                             .max_bytes = fmax(floor(pixels * e->max_bpp / 8), e->max_bytes),
                             .is_probe = has_probes,
                             .slope = t->per_doubling,
                             .best_quality = -INFINITY};
    set_size(&s, fmax(e->first_bpp * pixels / 8, e->min_bytes),
             octaves_between(&s, scale_of(t, t->first_quality), scale_of(t, target), FIRST_OCTAVES));
    s.bytes = fmax(s.bytes, e->min_bytes);
    return s;
}

static void add_probe(gscl_quality_search *s, double quality) {
    const gscl_quality_tunables *t = s->tunables;
    const gscl_quality_point probe = {s->bytes, quality, predicted_scale(s, quality)};
    learn_slope(s, s->probe, probe);
    s->probe = probe;
    s->probes++;
    const double octaves = octaves_between(s, probe.scale, scale_of(t, s->target + t->aim), t->probe_reach);
    set_size(s, probe.bytes, octaves);
    const int most = octaves < 0 ? t->max_small_probes : t->max_probes;
    s->is_probe = s->probes < most && fabs(octaves) > t->probe_octaves && s->bytes != probe.bytes;
}

/* The least step where all trials were on one side of the target: it grows, so that a slope that is too large does not keep
 * the search there. */
static double least_step(const gscl_quality_search *s) {
    return fmin(LEAST_STEP * gscl_exp2(2 * (s->trials - 1)), MAX_OCTAVES);
}

/* The next size: where a line through the two known sizes meets the aim, or one size and the slope.  It lies between the
 * known sizes. */
static void choose_size(gscl_quality_search *s) {
    const gscl_quality_tunables *t = s->tunables;
    const double aim = s->target + t->aim;
    const gscl_quality_point low = s->low, high = s->high;
    if (low.bytes > 0 && high.bytes > 0) {
        const double edge =
            fmin(0.1 * gscl_exp2(s->repeats), 0.5); /* towards halves where one side is replaced again */
        const double share = limited((scale_of(t, aim) - low.scale) / (high.scale - low.scale), edge, 1 - edge);
        set_size(s, low.bytes, share * gscl_log2(high.bytes / low.bytes));
        s->bytes = limited(s->bytes, low.bytes + 1, high.bytes - 1);
    } else if (low.bytes > 0) {
        set_size(s, low.bytes, fmax(octaves_to(s, low.quality, aim), least_step(s)));
        s->bytes = limited(s->bytes, low.bytes + 1, s->max_bytes);
    } else {
        set_size(s, high.bytes, fmin(octaves_to(s, high.quality, aim), -least_step(s)));
        s->bytes = limited(s->bytes, 1, high.bytes - 1);
    }
}

/* Whether the best file so far is good enough: near to the target, or little larger than one that is too poor.  Trials
 * beyond the third one make the search less strict, up to twice: then the quality of files of nearly the same size differs. */
static bool is_met(const gscl_quality_search *s) {
    const gscl_quality_tunables *t = s->tunables;
    const double ease = fmin(1 + t->patience * fmax(s->trials - 3, 0), 2);
    const double narrow = s->low.bytes > 0 ? ease * gscl_encode_tunables.narrow_share * s->high.bytes : 0;
    return s->high.bytes > 0 && (s->high.quality <= s->target + ease * t->tolerance ||
                                 s->high.bytes - s->low.bytes <= fmax(gscl_encode_tunables.narrow_bytes, narrow));
}

static bool add_trial(gscl_quality_search *s, double quality, double size) {
    const bool reached = quality >= s->target;
    const gscl_quality_point trial = {reached ? fmin(size, s->bytes) : s->bytes, quality,
                                      scale_of(s->tunables, quality)};
    gscl_quality_point *side = reached ? &s->high : &s->low;
    learn_slope(s, *side, trial);
    s->repeats = s->trials > 0 && reached == s->was_reached ? s->repeats + 1 : 0;
    s->was_reached = reached;
    *side = trial;
    s->best_quality = fmax(s->best_quality, quality);
    s->trials++;
    s->done = is_met(s) || (!reached && s->bytes >= s->max_bytes) || s->trials == gscl_encode_tunables.max_trials;
    if (!s->done)
        choose_size(s);
    return reached;
}

bool gscl_quality_search_add(gscl_quality_search *s, double quality, double size) {
    if (!s->is_probe)
        return add_trial(s, quality, size);
    add_probe(s, quality);
    return false;
}
