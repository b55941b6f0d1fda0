#include "encode/psnr_search.h"

#include <math.h>

#include "encode/tunables.h"
#include "runtime/elementary.h"

gscl_psnr_search gscl_psnr_search_begin(double target, double pixels) {
    const struct gscl_encode_tunables *t = &gscl_encode_tunables;
    return (gscl_psnr_search){.target = target,
                              .max_bytes = fmax(pixels * t->max_bpp / 8, t->max_bytes),
                              .bytes = fmax(t->first_bpp * pixels / 8, t->min_bytes)};
}

/* The size at which a line through the two known sizes (PSNR against log size) meets the middle of the target band. */
static double next_size(const gscl_psnr_search *s) {
    const double aim = s->target + gscl_encode_tunables.tolerance_db / 3;
    const double db_per_doubling = gscl_encode_tunables.db_per_doubling;
    double bytes;
    if (s->low_bytes > 0 && s->high_bytes > 0) {
        double t = (aim - s->low_db) / (s->high_db - s->low_db);
        t = fmin(fmax(t, 0.1), 0.9);
        bytes = s->low_bytes * gscl_pow(s->high_bytes / s->low_bytes, t);
    } else if (s->low_bytes > 0) {
        bytes = s->low_bytes * fmin(gscl_exp2((aim - s->low_db) / db_per_doubling + 0.1), 8);
    } else {
        bytes = s->high_bytes * fmax(gscl_exp2((aim - s->high_db) / db_per_doubling - 0.1), 0.1);
    }
    return floor(fmin(bytes, s->max_bytes));
}

bool gscl_psnr_search_add(gscl_psnr_search *s, double psnr) {
    const bool reached = psnr >= s->target;
    if (reached) {
        s->high_bytes = s->bytes;
        s->high_db = psnr;
        s->done = psnr <= s->target + gscl_encode_tunables.tolerance_db;
    } else {
        s->low_bytes = s->bytes;
        s->low_db = psnr;
        s->done = s->bytes >= s->max_bytes;
    }
    const bool is_narrow = s->high_bytes > 0 && s->high_bytes - s->low_bytes < 4;
    s->trials++;
    s->done = s->done || is_narrow || s->trials == gscl_encode_tunables.max_trials;
    if (!s->done)
        s->bytes = next_size(s);
    return reached;
}
