#include "scalar/fit_levels.h"

#include <math.h>

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

static double max_quarter_until(const gscl_scalar_state *s) {
    return gscl_scalar_is_launch_bound(s) ? tunables->launch_bound_max_quarter_until : tunables->max_quarter_until;
}

static double max_half_until(const gscl_scalar_state *s) {
    if (!gscl_scalar_is_launch_bound(s))
        return tunables->max_half_until;
    return gscl_fit_has_visual_loss(&s->fit) ? tunables->launch_bound_max_visual_half_until
                                             : tunables->launch_bound_max_half_until;
}

void gscl_scalar_level_ends(const gscl_scalar_state *s, double ends[3]) {
    const double spacing = gscl_scalar_relative_spacing(s);
    ends[2] = fmin(tunables->quarter_until * spacing, max_quarter_until(s));
    ends[1] = fmin(tunables->half_until * spacing, max_half_until(s));
    ends[0] = 1;
}

int gscl_scalar_limited_level(const gscl_scalar_state *s, int level) {
    return level > s->finest ? level : s->finest;
}

int gscl_scalar_level_due(const gscl_scalar_state *s, double fraction) {
    double ends[3];
    gscl_scalar_level_ends(s, ends);
    return s->source->first_level + gscl_scalar_limited_level(s, fraction < ends[2] ? 2 : fraction < ends[1] ? 1 : 0);
}
