#include <limits.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/tunables.h"

/* Floats of a slot. */
static size_t slot_size(const gscl_fit *f) {
    const gscl_kernel_options *o = &f->renderer.options;
    return (size_t)GSCL_SLOT_SIZE(o->shape, o->opacity, f->renderer.channels, o->texture);
}

/* Numbers the links of all splats; those of the last ones are left out where they do not fit. */
static gscl_result number_links(gscl_fit *f) {
    const gscl_renderer *r = &f->renderer;
    const cl_int capacity = (cl_int)f->link_capacity;
    const size_t items = gscl_scan_group_size(f->context);
    const size_t groups = gscl_groups((size_t)r->count, items * (size_t)gscl_scan_length(f->context));
    cl_kernel kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->link_grids, (size_t)r->count * sizeof(gscl_link_grid)));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->link_totals, groups * sizeof(cl_long)));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->links_needed, sizeof f->reading->links));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "count_links", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, groups, items, GSCL_ARG_BUFFER(r->boxes), GSCL_ARG(r->count),
                         GSCL_ARG_BUFFER(f->link_totals)));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "number_links", &kernel));
    return GSCL_LAUNCH(f->context, kernel, groups, items, GSCL_ARG_BUFFER(r->boxes), GSCL_ARG(r->count),
                       GSCL_ARG_BUFFER(f->link_totals), GSCL_ARG(capacity), GSCL_ARG_BUFFER(f->link_grids),
                       GSCL_ARG_BUFFER(f->links_needed));
}

/* Links the entries of the tiles' lists, and makes room for a slot of each. */
static gscl_result link_entries(gscl_fit *f) {
    const gscl_renderer *r = &f->renderer;
    const size_t items = gscl_slot_group_size(f->context), entries = r->entries.size / sizeof(cl_uint);
    cl_kernel kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->gradient_slots, entries * slot_size(f) * sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->links, f->link_capacity * sizeof(cl_int)));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "clear_links", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, (size_t)r->count, items, GSCL_ARG_BUFFER(f->link_grids),
                         GSCL_ARG_BUFFER(f->links)));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "link_entries", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_renderer_tiles(r), items, GSCL_ARG_BUFFER(f->link_grids),
                       GSCL_ARG_BUFFER(r->entries), GSCL_ARG_BUFFER(r->tile_ranges), GSCL_ARG(r->view.tiles_x),
                       GSCL_ARG_BUFFER(f->links));
}

/* Enlarges the room for links, after reading how many there are, where little is left. */
static gscl_result grow_links(gscl_fit *f) {
    const size_t needed = (size_t)f->reading->links;
    if (gscl_lists_have_room(needed, f->link_capacity))
        return GSCL_OK;
    f->link_capacity = gscl_lists_capacity(needed);
    if (f->link_capacity > INT_MAX)
        return gscl_fail(f->context, GSCL_ERROR_DEVICE_MEMORY, "the splats overlap too much to be fitted");
    return number_links(f);
}

gscl_result gscl_fit_bin(gscl_fit *f, bool exact) {
    f->has_old_lists = false;
    f->steps_since_bin = 0;
    if (f->renderer.count == 0)
        return gscl_renderer_bin(&f->renderer, exact);
    GSCL_TRY(number_links(f));
    if (exact)
        GSCL_TRY(gscl_buffer_read_async(f->context, &f->links_needed, &f->reading->links, sizeof f->reading->links));
    GSCL_TRY(gscl_renderer_bin(&f->renderer, exact)); /* waits where the lists are to be exact */
    if (exact)
        GSCL_TRY(grow_links(f));
    return link_entries(f);
}
