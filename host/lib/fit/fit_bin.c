#include <limits.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/tunables.h"

/* Floats of a slot. */
static size_t slot_size(const gscl_fit *f) {
    const gscl_kernel_options *o = &f->renderer.options;
    return (size_t)GSCL_SLOT_SIZE(o->shape, o->opacity, f->renderer.channels, o->texture);
}

/* Numbers the slots of all splats; those of the last ones are left out where they do not fit. */
static gscl_result number_slots(gscl_fit *f) {
    const gscl_renderer *r = &f->renderer;
    const cl_int capacity = (cl_int)f->slot_capacity;
    const size_t items = gscl_scan_group_size(f->context);
    const size_t groups = gscl_groups((size_t)r->count, items * (size_t)gscl_scan_length(f->context));
    cl_kernel kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->slot_grids, (size_t)r->count * sizeof(gscl_slot_grid)));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->slot_totals, groups * sizeof(cl_long)));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->slots_needed, sizeof f->reading->slots));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "count_slots", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, groups, items, GSCL_ARG_BUFFER(r->boxes), GSCL_ARG(r->count),
                         GSCL_ARG_BUFFER(f->slot_totals)));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "number_slots", &kernel));
    return GSCL_LAUNCH(f->context, kernel, groups, items, GSCL_ARG_BUFFER(r->boxes), GSCL_ARG(r->count),
                       GSCL_ARG_BUFFER(f->slot_totals), GSCL_ARG(capacity), GSCL_ARG_BUFFER(f->slot_grids),
                       GSCL_ARG_BUFFER(f->slots_needed));
}

static gscl_result clear_slots(gscl_fit *f) {
    const gscl_renderer *r = &f->renderer;
    cl_kernel kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->gradient_slots, f->slot_capacity * slot_size(f) * sizeof(float)));
    GSCL_TRY(gscl_kernel(f->context, GSCL_PROGRAM_FIT, &r->options, "clear_slots", &kernel));
    return GSCL_LAUNCH(f->context, kernel, (size_t)r->count, gscl_slot_group_size(f->context),
                       GSCL_ARG_BUFFER(f->slot_grids), GSCL_ARG(r->count), GSCL_ARG_BUFFER(f->gradient_slots));
}

/* Enlarges the room for slots, after reading how many there are, where little is left. */
static gscl_result grow_slots(gscl_fit *f) {
    const size_t needed = (size_t)f->reading->slots;
    if (gscl_lists_have_room(needed, f->slot_capacity))
        return GSCL_OK;
    f->slot_capacity = gscl_lists_capacity(needed);
    if (f->slot_capacity > INT_MAX)
        return gscl_fail(f->context, GSCL_ERROR_DEVICE_MEMORY, "the splats overlap too much to be fitted");
    return number_slots(f);
}

gscl_result gscl_fit_bin(gscl_fit *f, bool exact) {
    f->has_old_lists = false;
    f->steps_since_bin = 0;
    if (f->renderer.count == 0)
        return gscl_renderer_bin(&f->renderer, exact);
    GSCL_TRY(number_slots(f));
    if (exact)
        GSCL_TRY(gscl_buffer_read_async(f->context, &f->slots_needed, &f->reading->slots, sizeof f->reading->slots));
    GSCL_TRY(gscl_renderer_bin(&f->renderer, exact)); /* waits where the lists are to be exact */
    if (exact)
        GSCL_TRY(grow_slots(f));
    return clear_slots(f);
}
