#include "codebook/codebook_rdo.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "codebook/tunables.h"
#include "decode/ellipse.h"
#include "runtime/elementary.h"
#include "runtime/mapping.h"

static gscl_context *context_of(const gscl_codebook_rdo *rdo) {
    return rdo->codebook->fit->context;
}

/* ---- Arrays and buffers ---- */

static gscl_result rdo_allocate(gscl_codebook_rdo *rdo) {
    const size_t n = gscl_codebook_splats(rdo->codebook) + 1;
    rdo->shapes = malloc(GSCL_BOOK_BYTES);
    for (int b = 0; b < GSCL_BOOKS; b++)
        rdo->bits[b] = calloc(GSF_MAX_CODEBOOK, sizeof *rdo->bits[b]);
    rdo->cells = malloc(n * sizeof *rdo->cells);
    rdo->boxes = malloc(n * sizeof *rdo->boxes);
    rdo->batch_of = malloc(n * sizeof *rdo->batch_of);
    rdo->batch = malloc(n * sizeof *rdo->batch);
    rdo->next_batch = malloc((size_t)rdo->map_columns * (size_t)rdo->map_rows * sizeof *rdo->next_batch);
    rdo->kept = malloc(n * sizeof *rdo->kept);
    if (!rdo->shapes || !rdo->bits[GSCL_BOOK_SHAPE] || !rdo->bits[GSCL_BOOK_COLOUR] || !rdo->cells || !rdo->boxes ||
        !rdo->batch_of || !rdo->batch || !rdo->next_batch || !rdo->kept)
        return gscl_fail_memory(context_of(rdo));
    return GSCL_OK;
}

static gscl_result rdo_reserve_buffers(gscl_codebook_rdo *rdo) {
    const gscl_renderer *r = &rdo->codebook->fit->renderer;
    const size_t n = gscl_codebook_splats(rdo->codebook) + 1, plane = (size_t)gscl_renderer_plane(r) * sizeof(float);
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(gscl_buffer_reserve(r->context, &rdo->device_bits[b], GSF_MAX_CODEBOOK * sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve(r->context, &rdo->device_cells, n * sizeof *rdo->cells));
    GSCL_TRY(gscl_buffer_reserve(r->context, &rdo->device_boxes, n * sizeof *rdo->boxes));
    GSCL_TRY(gscl_buffer_reserve(r->context, &rdo->device_batch, n * sizeof *rdo->batch));
    GSCL_TRY(gscl_buffer_reserve_image(r->context, &rdo->front, plane * (size_t)r->channels));
    return gscl_buffer_reserve_image(r->context, &rdo->transmittance, plane);
}

gscl_result gscl_codebook_rdo_create(gscl_codebook_rdo *rdo, gscl_codebook *codebook) {
    const int side = gscl_codebook_tunables.cell_side;
    const gscl_renderer *r = &codebook->fit->renderer;
    *rdo = (gscl_codebook_rdo){
        .codebook = codebook, .map_columns = (r->width + side - 1) / side, .map_rows = (r->height + side - 1) / side};
    GSCL_TRY(rdo_allocate(rdo));
    return rdo_reserve_buffers(rdo);
}

void gscl_codebook_rdo_free(gscl_codebook_rdo *rdo) {
    void *arrays[] = {rdo->shapes,
                      rdo->bits[GSCL_BOOK_SHAPE],
                      rdo->bits[GSCL_BOOK_COLOUR],
                      rdo->cells,
                      rdo->boxes,
                      rdo->batch_of,
                      rdo->batch,
                      rdo->next_batch,
                      rdo->kept};
    gscl_buffer *buffers[] = {&rdo->device_bits[GSCL_BOOK_SHAPE],
                              &rdo->device_bits[GSCL_BOOK_COLOUR],
                              &rdo->device_cells,
                              &rdo->device_boxes,
                              &rdo->device_batch,
                              &rdo->front,
                              &rdo->transmittance};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
        gscl_buffer_free(buffers[i]);
    memset(rdo, 0, sizeof *rdo);
}

/* ---- Settings, bits and boxes of a pass ---- */

static void rdo_set_settings(gscl_codebook_rdo *rdo, double lambda, bool keep_all) {
    const gscl_codebook *c = rdo->codebook;
    const int last = (1 << c->position_bits) - 1;
    rdo->settings = (gscl_word_rdo_settings){.view = c->fit->renderer.view,
                                             .image = gscl_renderer_shape(&c->fit->renderer),
                                             .lambda = (float)lambda,
                                             .position_bits = (float)(2 * c->position_bits) -
                                                              (float)gscl_log2((double)gscl_codebook_splats(c)),
                                             .cost_of_dropping = keep_all ? FLT_MAX : 0.0f,
                                             .cell_x = (float)c->fit->pyramid.width / (float)(last + 1),
                                             .cell_y = (float)c->fit->pyramid.height / (float)(last + 1),
                                             .last_x = last,
                                             .last_y = last,
                                             .colours = c->books[GSCL_BOOK_COLOUR].count};
}

/* Bits of each word, from the number of its uses. */
static void count_bits_of_words(gscl_codebook_rdo *rdo, int book) {
    const gscl_codebook *c = rdo->codebook;
    const size_t splats = gscl_codebook_splats(c);
    const int count = c->books[book].count;
    const float prior = gscl_codebook_tunables.prior_uses;
    float *bits = rdo->bits[book];
    for (int k = 0; k < count; k++)
        bits[k] = prior;
    for (size_t i = 0; i < splats; i++)
        bits[c->pairs[i][book]] += 1.0f;
    for (int k = 0; k < count; k++)
        bits[k] = (float)-gscl_log2(bits[k] / ((float)splats + prior * (float)count));
}

static void find_cell(gscl_codebook_rdo *rdo, size_t i) {
    const float *p = rdo->codebook->params + i * GSCL_PARAMS;
    rdo->cells[i][0] = (int32_t)fmin(fmax(floor(p[GSCL_X] / rdo->settings.cell_x), 0), rdo->settings.last_x);
    rdo->cells[i][1] = (int32_t)fmin(fmax(floor(p[GSCL_Y] / rdo->settings.cell_y), 0), rdo->settings.last_y);
}

/* The pixels that the pass may change for a splat: its outline with a margin for a move by a cell, within the image. */
static void find_box(gscl_codebook_rdo *rdo, size_t i) {
    const gscl_renderer *r = &rdo->codebook->fit->renderer;
    const double margin = gscl_codebook_tunables.box_margin;
    const gscl_word_rdo_settings *s = &rdo->settings;
    const double x = (rdo->cells[i][0] + 0.5) * s->cell_x, y = (rdo->cells[i][1] + 0.5) * s->cell_y;
    const float *shape = rdo->shapes + rdo->codebook->pairs[i][GSCL_BOOK_SHAPE] * GSCL_BOOK_DIMS;
    const gscl_half_size half = gscl_ellipse_half_size(shape[0], shape[1], shape[2], 0, sqrt(2 * GSCL_SUPPORT));
    const double width = half.width + (margin + s->cell_x), height = half.height + (margin + s->cell_y);
    rdo->boxes[i][0] = (int32_t)fmax(floor(x - width), 0);
    rdo->boxes[i][1] = (int32_t)fmin(ceil(x + width), r->width - 1);
    rdo->boxes[i][2] = (int32_t)fmax(floor(y - height), 0);
    rdo->boxes[i][3] = (int32_t)fmin(ceil(y + height), r->height - 1);
}

/* ---- Batches of splats that do not overlap ---- */

/* The first batch that a splat with this box may be part of. */
static int first_free_batch(const gscl_codebook_rdo *rdo, const int32_t *box) {
    const int side = gscl_codebook_tunables.cell_side;
    int batch = 0;
    for (int y = box[2] / side; y <= box[3] / side; y++)
        for (int x = box[0] / side; x <= box[1] / side; x++)
            if (rdo->next_batch[y * rdo->map_columns + x] > batch)
                batch = rdo->next_batch[y * rdo->map_columns + x];
    return batch;
}

static void occupy_cells(gscl_codebook_rdo *rdo, const int32_t *box, int batch) {
    const int side = gscl_codebook_tunables.cell_side;
    for (int y = box[2] / side; y <= box[3] / side; y++)
        for (int x = box[0] / side; x <= box[1] / side; x++)
            rdo->next_batch[y * rdo->map_columns + x] = batch + 1;
}

/* Puts each splat, from the front to the back, into the first batch after those of all splats in front of it that it
 * may overlap; returns the number of batches. */
static int make_batches(gscl_codebook_rdo *rdo) {
    int batches = 0;
    memset(rdo->next_batch, 0, (size_t)rdo->map_columns * (size_t)rdo->map_rows * sizeof *rdo->next_batch);
    for (size_t i = gscl_codebook_splats(rdo->codebook); i-- > 0;) {
        const int batch = first_free_batch(rdo, rdo->boxes[i]);
        occupy_cells(rdo, rdo->boxes[i], batch);
        rdo->batch_of[i] = batch;
        if (batch + 1 > batches)
            batches = batch + 1;
    }
    return batches;
}

/* ---- The device ---- */

static gscl_result rdo_upload(gscl_codebook_rdo *rdo) {
    gscl_context *context = context_of(rdo);
    const size_t splats = gscl_codebook_splats(rdo->codebook);
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(gscl_buffer_write(context, &rdo->device_bits[b], 0, rdo->bits[b], GSF_MAX_CODEBOOK * sizeof(float)));
    GSCL_TRY(gscl_buffer_write(context, &rdo->device_cells, 0, rdo->cells, splats * sizeof *rdo->cells));
    return gscl_buffer_write(context, &rdo->device_boxes, 0, rdo->boxes, splats * sizeof *rdo->boxes);
}

/* Renders all splats into renderer->image; none is in front of the first. */
static gscl_result rdo_render(gscl_codebook_rdo *rdo) {
    gscl_renderer *r = &rdo->codebook->fit->renderer;
    const size_t plane = (size_t)gscl_renderer_plane(r) * sizeof(float);
    GSCL_TRY(gscl_renderer_bin(r, true));
    GSCL_TRY(gscl_renderer_draw(r));
    GSCL_TRY(gscl_buffer_zero(r->context, &rdo->front, 0, plane * (size_t)r->channels));
    return gscl_buffer_fill_ones(r->context, &rdo->transmittance, plane);
}

static gscl_result rdo_run_batch(gscl_codebook_rdo *rdo, size_t count) {
    gscl_codebook *c = rdo->codebook;
    gscl_renderer *r = &c->fit->renderer;
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_write(r->context, &rdo->device_batch, 0, rdo->batch, count * sizeof *rdo->batch));
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_CODEBOOK, &r->options, "word_rdo", &kernel));
    return GSCL_LAUNCH(
        r->context, kernel, count, gscl_rdo_group_size(r->context), GSCL_ARG_BUFFER(rdo->device_batch),
        GSCL_ARG_BUFFER(rdo->device_cells), GSCL_ARG_BUFFER(c->indices), GSCL_ARG_BUFFER(rdo->device_boxes),
        GSCL_ARG_BUFFER(c->books[GSCL_BOOK_SHAPE].stored), GSCL_ARG_BUFFER(c->books[GSCL_BOOK_COLOUR].stored),
        GSCL_ARG_BUFFER(rdo->device_bits[GSCL_BOOK_SHAPE]), GSCL_ARG_BUFFER(rdo->device_bits[GSCL_BOOK_COLOUR]),
        GSCL_ARG_BUFFER(r->image), GSCL_ARG_BUFFER(rdo->front), GSCL_ARG_BUFFER(rdo->transmittance),
        GSCL_ARG_BUFFER(c->fit->pyramid.levels[c->fit->level]), GSCL_ARG(rdo->settings));
}

static gscl_result rdo_run_batches(gscl_codebook_rdo *rdo, int batches) {
    const size_t splats = gscl_codebook_splats(rdo->codebook);
    for (int batch = 0; batch < batches; batch++) {
        size_t count = 0;
        for (size_t i = 0; i < splats; i++)
            if (rdo->batch_of[i] == batch)
                rdo->batch[count++] = (int32_t)i;
        GSCL_TRY(rdo_run_batch(rdo, count));
    }
    return GSCL_OK;
}

/* ---- The result of a pass ---- */

/* Moves the splats that were kept to the front of the host copies, at their new positions; returns their number. */
static size_t move_kept(gscl_codebook_rdo *rdo) {
    gscl_codebook *c = rdo->codebook;
    const size_t splats = gscl_codebook_splats(c);
    size_t kept = 0;
    for (size_t i = 0; i < splats; i++) {
        float *p = c->params + i * GSCL_PARAMS;
        if (c->pairs[i][GSCL_BOOK_SHAPE] < 0)
            continue;
        p[GSCL_X] = ((float)rdo->cells[i][0] + 0.5f) * rdo->settings.cell_x;
        p[GSCL_Y] = ((float)rdo->cells[i][1] + 0.5f) * rdo->settings.cell_y;
        rdo->kept[kept] = i;
        memmove(c->params + kept * GSCL_PARAMS, p, GSCL_PARAMS * sizeof *p);
        memmove(c->pairs[kept], c->pairs[i], sizeof c->pairs[i]);
        kept++;
    }
    return kept;
}

static gscl_result rdo_read_back(gscl_codebook_rdo *rdo) {
    gscl_codebook *c = rdo->codebook;
    const size_t splats = gscl_codebook_splats(c);
    GSCL_TRY(gscl_buffer_read(context_of(rdo), &c->indices, 0, c->pairs, splats * sizeof *c->pairs));
    GSCL_TRY(gscl_buffer_read(context_of(rdo), &rdo->device_cells, 0, rdo->cells, splats * sizeof *rdo->cells));
    const size_t kept = move_kept(rdo);
    GSCL_TRY(gscl_fit_reorder(c->fit, rdo->kept, kept));
    gscl_codebook_drop_unused(c);
    return gscl_codebook_upload(c);
}

gscl_result gscl_codebook_rdo_run(gscl_codebook_rdo *rdo, double lambda, bool keep_all) {
    gscl_codebook *c = rdo->codebook;
    const gscl_book *shapes = &c->books[GSCL_BOOK_SHAPE];
    const size_t splats = gscl_codebook_splats(c);
    if (splats == 0)
        return GSCL_OK;
    GSCL_TRY(gscl_codebook_read_back(c));
    GSCL_TRY(gscl_buffer_read(context_of(rdo), &shapes->stored, 0, rdo->shapes,
                              (size_t)shapes->count * GSCL_BOOK_DIMS * sizeof *rdo->shapes));
    rdo_set_settings(rdo, lambda, keep_all);
    for (int b = 0; b < GSCL_BOOKS; b++)
        count_bits_of_words(rdo, b);
    for (size_t i = 0; i < splats; i++) {
        find_cell(rdo, i);
        find_box(rdo, i);
    }
    const int batches = make_batches(rdo);
    GSCL_TRY(rdo_upload(rdo));
    GSCL_TRY(rdo_render(rdo));
    GSCL_TRY(rdo_run_batches(rdo, batches));
    return rdo_read_back(rdo);
}
