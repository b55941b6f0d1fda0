#include "scalar/scalar_rdo.h"
#include "decode/coded_size.h"

#include <float.h>
#include <stdlib.h>

#include "cl/constants.h"
#include "runtime/elementary.h"
#include "runtime/mapping.h"
#include "runtime/queue.h"
#include "runtime/timing.h"
#include "scalar/rdo_tables.h"
#include "scalar/tunables.h"

/* One pass. */
typedef struct rdo_pass {
    gscl_scalar_rdo *rdo;
    gscl_fit *fit;
    gscl_coded_image *coded;
    size_t count; /* splats before the pass */
    float background[4];
    gscl_kernel *visit;
    gscl_rdo_pass shared;
} rdo_pass;

/* The device may still copy from and to the arrays, after an error. */
void gscl_scalar_rdo_free(gscl_scalar_rdo *rdo, gscl_context *context) {
    gscl_buffer *buffers[] = {&rdo->device_codes, &rdo->device_tables, &rdo->device_tasks, &rdo->weights};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        gscl_buffer_free(buffers[i]);
    gscl_release_after_copies(context, rdo->codes);
    gscl_release_after_copies(context, rdo->tables);
    free(rdo->params);
    gscl_rdo_groups_free(&rdo->groups, context);
    *rdo = (gscl_scalar_rdo){0};
}

void gscl_scalar_rdo_release_plane(gscl_scalar_rdo *rdo) {
    gscl_buffer_free(&rdo->weights);
}

static gscl_result reserve_splats(gscl_scalar_rdo *rdo, gscl_context *context, size_t count) {
    if (!rdo->tables)
        rdo->tables = calloc(1, sizeof *rdo->tables);
    if (count > rdo->capacity) {
        gscl_release_after_copies(context, rdo->codes);
        free(rdo->params);
        rdo->codes = malloc(count * sizeof *rdo->codes);
        rdo->params = malloc(count * GSCL_PARAMS * sizeof *rdo->params);
        rdo->capacity = rdo->codes && rdo->params ? count : 0;
    }
    return rdo->tables && rdo->capacity ? GSCL_OK : gscl_fail_memory(context);
}

/* Codes, tables and groups on the host, then on the device.  *size: of the coded image as a file. */
static gscl_result rdo_prepare(rdo_pass *p, size_t *size) {
    gscl_scalar_rdo *rdo = p->rdo;
    gscl_context *context = p->fit->context;
    const gsf_coded_image *file = &p->coded->file;
    GSCL_TRY(reserve_splats(rdo, context, p->count));
    GSCL_TRY(gscl_coded_image_sort(p->coded, NULL)); /* groups depend on nothing but the codes */
    GSCL_TRY(gscl_coded_image_size(p->coded, size));
    gscl_coded_image_params(p->coded, rdo->params, p->background);
    for (size_t i = 0; i < p->count; i++)
        rdo->codes[i] = gscl_rdo_codes_of(&file->splats[i]);
    gscl_rdo_tables_make(rdo->tables, file, &p->shared.settings, rdo->codes, p->count);
    GSCL_TRY(gscl_rdo_groups_make(&rdo->groups, &p->fit->renderer, rdo->params, p->fit->fixed, p->count));
    const size_t tasks = rdo->groups.start[GSCL_RDO_GROUPS];
    GSCL_TRY(gscl_buffer_upload_async(context, &rdo->device_codes, rdo->codes, p->count * sizeof *rdo->codes));
    GSCL_TRY(gscl_buffer_upload_async(context, &rdo->device_tables, rdo->tables, sizeof *rdo->tables));
    return gscl_buffer_upload_async(context, &rdo->device_tasks, rdo->groups.tasks, tasks * sizeof(gscl_rdo_task));
}

/* Draws the coded image with its sums of weights; fit->distortion becomes what bits are traded against. */
static gscl_result rdo_draw(rdo_pass *p) {
    gscl_scalar_rdo *rdo = p->rdo;
    gscl_renderer *r = &p->fit->renderer;
    const gscl_image_shape shape = gscl_renderer_shape(r);
    const size_t plane = (size_t)gscl_renderer_plane(r) * sizeof(float);
    gscl_kernel *kernel;
    gscl_fit_release_scratch(p->fit);
    GSCL_TRY(gscl_renderer_set_steps(r, NULL));
    GSCL_TRY(gscl_fit_replace(p->fit, rdo->params, p->count, p->background));
    GSCL_TRY(gscl_renderer_bin(r, false));
    GSCL_TRY(gscl_renderer_reserve_image(r));
    GSCL_TRY(gscl_buffer_reserve_image(r->context, &rdo->weights, plane));
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_SCALAR_RDO, &r->options, "rdo_begin", &kernel));
    GSCL_TRY(GSCL_LAUNCH(r->context, kernel, gscl_renderer_tiles(r), gscl_tile_group_size(r->context),
                         GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->entries), GSCL_ARG_BUFFER(r->tile_ranges),
                         GSCL_ARG_BUFFER(r->background), GSCL_ARG_BUFFER(r->image), GSCL_ARG_BUFFER(rdo->weights),
                         GSCL_ARG(shape)));
    GSCL_TRY(gscl_fit_renew_model_at(p->fit, &r->image, gscl_scalar_tunables.curvature_of_passes));
    return gscl_fit_begin_distortion(p->fit, &r->image);
}

/* Visits all splats of a group at once: none touches another's pixels. */
static gscl_result rdo_visit_group(rdo_pass *p, int group) {
    const gscl_scalar_rdo *rdo = p->rdo;
    const gscl_renderer *r = &p->fit->renderer;
    const gscl_buffer *target = gscl_fit_weighted_target(p->fit);
    const size_t start = rdo->groups.start[group], count = rdo->groups.start[group + 1] - start;
    gscl_rdo_pass shared = p->shared;
    shared.start = (int32_t)start;
    return GSCL_LAUNCH(r->context, p->visit, count, gscl_rdo_group_size(r->context), GSCL_ARG(shared),
                       GSCL_ARG_BUFFER(rdo->device_tasks), GSCL_ARG_BUFFER(rdo->device_codes),
                       GSCL_ARG_BUFFER(rdo->device_tables), GSCL_ARG_BUFFER(r->image), GSCL_ARG_BUFFER(rdo->weights),
                       GSCL_ARG_BUFFER(*target), GSCL_ARG_BUFFER(p->fit->distortion));
}

/* Takes the codes that were read, without the splats that were dropped. */
static void rdo_take_codes(rdo_pass *p) {
    const gscl_scalar_rdo *rdo = p->rdo;
    gsf_coded_image *file = &p->coded->file;
    uint32_t kept = 0;
    for (size_t i = 0; i < p->count; i++)
        if (rdo->codes[i].code[GSCL_CODE_MAJOR] >= 0)
            file->splats[kept++] = gscl_rdo_splat_of(&rdo->codes[i], file->splats[i].layer);
    file->header.splat_count = kept;
}

/* The pass on the device, up to the codes.  They and the lengths of the lists are read at once, after the last launch: a driver
 * may wait for the device in any call that reads into memory of the host. */
static gscl_result rdo_visit_all(rdo_pass *p, double lambda_scale) {
    gscl_scalar_rdo *rdo = p->rdo;
    gscl_context *context = p->fit->context;
    size_t size;
    GSCL_TRY(rdo_prepare(p, &size));
    GSCL_TRY(rdo_draw(p));
    gscl_flush(context); /* before dozens of launches, and perhaps a build of their kernel */
    p->shared.settings.lambda = (float)(lambda_scale / (2.0 * 8.0 * (double)size)); /* of the error, which it has */
    GSCL_TRY(gscl_kernel_find(context, GSCL_PROGRAM_SCALAR_RDO, &p->fit->renderer.options, "rdo_visit", &p->visit));
    for (int group = 0; group < GSCL_RDO_GROUPS; group++)
        GSCL_TRY(rdo_visit_group(p, group));
    GSCL_TRY(gscl_renderer_begin_lengths(&p->fit->renderer));
    return gscl_buffer_read(context, &rdo->device_codes, 0, rdo->codes, p->count * sizeof *rdo->codes);
}

/* If a list was too short, the pass began from a wrong picture and is made again. */
static gscl_result rdo_run(rdo_pass *p, double lambda_scale) {
    gscl_lists_state state;
    do {
        GSCL_TRY(rdo_visit_all(p, lambda_scale));
        GSCL_TRY(gscl_renderer_end_lengths(&p->fit->renderer, 1, &state));
    } while (state == GSCL_LISTS_CUT);
    rdo_take_codes(p);
    return GSCL_OK;
}

gscl_scalar_rdo_settings gscl_scalar_rdo_default_settings(double lambda_scale) {
    return (gscl_scalar_rdo_settings){.lambda_scale = lambda_scale,
                                      .elongation_price = gscl_scalar_tunables.elongation_price,
                                      .min_explained = gscl_scalar_tunables.min_explained};
}

gscl_result gscl_scalar_rdo_pass(gscl_scalar_rdo *rdo, gscl_fit *fit, gscl_coded_image *coded,
                                 const gscl_scalar_rdo_settings *settings) {
    gscl_renderer *r = &fit->renderer;
    gscl_kernel_options options = r->options;
    rdo_pass p = {.rdo = rdo, .fit = fit, .coded = coded, .count = coded->file.header.splat_count};
    if (p.count == 0)
        return GSCL_OK;
    p.shared = (gscl_rdo_pass){
        .settings = gscl_rdo_settings_of(&coded->file),
        .view = r->view,
        .width = r->width,
        .height = r->height,
        .bits_per_splat = (float)-gscl_log2((double)(p.count - fit->fixed)), /* the order of all splats saves bits */
        .cost_of_dropping = settings->keep_all ? FLT_MAX : 0.0f};
    p.shared.settings.visits = gscl_scalar_tunables.rdo_visits;
    p.shared.settings.move_slack = gscl_scalar_tunables.move_slack;
    p.shared.settings.scan = settings->scan_textures;
    p.shared.settings.elongation_price = (float)settings->elongation_price;
    p.shared.settings.min_explained = (float)settings->min_explained;
    options.texture = coded->file.header.has_texture;
    gscl_renderer_set_options(r, &options);
    gscl_stage(fit->context, GSCL_STAGE_RDO);
    return rdo_run(&p, settings->lambda_scale);
}
