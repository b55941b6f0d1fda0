#include "fit/tile_skip.h"

#include <stddef.h>

#include "fit/tunables.h"

gscl_result gscl_tile_skip_reset(gscl_tile_skip *s, gscl_context *context, size_t tiles, const gscl_buffer *control) {
    s->step = 0;
    GSCL_TRY(gscl_buffer_reserve(context, &s->skip_until, tiles * sizeof(int32_t)));
    GSCL_TRY(gscl_buffer_zero(context, &s->skip_until, 0, tiles * sizeof(int32_t)));
    return gscl_buffer_zero(context, control, offsetof(gscl_fit_control, skip_threshold), sizeof(float));
}

float gscl_tile_skip_share(int channels, double non_flat_tiles) {
    return (float)(gscl_fit_tunables.skip_threshold * channels / non_flat_tiles);
}

void gscl_tile_skip_free(gscl_tile_skip *s) {
    gscl_buffer_free(&s->skip_until);
}
