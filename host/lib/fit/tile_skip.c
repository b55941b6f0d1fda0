#include "fit/tile_skip.h"

#include "fit/tunables.h"

gscl_result gscl_tile_skip_reset(gscl_tile_skip *s, gscl_context *context, size_t tiles) {
    s->threshold = 0;
    s->step = 0;
    GSCL_TRY(gscl_buffer_reserve(context, &s->skip_until, tiles * sizeof(cl_int)));
    return gscl_buffer_zero(context, &s->skip_until, 0, tiles * sizeof(cl_int));
}

void gscl_tile_skip_set_threshold(gscl_tile_skip *s, double loss, int channels, double non_flat_tiles) {
    s->threshold = (float)(gscl_fit_tunables.skip_threshold * loss * channels / non_flat_tiles);
}

void gscl_tile_skip_free(gscl_tile_skip *s) {
    gscl_buffer_free(&s->skip_until);
}
