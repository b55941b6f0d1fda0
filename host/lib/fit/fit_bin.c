#include <limits.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/tunables.h"
#include "runtime/queue.h"

/* Floats of a slot. */
static size_t slot_size(const gscl_fit *f) {
    const gscl_kernel_options *o = &f->renderer.options;
    return (size_t)GSCL_SLOT_SIZE(o->shape, o->opacity, f->renderer.channels, o->texture);
}

/* Counts the links of each block of splats. */
static gscl_result count_links(gscl_fit *f) {
    const gscl_renderer *r = &f->renderer;
    const size_t blocks = gscl_groups((size_t)r->count, GSCL_LINK_BLOCK);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->links.block_links, blocks * sizeof(int64_t)));
    GSCL_TRY(gscl_kernel_find(f->context, GSCL_PROGRAM_BIN, &r->options, "count_links", &kernel));
    return GSCL_LAUNCH(f->context, kernel, blocks, gscl_band_group_size(f->context), GSCL_ARG_BUFFER(r->boxes),
                       GSCL_ARG(r->count), GSCL_ARG_BUFFER(f->links.block_links));
}

/* Makes room for the links of all splats, which are numbered where the lists are filled. */
static gscl_result prepare_links(gscl_fit *f) {
    const int32_t splats = f->renderer.count;
    const bool has_blocks = splats > gscl_counted_links(f->context);
    f->links.block = has_blocks ? GSCL_LINK_BLOCK : splats + 1;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->links.grids, (size_t)splats * sizeof(gscl_link_grid)));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->links.links, f->links.capacity * sizeof(int32_t)));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->links.needed, sizeof f->reading->links));
    return has_blocks ? count_links(f) : GSCL_OK;
}

/* Makes room for a slot of each entry of the tiles' lists. */
static gscl_result reserve_slots(gscl_fit *f) {
    const size_t entries = f->renderer.entries.size / sizeof(uint32_t);
    return gscl_buffer_reserve(f->context, &f->gradient_slots, entries * slot_size(f) * sizeof(float));
}

/* Enlarges the room for links where there is little left beside `growth` times those that were read. */
static gscl_result grow_links(gscl_fit *f, double growth, gscl_lists_state *state) {
    const double expected = growth * f->reading->links;
    if (expected < INT_MAX && gscl_lists_have_room((size_t)expected, f->links.capacity))
        return GSCL_OK;
    if ((size_t)f->reading->links > f->links.capacity)
        *state = GSCL_LISTS_CUT;
    else if (*state == GSCL_LISTS_KEPT)
        *state = GSCL_LISTS_ENLARGED;
    f->links.capacity = gscl_lists_capacity((size_t)expected);
    return f->links.capacity <= INT_MAX
               ? GSCL_OK
               : gscl_fail(f->context, GSCL_ERROR_DEVICE_MEMORY, "the splats overlap too much to be fitted");
}

gscl_result gscl_fit_begin_readings(gscl_fit *f) {
    struct gscl_fit_readings *to = f->reading;
    GSCL_TRY(gscl_buffer_read_async(f->context, &f->control, &to->control, sizeof to->control));
    if (f->has_old_lists)
        return GSCL_OK;
    if (f->renderer.count > 0)
        GSCL_TRY(gscl_buffer_read_async(f->context, &f->links.needed, &to->links, sizeof to->links));
    return gscl_renderer_begin_lengths(&f->renderer);
}

/* Lists that grew beyond their room may do so again soon. */
static void set_next_wait(gscl_fit *f, gscl_lists_state state) {
    const struct gscl_fit_tunables *t = &gscl_fit_tunables;
    const int next = f->max_wait * t->wait_growth;
    f->max_wait = state == GSCL_LISTS_CUT || f->max_wait == 0 ? t->check_interval : next;
    f->max_wait = f->max_wait < t->max_wait_interval ? f->max_wait : t->max_wait_interval;
}

gscl_result gscl_fit_end_readings(gscl_fit *f, gscl_lists_state *state) {
    *state = GSCL_LISTS_KEPT;
    f->known_loss = f->reading->control.loss;
    f->known_low_splats = f->reading->control.low_splats;
    if (f->has_old_lists)
        return GSCL_OK; /* their lengths are no longer of interest */
    const int steps = f->steps_since_wait;
    f->has_known_lengths = f->renderer.count > 0;
    f->known_splats = f->renderer.count;
    f->steps_since_wait = 0;
    GSCL_TRY(gscl_renderer_end_lengths(&f->renderer, 1, state));
    if (f->renderer.count > 0)
        GSCL_TRY(grow_links(f, 1, state));
    f->has_old_lists = *state != GSCL_LISTS_KEPT;
    set_next_wait(f, *state);
    if (*state == GSCL_LISTS_CUT && steps > 0)
        gscl_log(f->context, GSCL_LOG_DEBUG, "lists of tiles were cut short in the last %d steps", steps);
    return GSCL_OK;
}

/* New splats take up to twice their share of a list, where many come to lie in one row of tiles.  If it is still too short, the
 * last of them are left out until the host looks again, which the next filling of the lists does where many are new to it. */
gscl_result gscl_fit_expect_splats(gscl_fit *f, size_t count) {
    gscl_lists_state state = GSCL_LISTS_KEPT;
    if (!f->has_known_lengths)
        return GSCL_OK;
    const double new_splats = (double)count + f->renderer.count - f->known_splats;
    const double growth = 1 + 2.0 * new_splats / f->known_splats;
    f->has_known_lengths = new_splats < gscl_fit_tunables.max_new_splats * f->known_splats;
    GSCL_TRY(gscl_renderer_end_lengths(&f->renderer, growth, &state));
    return grow_links(f, growth, &state);
}

static gscl_result fill_lists(gscl_fit *f) {
    f->has_old_lists = false;
    f->steps_since_bin = 0;
    if (f->renderer.count == 0)
        return gscl_renderer_bin(&f->renderer, false);
    GSCL_TRY(prepare_links(f));
    return gscl_renderer_bin_linked(&f->renderer, &f->links);
}

gscl_result gscl_fit_bin(gscl_fit *f, bool exact) {
    gscl_lists_state state = GSCL_LISTS_KEPT;
    GSCL_TRY(fill_lists(f));
    if (exact) {
        GSCL_TRY(gscl_fit_begin_readings(f));
        GSCL_TRY(gscl_finish(f->context));
        GSCL_TRY(gscl_fit_end_readings(f, &state));
    }
    if (state != GSCL_LISTS_KEPT)
        GSCL_TRY(fill_lists(f));
    return reserve_slots(f);
}
