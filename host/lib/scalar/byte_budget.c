#include "scalar/byte_budget.h"

#include <math.h>
#include <string.h>

#include "scalar/choose_codes.h"
#include "scalar/kept_codes.h"

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

static bool has_slack(const gscl_scalar_state *s, double share) {
    return (double)s->size < share * (double)s->bytes;
}

/* Uses bytes that are left: a few for finer codes and more textures, many for more splats, as long as the fit stands it. */
static gscl_result use_slack(gscl_scalar_state *s) {
    bool may_add = true;
    for (int pass = 0; pass < tunables->max_slack_passes && has_slack(s, tunables->full_share); pass++) {
        s->keep_all = true; /* new splats would be the first to be dropped */
        if (may_add && !gscl_scalar_has_max_splats(s) && has_slack(s, tunables->densify_below)) {
            s->lambda_scale = fmin(s->lambda_scale, 1);
            s->surplus = 1;
            /* New splats are far from their best after a single pass, and here none follow. */
            GSCL_TRY(gscl_scalar_densify(s, 2, s->textures, &may_add));
        } else {
            s->lambda_scale = fmax(s->lambda_scale * tunables->slack_factor, tunables->min_lambda_scale);
            GSCL_TRY(gscl_scalar_pass(s, s->textures));
        }
    }
    s->keep_all = false;
    return GSCL_OK;
}

/* One pass of a file that is too large.  A pass that shrinks it too far is undone, and lambda is lowered. */
static gscl_result shrink_once(gscl_scalar_state *s, double min_share, gscl_kept_codes *kept) {
    const size_t before = s->size;
    GSCL_TRY(gscl_kept_codes_keep(kept, s, NAN));
    GSCL_TRY(gscl_scalar_pass(s, false));
    if (s->size > s->bytes) {
        gscl_scalar_update_lambda(s, before, (double)s->bytes * tunables->budget_aim, tunables->final_lambda_gain);
    } else if (has_slack(s, min_share)) {
        s->lambda_scale *= tunables->rollback_factor;
        GSCL_TRY(gscl_kept_codes_restore(kept, s));
    }
    return GSCL_OK;
}

static gscl_result shrink_to_budget(gscl_scalar_state *s) {
    const int passes = tunables->max_final_passes;
    gscl_kept_codes kept = {0};
    gscl_result result = GSCL_OK;
    for (int pass = 0; pass < passes && result == GSCL_OK && s->size > s->bytes; pass++)
        result = shrink_once(s, pass < passes - 1 ? tunables->full_share : tunables->densify_below, &kept);
    gscl_kept_codes_free(&kept);
    return result;
}

gscl_result gscl_scalar_meet_budget(gscl_scalar_state *s) {
    if (s->bytes == 0)
        return GSCL_OK;
    GSCL_TRY(use_slack(s));
    return shrink_to_budget(s);
}

static void drop_smallest(gsf_coded_image *file, size_t fixed) {
    size_t smallest = fixed, count = file->header.splat_count;
    for (size_t i = fixed + 1; i < count; i++)
        if (2 * file->splats[i].major - file->splats[i].aspect <
            2 * file->splats[smallest].major - file->splats[smallest].aspect)
            smallest = i;
    memmove(&file->splats[smallest], &file->splats[smallest + 1], (count - 1 - smallest) * sizeof file->splats[0]);
    file->header.splat_count--;
}

gscl_result gscl_scalar_trim(gscl_scalar_state *s) {
    gsf_coded_image *file = &s->coded->file;
    if (s->bytes == 0)
        return GSCL_OK;
    GSCL_TRY(gscl_scalar_update_size(s));
    while (s->size > s->bytes && file->header.splat_count > s->fixed_count) {
        for (size_t excess = (s->size - s->bytes) / 5 + 1; excess > 0 && file->header.splat_count > s->fixed_count;
             excess--)
            drop_smallest(file, s->fixed_count);
        GSCL_TRY(gscl_file_size(s->encoder->context, s->coded, &s->size));
    }
    return GSCL_OK;
}
