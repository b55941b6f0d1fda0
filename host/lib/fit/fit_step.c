#include <math.h>

#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/tunables.h"
#include "runtime/queue.h"

/* Renders each tile, compares it with `target` (or reads the loss's derivative from it, where the loss is EXTERNAL) and
 * writes the gradient slots. */
static gscl_result launch_tiles(gscl_fit *f, const gscl_buffer *target) {
    gscl_renderer *r = &f->renderer;
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(f->context, GSCL_PROGRAM_FIT, &r->options, "fit_tiles", &kernel));
    /* A level has 4^level fewer pixels to add up, of which one in row_step is drawn. */
    const gscl_fit_settings settings = {.shape = gscl_renderer_shape(r),
                                        .row_step = r->row_step,
                                        .first_row = r->first_row,
                                        .level_height = r->view_height,
                                        .derivative_scale = ldexpf((float)r->row_step, 2 * f->level),
                                        .step = f->skip.step};
    return GSCL_LAUNCH(f->context, kernel, gscl_renderer_tiles(&f->renderer), gscl_tile_group_size(f->context),
                       GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->entries), GSCL_ARG_BUFFER(r->tile_ranges),
                       GSCL_ARG_BUFFER(r->background), GSCL_ARG_BUFFER(*target), GSCL_ARG(settings),
                       GSCL_ARG_BUFFER(f->control), GSCL_ARG_BUFFER(f->gradient_slots), GSCL_ARG_BUFFER(f->tile_loss),
                       GSCL_ARG_BUFFER(f->skip.skip_until));
}

/* The work-groups of a kernel that sums the gradient slots of each splat. */
typedef struct slot_groups {
    size_t count, size;
} slot_groups;

static slot_groups slot_groups_of(const gscl_fit *f, gscl_program_kind kind) {
    const size_t splats = (size_t)f->renderer.count, items = gscl_slot_group_size(f->context);
    return items > 1
               ? (slot_groups){splats, items}
               : (slot_groups){gscl_groups(splats, GSCL_SPLATS_PER_GROUP), gscl_splat_group_size(f->context, kind)};
}

/* The splats as they were drawn. */
static gscl_gather_settings gather_settings(const gscl_fit *f) {
    return (gscl_gather_settings){.splats = f->renderer.count, .view = f->renderer.view};
}

static gscl_adam_settings adam_settings(gscl_fit *f, float rate) {
    f->limits.rate = rate;
    return (gscl_adam_settings){
        .splats = f->renderer.count, .fixed = (int32_t)f->fixed, .view = f->renderer.view, .limits = f->limits};
}

/* Sums the gradient slots of each splat into its gradients. */
static gscl_result launch_gather(gscl_fit *f) {
    gscl_renderer *r = &f->renderer;
    const gscl_gather_settings settings = gather_settings(f);
    const slot_groups groups = slot_groups_of(f, GSCL_PROGRAM_GRADIENTS);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(f->context, GSCL_PROGRAM_GRADIENTS, &r->options, "gather_gradients", &kernel));
    return GSCL_LAUNCH(f->context, kernel, groups.count, groups.size, GSCL_ARG_BUFFER(r->params),
                       GSCL_ARG_BUFFER(r->steps), GSCL_ARG(settings), GSCL_ARG_BUFFER(r->projected),
                       GSCL_ARG_BUFFER(f->links.grids), GSCL_ARG_BUFFER(f->links.links),
                       GSCL_ARG_BUFFER(f->gradient_slots), GSCL_ARG_BUFFER(f->gradients));
}

/* Sums the gradient slots and takes a step of Adam; projects the result for `settings`.view. */
static gscl_result launch_step(gscl_fit *f, gscl_gather_settings drawn, gscl_adam_settings settings) {
    gscl_renderer *r = &f->renderer;
    const slot_groups groups = slot_groups_of(f, GSCL_PROGRAM_FIT);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(f->context, GSCL_PROGRAM_FIT, &r->options, "step_splats", &kernel));
    return GSCL_LAUNCH(f->context, kernel, groups.count, groups.size, GSCL_ARG_BUFFER(r->params),
                       GSCL_ARG_BUFFER(f->first_moment), GSCL_ARG_BUFFER(f->second_moment), GSCL_ARG_BUFFER(f->ages),
                       GSCL_ARG_BUFFER(r->steps), GSCL_ARG(drawn), GSCL_ARG(settings), GSCL_ARG_BUFFER(f->control),
                       GSCL_ARG_BUFFER(f->links.grids), GSCL_ARG_BUFFER(f->links.links),
                       GSCL_ARG_BUFFER(f->gradient_slots), GSCL_ARG_BUFFER(r->projected),
                       GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG_BUFFER(r->boxes));
}

gscl_result gscl_fit_adam(gscl_fit *f, const gscl_buffer *params, float rate) {
    gscl_renderer *r = &f->renderer;
    const gscl_adam_settings settings = adam_settings(f, rate);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(f->context, GSCL_PROGRAM_GRADIENTS, &r->options, "adam_step", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_groups((size_t)r->count, GSCL_SPLATS_PER_GROUP),
                       gscl_splat_group_size(f->context, GSCL_PROGRAM_GRADIENTS), GSCL_ARG_BUFFER(*params),
                       GSCL_ARG_BUFFER(f->first_moment), GSCL_ARG_BUFFER(f->second_moment), GSCL_ARG_BUFFER(f->ages),
                       GSCL_ARG_BUFFER(f->gradients), GSCL_ARG_BUFFER(r->steps), GSCL_ARG(settings),
                       GSCL_ARG_BUFFER(f->control), GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->ellipse_bounds),
                       GSCL_ARG_BUFFER(r->boxes));
}

/* Steps after which the host waits for the device, to follow the lengths of the lists and the loss. */
static int wait_interval(const gscl_fit *f) {
    const struct gscl_fit_tunables *t = &gscl_fit_tunables;
    const int steps = (int)(t->wait_pixels / (double)gscl_renderer_plane(&f->renderer));
    return steps < t->check_interval ? t->check_interval : steps < f->max_wait ? steps : f->max_wait;
}

/* Bins and follows the lists and the loss on the device.  An external loss has none of tiles. */
static gscl_result bin_and_check(gscl_fit *f) {
    const bool has_loss = f->skip.step > 0 && f->renderer.options.loss != GSCL_LOSS_KIND_EXTERNAL;
    const bool is_wait_due = !f->has_known_lengths || f->steps_since_wait >= wait_interval(f);
    if (has_loss && is_wait_due)
        GSCL_TRY(gscl_fit_sum_loss(f)); /* for the host, which reads it before the control is launched */
    GSCL_TRY(gscl_fit_bin(f, is_wait_due));
    return gscl_fit_follow(f, has_loss);
}

/* Writes the derivative of an external loss by the rendering. */
static gscl_result differentiate_loss(gscl_fit *f) {
    gscl_renderer *r = &f->renderer;
    GSCL_TRY(gscl_renderer_draw(r));
    return gscl_ssim_derivative(&f->ssim, f->context, &r->options, r->width, r->height, &r->image,
                                &f->pyramid.levels[f->level], f->ssim_weight, &f->derivative);
}

static gscl_result refresh_lists(gscl_fit *f) {
    const bool is_check_due = f->has_old_lists || f->steps_since_control >= gscl_fit_tunables.check_interval;
    if (is_check_due)
        f->steps_since_control = 0;
    return is_check_due ? bin_and_check(f) : gscl_fit_bin(f, false);
}

/* Compares the rendering with the target, with the present lists of the tiles. */
static gscl_result compare(gscl_fit *f) {
    const bool is_external = f->renderer.options.loss == GSCL_LOSS_KIND_EXTERNAL;
    if (is_external)
        GSCL_TRY(differentiate_loss(f));
    GSCL_TRY(launch_tiles(f, is_external ? &f->derivative : gscl_fit_weighted_target(f)));
    f->skip.step++;
    f->steps_since_bin++;
    f->steps_since_control++;
    f->steps_since_wait++;
    return GSCL_OK;
}

gscl_result gscl_fit_differentiate(gscl_fit *f) {
    GSCL_TRY(refresh_lists(f));
    GSCL_TRY(compare(f));
    return launch_gather(f);
}

int gscl_fit_bin_interval(const gscl_fit *f) {
    if (!f->context->gpu_mapping)
        return gscl_fit_tunables.bin_interval;
    return f->model_level < 0 ? gscl_fit_tunables.gpu_bin_interval : gscl_fit_tunables.gpu_model_bin_interval;
}

gscl_result gscl_fit_step(gscl_fit *f, float rate, int row_step) {
    const bool is_external = f->renderer.options.loss == GSCL_LOSS_KIND_EXTERNAL;
    GSCL_TRY(gscl_fit_set_rows(f, is_external ? 1 : row_step));
    if (f->has_old_lists || f->steps_since_bin >= gscl_fit_bin_interval(f)) {
        GSCL_TRY(refresh_lists(f));
        gscl_flush(f->context); /* hundreds of steps may follow before the host waits */
    }
    GSCL_TRY(compare(f));
    const gscl_gather_settings drawn = gather_settings(f);
    /* Other rows need other lists, which are due now. */
    if (f->steps_since_bin >= gscl_fit_bin_interval(f))
        gscl_fit_next_rows(f);
    return launch_step(f, drawn, adam_settings(f, rate));
}

gscl_result gscl_fit_gradients(gscl_fit *f, float *gradients) {
    GSCL_TRY(gscl_fit_set_rows(f, 1));
    f->has_old_lists = true;
    GSCL_TRY(gscl_tile_skip_reset(&f->skip, f->context, gscl_renderer_tiles(&f->renderer), &f->control));
    GSCL_TRY(gscl_fit_differentiate(f));
    return gscl_buffer_read(f->context, &f->gradients, 0, gradients,
                            (size_t)f->renderer.count * GSCL_PARAMS * sizeof(float));
}
