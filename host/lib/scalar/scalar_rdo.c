#include "scalar/scalar_rdo.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "cl/structs.h"
#include "decode/ellipse.h"
#include "decode/quantise.h"
#include "runtime/mapping.h"
#include "runtime/timing.h"

#define CELL 16   /* pixels of the map that keeps visits apart */
#define GROUPS 64 /* sets of splats that are visited one after another; one bit each */
#define ROOM 1.3  /* a visit may grow a splat's box by this factor */
#define ROOM_PIXELS 3.0
#define COUNT_FLOOR 0.05  /* what a code that does not occur counts as */
#define COUNT_SPREAD 0.25 /* how much of its neighbours' counts a code borrows: the coder does so too */
#define TEXTURED_SHARE 0.05
#define GUESSED_COUNT 1.0

typedef struct pass {
    gscl_fit *fit;
    gscl_coded_image *picture;
    size_t count;
    bool keep_all;
    gscl_rdo_settings settings;
    gscl_minor_entry minors[GSCL_MAX_SCALE + 1];
    gscl_aspect_entry aspects[GSCL_MAX_SCALE + 1];
    cl_float existence;
    float *tables; /* GSCL_BITS_COUNT */
    gscl_codes *codes;
    cl_int *owned;  /* x0, x1, y0, y1 of each */
    cl_int *visits; /* splat numbers by group */
    size_t group_start[GROUPS + 1], largest_group;
    uint64_t *map; /* groups that have a splat in each cell */
    float *params;
    gscl_buffer device_codes, device_owned, device_visits, device_minors, device_aspects, device_tables,
        device_outcomes, picture_planes, weights;
} pass;

static void pass_free(pass *p) {
    free(p->tables);
    free(p->codes);
    free(p->owned);
    free(p->visits);
    free(p->map);
    free(p->params);
    gscl_buffer *buffers[] = {&p->device_codes,    &p->device_owned,   &p->device_visits,
                              &p->device_minors,   &p->device_aspects, &p->device_tables,
                              &p->device_outcomes, &p->picture_planes, &p->weights};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        gscl_buffer_free(buffers[i]);
}

/* Turns counts into bits: counts borrow from their neighbours and no code is impossible. */
static void bits_of_counts(const double *counts, int n, bool smooth, float *bits) {
    double total = 0;
    for (int i = 0; i < n; i++)
        total += counts[i] + COUNT_FLOOR;
    for (int i = 0; i < n; i++) {
        double c = counts[i];
        if (smooth)
            c = (1 - COUNT_SPREAD) * c +
                COUNT_SPREAD / 2 * ((i > 0 ? counts[i - 1] : 0) + (i + 1 < n ? counts[i + 1] : 0));
        bits[i] = (float)(-log2((c + COUNT_FLOOR) / total));
    }
}

static void codes_of(const gsf_splat *s, gscl_codes *c) {
    const gsf_texture *t = &s->texture;
    *c = (gscl_codes){.code = {[GSCL_CODE_MINOR] = s->minor,
                               [GSCL_CODE_ASPECT] = s->aspect,
                               [GSCL_CODE_ANGLE] = s->angle,
                               [GSCL_CODE_X] = (cl_int)s->x,
                               [GSCL_CODE_Y] = (cl_int)s->y,
                               [GSCL_CODE_LUMA] = s->luma,
                               [GSCL_CODE_CO] = s->co,
                               [GSCL_CODE_CG] = s->cg,
                               [GSCL_CODE_ALPHA] = s->alpha,
                               [GSCL_CODE_WAVE] = t->wave,
                               [GSCL_CODE_DIRECTION] = t->direction,
                               [GSCL_CODE_PHASE] = t->phase,
                               [GSCL_CODE_AMPLITUDE] = t->amplitude,
                               [GSCL_CODE_OPACITY] = s->opacity}};
}

static void splat_of(const gscl_codes *c, gsf_splat *s) {
    *s = (gsf_splat){.minor = (uint16_t)c->code[GSCL_CODE_MINOR],
                     .aspect = (uint16_t)c->code[GSCL_CODE_ASPECT],
                     .angle = (uint16_t)c->code[GSCL_CODE_ANGLE],
                     .x = (uint32_t)c->code[GSCL_CODE_X],
                     .y = (uint32_t)c->code[GSCL_CODE_Y],
                     .luma = (int16_t)c->code[GSCL_CODE_LUMA],
                     .co = (int16_t)c->code[GSCL_CODE_CO],
                     .cg = (int16_t)c->code[GSCL_CODE_CG],
                     .alpha = (int16_t)c->code[GSCL_CODE_ALPHA],
                     .opacity = (uint16_t)c->code[GSCL_CODE_OPACITY],
                     .texture = {.wave = (uint8_t)c->code[GSCL_CODE_WAVE],
                                 .direction = (uint8_t)c->code[GSCL_CODE_DIRECTION],
                                 .phase = (uint8_t)c->code[GSCL_CODE_PHASE],
                                 .amplitude = (uint8_t)c->code[GSCL_CODE_AMPLITUDE]}};
}

/* What axis and angle codes mean and cost, from how often they occur. */
static void make_shape_tables(pass *p) {
    const gsf_coded_image *file = &p->picture->file;
    double minors[GSCL_MAX_SCALE + 1] = {0}, aspects[GSCL_MAX_SCALE + 1] = {0};
    float minor_bits[GSCL_MAX_SCALE + 1], aspect_bits[GSCL_MAX_SCALE + 1];
    for (size_t i = 0; i < p->count; i++) {
        minors[p->codes[i].code[GSCL_CODE_MINOR]]++;
        aspects[p->codes[i].code[GSCL_CODE_ASPECT]]++;
    }
    bits_of_counts(minors, GSCL_MAX_SCALE + 1, true, minor_bits);
    bits_of_counts(aspects, GSCL_MAX_SCALE + 1, true, aspect_bits);
    for (unsigned i = 0; i <= GSCL_MAX_SCALE; i++) {
        gscl_minor_entry *m = &p->minors[i];
        m->step = (float)gsf_position_step_q8(&file->steps, i) / 256.0f;
        m->cells_x = (cl_int)gsf_position_cells(&file->steps, i, file->header.width);
        m->cells_y = (cl_int)gsf_position_cells(&file->steps, i, file->header.height);
        m->bits = minor_bits[i] + log2f((float)m->cells_x * (float)m->cells_y);
        p->aspects[i].angles = (cl_int)gsf_angle_count(&file->steps, i);
        p->aspects[i].bits = aspect_bits[i] + log2f((float)p->aspects[i].angles);
    }
}

static void make_colour_tables(pass *p) {
    double counts[GSCL_COLOUR_CODES];
    for (int k = 0; k < 4; k++) {
        int min = p->settings.min[k], n = p->settings.max[k] - min + 1;
        memset(counts, 0, sizeof counts);
        for (size_t i = 0; i < p->count; i++)
            counts[p->codes[i].code[GSCL_CODE_LUMA + k] - min]++;
        bits_of_counts(counts, n, true, p->tables + k * GSCL_COLOUR_CODES + GSCL_COLOUR_CODES / 2 + min);
    }
}

/* Before there are waves, those that are coming are guessed: a share of the splats, any wave. */
static void make_texture_tables(pass *p) {
    double waves[GSCL_WAVES] = {0}, directions[GSCL_DIRECTIONS] = {0}, amplitudes[GSCL_AMPLITUDES] = {0};
    double count = (double)p->count, textured = TEXTURED_SHARE * count;
    for (int i = 0; i < GSCL_WAVES; i++)
        waves[i] = directions[i] = amplitudes[i] = GUESSED_COUNT;
    for (size_t i = 0; i < p->count; i++) {
        const cl_int *code = p->codes[i].code;
        if (code[GSCL_CODE_AMPLITUDE] == 0)
            continue;
        textured++;
        waves[code[GSCL_CODE_WAVE]]++;
        directions[code[GSCL_CODE_DIRECTION]]++;
        amplitudes[code[GSCL_CODE_AMPLITUDE] - 1]++;
    }
    count *= 1 + TEXTURED_SHARE;
    p->tables[GSCL_BITS_PLAIN] = (float)-log2(fmax(count - textured, 1) / (count + 1));
    p->tables[GSCL_BITS_TEXTURED] = (float)(log2(GSCL_PHASES) - log2(fmax(textured, 1) / (count + 1)));
    bits_of_counts(waves, GSCL_WAVES, true, p->tables + GSCL_BITS_WAVE);
    bits_of_counts(directions, GSCL_DIRECTIONS, true, p->tables + GSCL_BITS_DIRECTION);
    bits_of_counts(amplitudes, GSCL_AMPLITUDES, true, p->tables + GSCL_BITS_AMPLITUDE);
}

static void make_opacity_table(pass *p) {
    double opacities[GSCL_OPACITIES] = {0};
    for (size_t i = 0; i < p->count; i++)
        opacities[p->codes[i].code[GSCL_CODE_OPACITY]]++;
    bits_of_counts(opacities, p->picture->file.steps.opacity + 1, true, p->tables + GSCL_BITS_OPACITY);
}

static void make_settings(pass *p) {
    const gsf_coded_image *file = &p->picture->file;
    float steps[GSCL_STEP_COUNT];
    gscl_steps_to_floats(&file->steps, steps);
    p->settings.scale_step = steps[GSCL_STEP_SCALE];
    p->settings.luma_step = steps[GSCL_STEP_LUMA];
    p->settings.chroma_step = steps[GSCL_STEP_CHROMA];
    p->settings.alpha_step = steps[GSCL_STEP_ALPHA];
    p->settings.amplitude_step = steps[GSCL_STEP_AMPLITUDE];
    p->settings.opacity_levels = steps[GSCL_STEP_OPACITY];
    gsf_luma_range(file->header.blend, file->steps.luma, &p->settings.min[0], &p->settings.max[0]);
    gsf_chroma_range(file->steps.chroma, &p->settings.min[1], &p->settings.max[1]);
    gsf_chroma_range(file->steps.chroma, &p->settings.min[2], &p->settings.max[2]);
    gsf_luma_range(file->header.blend, file->steps.alpha, &p->settings.min[3], &p->settings.max[3]);
}

/* The pixels of the level that a visit may touch: the outline's box with room to grow, clipped. */
static void own_box(const pass *p, const float *params, cl_int box[4]) {
    const gscl_renderer *r = &p->fit->renderer;
    const gscl_half_size half = gscl_ellipse_half_size(params[GSCL_LOG_S1], params[GSCL_LOG_S2], params[GSCL_THETA],
                                                       r->view.blur, sqrt(2.0 * GSCL_SUPPORT) * ROOM);
    double half_width = half.width * r->view.inv_scale + ROOM_PIXELS;
    double half_height = half.height * r->view.inv_scale + ROOM_PIXELS;
    double x = params[GSCL_X] * r->view.inv_scale, y = params[GSCL_Y] * r->view.inv_scale;
    box[0] = (cl_int)floor(x - half_width);
    box[1] = (cl_int)ceil(x + half_width);
    box[2] = (cl_int)floor(y - half_height);
    box[3] = (cl_int)ceil(y + half_height);
}

static int clamp_cell(cl_int pixel, int cells) {
    int cell = pixel < 0 ? 0 : pixel / CELL;
    return cell < cells ? cell : cells - 1;
}

/* The first group that has no splat near this one, or -1; marks the cells. */
static int find_group(pass *p, const cl_int box[4]) {
    int columns = (p->fit->renderer.width + CELL - 1) / CELL, rows = (p->fit->renderer.height + CELL - 1) / CELL;
    int x0 = clamp_cell(box[0], columns), x1 = clamp_cell(box[1], columns);
    int y0 = clamp_cell(box[2], rows), y1 = clamp_cell(box[3], rows);
    uint64_t taken = 0;
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++)
            taken |= p->map[(size_t)y * (size_t)columns + (size_t)x];
    if (taken == UINT64_MAX)
        return -1;
    int group = 0;
    while (taken >> group & 1)
        group++;
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++)
            p->map[(size_t)y * (size_t)columns + (size_t)x] |= UINT64_C(1) << group;
    return group;
}

typedef struct visit {
    int group;
    int64_t area; /* pixels, about: what the visit costs */
    cl_int splat;
} visit;

static int compare_visits(const void *a, const void *b) {
    const visit *p = a, *q = b;
    if (p->group != q->group)
        return p->group < q->group ? -1 : 1;
    if (p->area != q->area)
        return p->area < q->area ? -1 : 1;
    return p->splat < q->splat ? -1 : p->splat > q->splat;
}

/* Sorts splats that do not touch each other into groups; those that find no group wait for the next pass.  Within a
 * group the large ones come last: devices that hand out work in ever smaller shares then finish together. */
static void make_groups(pass *p, visit *visits) {
    size_t at = 0, sizes[GROUPS] = {0};
    for (size_t i = 0; i < p->count; i++) {
        const cl_int *box = p->owned + 4 * i;
        own_box(p, p->params + i * GSCL_PARAMS, p->owned + 4 * i);
        int group = find_group(p, box);
        if (group < 0)
            continue;
        visits[at++] = (visit){group, (int64_t)(box[1] - box[0]) * (box[3] - box[2]), (cl_int)i};
        sizes[group]++;
    }
    qsort(visits, at, sizeof *visits, compare_visits);
    for (size_t i = 0; i < at; i++)
        p->visits[i] = visits[i].splat;
    for (int g = 0; g < GROUPS; g++) {
        p->group_start[g + 1] = p->group_start[g] + sizes[g];
        p->largest_group = sizes[g] > p->largest_group ? sizes[g] : p->largest_group;
    }
}

static gscl_result allocate(pass *p) {
    const gscl_renderer *r = &p->fit->renderer;
    size_t n = p->count + 1;
    size_t cells = (size_t)((r->width + CELL - 1) / CELL) * (size_t)((r->height + CELL - 1) / CELL);
    p->tables = calloc(GSCL_BITS_COUNT, sizeof *p->tables);
    p->codes = malloc(n * sizeof *p->codes);
    p->owned = malloc(n * 4 * sizeof *p->owned);
    p->visits = malloc(n * sizeof *p->visits);
    p->map = calloc(cells, sizeof *p->map);
    p->params = malloc(n * GSCL_PARAMS * sizeof *p->params);
    if (p->tables && p->codes && p->owned && p->visits && p->map && p->params)
        return GSCL_OK;
    return gscl_fail_memory(p->fit->context);
}

/* Neighbours that each visit looks at (MOVES in cl/scalar_rdo.cl). */
static size_t moves_of(const pass *p) {
    return GSCL_RDO_MOVES + (p->fit->renderer.options.opacity ? GSCL_RDO_OPACITY_MOVES : 0);
}

static gscl_result upload_all(pass *p) {
    gscl_context *context = p->fit->context;
    GSCL_TRY(gscl_buffer_upload(context, &p->device_codes, p->codes, p->count * sizeof *p->codes));
    GSCL_TRY(gscl_buffer_upload(context, &p->device_visits, p->visits, p->group_start[GROUPS] * sizeof *p->visits));
    GSCL_TRY(
        gscl_buffer_reserve(context, &p->device_outcomes, p->largest_group * moves_of(p) * sizeof(gscl_move_outcome)));
    GSCL_TRY(gscl_buffer_upload(context, &p->device_owned, p->owned, p->count * 4 * sizeof *p->owned));
    GSCL_TRY(gscl_buffer_upload(context, &p->device_minors, p->minors, sizeof p->minors));
    GSCL_TRY(gscl_buffer_upload(context, &p->device_aspects, p->aspects, sizeof p->aspects));
    return gscl_buffer_upload(context, &p->device_tables, p->tables, GSCL_BITS_COUNT * sizeof *p->tables);
}

/* Draws the picture, with its sums of weights, and measures its squared error. */
static gscl_result begin(pass *p, double *error) {
    gscl_renderer *r = &p->fit->renderer;
    cl_kernel kernel;
    const gscl_image_shape shape = gscl_renderer_shape(r);
    size_t bytes = (size_t)gscl_renderer_plane(r) * sizeof(float);
    GSCL_TRY(gscl_renderer_set_steps(r, NULL));
    GSCL_TRY(gscl_fit_replace(p->fit, p->params, p->count));
    GSCL_TRY(gscl_renderer_bin(r, true));
    GSCL_TRY(gscl_buffer_reserve_image(r->context, &p->picture_planes, bytes * (size_t)r->channels));
    GSCL_TRY(gscl_buffer_reserve_image(r->context, &p->weights, bytes));
    GSCL_TRY(gscl_kernel(r->context, GSCL_PROGRAM_SCALAR_RDO, &r->options, "rdo_begin", &kernel));
    GSCL_TRY(GSCL_LAUNCH(r->context, kernel, (size_t)r->view.tiles_x * (size_t)r->view.tiles_y,
                         gscl_tile_group_size(r->context), GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->entries),
                         GSCL_ARG_BUFFER(r->tile_ranges), GSCL_ARG_BUFFER(r->background),
                         GSCL_ARG_BUFFER(p->picture_planes), GSCL_ARG_BUFFER(p->weights), GSCL_ARG(shape)));
    return gscl_fit_error_sum(p->fit, &p->picture_planes, error);
}

/* All splats of a group change at once; none touches another's pixels. */
static gscl_result visit_group(pass *p, int group) {
    gscl_renderer *r = &p->fit->renderer;
    cl_float leave_out = p->keep_all ? FLT_MAX : 0.0f;
    cl_int start = (cl_int)p->group_start[group], count = (cl_int)(p->group_start[group + 1] - p->group_start[group]);
    cl_ulong plane = gscl_renderer_plane(r);
    const gscl_buffer *goal = gscl_fit_weighted_target(p->fit);
    cl_kernel take_out, weigh, settle;
    GSCL_TRY(gscl_kernel(r->context, GSCL_PROGRAM_SCALAR_RDO, &r->options, "rdo_remove", &take_out));
    GSCL_TRY(gscl_kernel(r->context, GSCL_PROGRAM_SCALAR_RDO, &r->options, "rdo_evaluate", &weigh));
    GSCL_TRY(gscl_kernel(r->context, GSCL_PROGRAM_SCALAR_RDO, &r->options, "rdo_commit", &settle));
    GSCL_TRY(GSCL_LAUNCH(r->context, take_out, (size_t)count, 1, GSCL_ARG_BUFFER(p->device_visits), GSCL_ARG(start),
                         GSCL_ARG(count), GSCL_ARG_BUFFER(p->device_codes), GSCL_ARG_BUFFER(p->device_minors),
                         GSCL_ARG_BUFFER(p->device_aspects), GSCL_ARG(p->settings), GSCL_ARG(r->view),
                         GSCL_ARG_BUFFER(p->picture_planes), GSCL_ARG_BUFFER(p->weights), GSCL_ARG(r->width),
                         GSCL_ARG(r->height), GSCL_ARG(plane)));
    GSCL_TRY(GSCL_LAUNCH(r->context, weigh, (size_t)count * moves_of(p), 1, GSCL_ARG_BUFFER(p->device_visits),
                         GSCL_ARG(start), GSCL_ARG(count), GSCL_ARG_BUFFER(p->device_codes),
                         GSCL_ARG_BUFFER(p->device_owned), GSCL_ARG_BUFFER(p->device_minors),
                         GSCL_ARG_BUFFER(p->device_aspects), GSCL_ARG_BUFFER(p->device_tables), GSCL_ARG(p->settings),
                         GSCL_ARG(r->view), GSCL_ARG(p->existence), GSCL_ARG_BUFFER(p->picture_planes),
                         GSCL_ARG_BUFFER(p->weights), GSCL_ARG_BUFFER(*goal), GSCL_ARG(r->width), GSCL_ARG(r->height),
                         GSCL_ARG(plane), GSCL_ARG_BUFFER(p->device_outcomes)));
    return GSCL_LAUNCH(r->context, settle, (size_t)count, 1, GSCL_ARG_BUFFER(p->device_visits), GSCL_ARG(start),
                       GSCL_ARG(count), GSCL_ARG_BUFFER(p->device_outcomes), GSCL_ARG_BUFFER(p->device_codes),
                       GSCL_ARG_BUFFER(p->device_minors), GSCL_ARG_BUFFER(p->device_aspects),
                       GSCL_ARG_BUFFER(p->device_tables), GSCL_ARG(p->settings), GSCL_ARG(r->view), GSCL_ARG(leave_out),
                       GSCL_ARG_BUFFER(p->picture_planes), GSCL_ARG_BUFFER(p->weights), GSCL_ARG_BUFFER(*goal),
                       GSCL_ARG(r->width), GSCL_ARG(r->height), GSCL_ARG(plane));
}

/* Takes the codes back into the picture, without the splats that were dropped. */
static void collect(pass *p) {
    gsf_coded_image *file = &p->picture->file;
    uint32_t kept = 0;
    for (size_t i = 0; i < p->count; i++)
        if (p->codes[i].code[GSCL_CODE_MINOR] >= 0)
            splat_of(&p->codes[i], &file->splats[kept++]);
    file->header.splat_count = kept;
}

static gscl_result run(pass *p, double lambda_scale) {
    gscl_coded_image *picture = p->picture;
    size_t size;
    double error;
    float background[4];
    GSCL_TRY(allocate(p));
    GSCL_TRY(gscl_coded_image_sort(picture, NULL)); /* the order of visits is a function of the codes alone */
    GSCL_TRY(gscl_coded_image_size(picture, &size));
    gscl_coded_image_params(picture, p->params, background);
    for (size_t i = 0; i < p->count; i++)
        codes_of(&picture->file.splats[i], &p->codes[i]);
    make_settings(p);
    make_shape_tables(p);
    make_colour_tables(p);
    make_texture_tables(p);
    make_opacity_table(p);
    visit *visits = malloc((p->count + 1) * sizeof *visits);
    if (!visits)
        return gscl_fail_memory(p->fit->context);
    make_groups(p, visits);
    free(visits);
    GSCL_TRY(upload_all(p));
    GSCL_TRY(begin(p, &error));
    p->settings.lambda = (float)(lambda_scale * error / (2.0 * 8.0 * (double)size));
    p->existence = -log2f((float)p->count); /* what the order of all splats saves */
    for (int group = 0; group < GROUPS; group++)
        GSCL_TRY(visit_group(p, group));
    GSCL_TRY(gscl_buffer_read(p->fit->context, &p->device_codes, 0, p->codes, p->count * sizeof *p->codes));
    collect(p);
    return GSCL_OK;
}

gscl_result gscl_scalar_rdo_pass(gscl_fit *fit, gscl_coded_image *picture, const gscl_scalar_rdo_settings *how) {
    pass p = {.fit = fit,
              .picture = picture,
              .count = picture->file.header.splat_count,
              .keep_all = how->keep_all,
              .settings.scan = how->scan_textures};
    if (p.count == 0)
        return GSCL_OK;
    gscl_kernel_options options = fit->renderer.options;
    options.texture = picture->file.header.has_texture;
    gscl_renderer_set_options(&fit->renderer, GSCL_PROGRAM_SCALAR_RDO, &options);
    gscl_stage(fit->context, GSCL_STAGE_RDO);
    gscl_result result = run(&p, how->lambda_scale);
    pass_free(&p);
    return result;
}
