#include "scalar/fit_levels.h"

#include <math.h>

static const struct gscl_scalar_tunables *const tunables = &gscl_scalar_tunables;

void gscl_scalar_level_ends(const gscl_scalar_state *s, double ends[3]) {
    const double spacing = gscl_scalar_relative_spacing(s);
    const bool is_launch_bound = gscl_scalar_is_launch_bound(s);
    ends[2] = fmin(tunables->quarter_until * spacing,
                   is_launch_bound ? tunables->launch_bound_max_quarter_until : tunables->max_quarter_until);
    ends[1] = fmin(tunables->half_until * spacing,
                   is_launch_bound ? tunables->launch_bound_max_half_until : tunables->max_half_until);
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
