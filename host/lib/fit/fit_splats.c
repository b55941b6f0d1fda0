#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "fit/fit.h"

#define ROW (GSCL_PARAMS * sizeof(float)) /* bytes of a splat's parameters */

/* Makes room for `count` splats, keeping the optimiser's state. */
static gscl_result splats_reserve(gscl_fit *f, size_t count) {
    if (count <= f->capacity)
        return GSCL_OK;
    count = gscl_room_for_splats(count + count / 4);
    size_t used = (size_t)f->renderer.count;
    GSCL_TRY(gscl_renderer_reserve(&f->renderer, count));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->gradients, count * ROW));
    GSCL_TRY(gscl_buffer_zero(f->context, &f->gradients, 0, count * ROW)); /* kernels write fitted parameters only */
    GSCL_TRY(gscl_buffer_grow(f->context, &f->first_moment, count * ROW, used * ROW));
    GSCL_TRY(gscl_buffer_grow(f->context, &f->second_moment, count * ROW, used * ROW));
    GSCL_TRY(gscl_buffer_grow(f->context, &f->ages, count * sizeof(int32_t), used * sizeof(int32_t)));
    f->capacity = count;
    return GSCL_OK;
}

gscl_result gscl_fit_begin_append(gscl_fit *f, size_t count) {
    GSCL_TRY(splats_reserve(f, (size_t)f->renderer.count + count));
    return gscl_fit_expect_splats(f, count);
}

gscl_result gscl_fit_end_append(gscl_fit *f, size_t count) {
    gscl_renderer *r = &f->renderer;
    const size_t used = (size_t)r->count;
    GSCL_TRY(gscl_buffer_zero(f->context, &f->first_moment, used * ROW, count * ROW));
    GSCL_TRY(gscl_buffer_zero(f->context, &f->second_moment, used * ROW, count * ROW));
    GSCL_TRY(gscl_buffer_zero(f->context, &f->ages, used * sizeof(int32_t), count * sizeof(int32_t)));
    r->count += (int32_t)count;
    f->has_old_lists = true;
    /* The losses of the tiles were those of other splats. */
    GSCL_TRY(gscl_tile_skip_reset(&f->skip, f->context, gscl_renderer_tiles(r), &f->control));
    return gscl_renderer_project(r);
}

gscl_result gscl_fit_append(gscl_fit *f, const float *params, size_t count) {
    gscl_renderer *r = &f->renderer;
    GSCL_TRY(gscl_fit_begin_append(f, count));
    GSCL_TRY(gscl_buffer_write_staged(f->context, &r->staged_params, &r->params, (size_t)r->count * ROW, params,
                                      count * ROW));
    return gscl_fit_end_append(f, count);
}

gscl_result gscl_fit_replace(gscl_fit *f, const float *params, size_t count, const float *background) {
    GSCL_TRY(gscl_renderer_set_background(&f->renderer, background));
    f->renderer.count = 0;
    f->has_known_lengths = false;
    return gscl_fit_append(f, params, count);
}

/* Permutes the rows of a buffer on the host. */
static gscl_result reorder_rows(gscl_fit *f, const gscl_buffer *buffer, size_t row, const size_t *order, size_t kept) {
    size_t count = (size_t)f->renderer.count;
    unsigned char *from = malloc((count + kept) * row + 1), *to = from + count * row;
    if (!from)
        return gscl_fail_memory(f->context);
    gscl_result result = gscl_buffer_read(f->context, buffer, 0, from, count * row);
    for (size_t i = 0; i < kept && result == GSCL_OK; i++)
        memcpy(to + i * row, from + order[i] * row, row);
    if (result == GSCL_OK)
        result = gscl_buffer_write(f->context, buffer, 0, to, kept * row);
    free(from);
    return result;
}

gscl_result gscl_fit_reorder(gscl_fit *f, const size_t *order, size_t kept) {
    GSCL_TRY(reorder_rows(f, &f->renderer.params, ROW, order, kept));
    GSCL_TRY(reorder_rows(f, &f->first_moment, ROW, order, kept));
    GSCL_TRY(reorder_rows(f, &f->second_moment, ROW, order, kept));
    GSCL_TRY(reorder_rows(f, &f->ages, sizeof(int32_t), order, kept));
    if (kept < (size_t)f->renderer.count)
        f->has_known_lengths = false; /* they were those of more splats */
    f->renderer.count = (int32_t)kept;
    f->has_old_lists = true;
    return gscl_renderer_project(&f->renderer);
}

gscl_result gscl_fit_read(gscl_fit *f, float *params) {
    return gscl_buffer_read(f->context, &f->renderer.params, 0, params, (size_t)f->renderer.count * ROW);
}
