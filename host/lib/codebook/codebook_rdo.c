/* Host side of cl/codebook_rdo.cl: prices, and which splats may be visited together. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "cl/structs.h"
#include "codebook/codebook.h"

#define CELL 16  /* pixels of the map that keeps visits apart */
#define ROOM 3.0 /* pixels around the outline */

typedef struct chooser {
    gscl_codebook *codebook;
    size_t count;
    gscl_word_rdo_settings settings;
    float *stored; /* shape words as they are drawn */
    float *bits[GSCL_BOOKS];
    cl_int (*cells)[2];
    cl_int (*boxes)[4];
    int *waves;     /* when each splat is visited */
    cl_int *visits; /* splats by wave */
    gscl_buffer d_bits[GSCL_BOOKS], d_cells, d_boxes, d_visits, front, through;
} chooser;

static void chooser_free(chooser *c) {
    free(c->stored);
    free(c->bits[0]);
    free(c->bits[1]);
    free(c->cells);
    free(c->boxes);
    free(c->waves);
    free(c->visits);
    gscl_buffer *buffers[] = {&c->d_bits[0], &c->d_bits[1], &c->d_cells, &c->d_boxes,
                              &c->d_visits,  &c->front,     &c->through};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        gscl_buffer_free(buffers[i]);
}

static gscl_result allocate(chooser *c) {
    size_t n = c->count + 1;
    c->stored = malloc(GSF_MAX_CODEBOOK * GSCL_BOOK_DIMS * sizeof(float));
    c->bits[0] = malloc(GSF_MAX_CODEBOOK * sizeof(float));
    c->bits[1] = malloc(GSF_MAX_CODEBOOK * sizeof(float));
    c->cells = malloc(n * sizeof *c->cells);
    c->boxes = malloc(n * sizeof *c->boxes);
    c->waves = malloc(n * sizeof *c->waves);
    c->visits = malloc(n * sizeof *c->visits);
    if (c->stored && c->bits[0] && c->bits[1] && c->cells && c->boxes && c->waves && c->visits)
        return GSCL_OK;
    return gscl_fail_memory(c->codebook->fit->context);
}

/* Bits of each word, from how often it is used; half a use for each so that none is impossible. */
static void price_words(chooser *c, int book) {
    int count = c->codebook->books[book].count;
    for (int k = 0; k < count; k++)
        c->bits[book][k] = 0.5f;
    for (size_t i = 0; i < c->count; i++)
        c->bits[book][c->codebook->pairs[i][book]] += 1.0f;
    for (int k = 0; k < count; k++)
        c->bits[book][k] = -log2f(c->bits[book][k] / ((float)c->count + 0.5f * (float)count));
}

static void half_size(const float *shape, double *width, double *height) {
    double s1 = exp(2.0 * shape[0]), s2 = exp(2.0 * shape[1]), c = cos(shape[2]), s = sin(shape[2]);
    *width = fmax(*width, sqrt(2 * GSCL_SUPPORT * (c * c * s1 + s * s * s2)));
    *height = fmax(*height, sqrt(2 * GSCL_SUPPORT * (s * s * s1 + c * c * s2)));
}

/* The pixels that a visit may touch: the outline with room for a move by a cell, clipped to the image. */
static void find_box(chooser *c, size_t i) {
    const gscl_fit *f = c->codebook->fit;
    int shape = c->codebook->pairs[i][0];
    double width = 0, height = 0, x = (c->cells[i][0] + 0.5) * c->settings.cell_x,
           y = (c->cells[i][1] + 0.5) * c->settings.cell_y;
    half_size(c->stored + shape * GSCL_BOOK_DIMS, &width, &height);
    width += ROOM + c->settings.cell_x;
    height += ROOM + c->settings.cell_y;
    c->boxes[i][0] = (cl_int)fmax(floor(x - width), 0);
    c->boxes[i][1] = (cl_int)fmin(ceil(x + width), f->renderer.width - 1);
    c->boxes[i][2] = (cl_int)fmax(floor(y - height), 0);
    c->boxes[i][3] = (cl_int)fmin(ceil(y + height), f->renderer.height - 1);
}

/* Puts each splat, from the front to the back, into the first wave after those of all splats in front of it that it
 * touches; returns the number of waves. */
static gscl_result make_waves(chooser *c, int *waves) {
    const gscl_renderer *r = &c->codebook->fit->renderer;
    int columns = (r->width + CELL - 1) / CELL, rows = (r->height + CELL - 1) / CELL;
    int *map = calloc((size_t)columns * (size_t)rows, sizeof *map);
    if (!map)
        return gscl_fail_memory(r->context);
    *waves = 0;
    for (size_t i = c->count; i-- > 0;) {
        const cl_int *b = c->boxes[i];
        int wave = 0;
        for (int y = b[2] / CELL; y <= b[3] / CELL; y++)
            for (int x = b[0] / CELL; x <= b[1] / CELL; x++)
                if (map[y * columns + x] > wave)
                    wave = map[y * columns + x];
        for (int y = b[2] / CELL; y <= b[3] / CELL; y++)
            for (int x = b[0] / CELL; x <= b[1] / CELL; x++)
                map[y * columns + x] = wave + 1;
        c->waves[i] = wave;
        if (wave + 1 > *waves)
            *waves = wave + 1;
    }
    free(map);
    return GSCL_OK;
}

static gscl_result upload_all(chooser *c) {
    gscl_context *context = c->codebook->fit->context;
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(gscl_buffer_upload(context, &c->d_bits[b], c->bits[b], GSF_MAX_CODEBOOK * sizeof(float)));
    GSCL_TRY(gscl_buffer_upload(context, &c->d_cells, c->cells, c->count * sizeof *c->cells));
    return gscl_buffer_upload(context, &c->d_boxes, c->boxes, c->count * sizeof *c->boxes);
}

/* Draws the picture into renderer->image; nothing is in front yet. */
static gscl_result begin(chooser *c) {
    gscl_renderer *r = &c->codebook->fit->renderer;
    size_t plane = (size_t)gscl_renderer_plane(r) * sizeof(float);
    const cl_float one = 1.0f;
    GSCL_TRY(gscl_renderer_bin(r, true));
    GSCL_TRY(gscl_renderer_draw(r));
    GSCL_TRY(gscl_buffer_reserve_image(r->context, &c->front, plane * (size_t)r->channels));
    GSCL_TRY(gscl_buffer_reserve_image(r->context, &c->through, plane));
    GSCL_TRY(gscl_buffer_zero(r->context, &c->front, 0, plane * (size_t)r->channels));
    GSCL_CL(r->context,
            clEnqueueFillBuffer(r->context->queue, c->through.memory, &one, sizeof one, 0, plane, 0, NULL, NULL));
    return GSCL_OK;
}

static gscl_result visit_wave(chooser *c, const cl_int *visits, cl_int count) {
    gscl_codebook *book = c->codebook;
    gscl_renderer *r = &book->fit->renderer;
    cl_ulong plane = gscl_renderer_plane(r);
    cl_kernel kernel;
    GSCL_TRY(gscl_buffer_upload(r->context, &c->d_visits, visits, (size_t)count * sizeof *visits));
    GSCL_TRY(gscl_kernel(r->context, GSCL_PROGRAM_CODEBOOK, &r->options, "choose_visit", &kernel));
    return GSCL_LAUNCH(r->context, kernel, (size_t)count, 1, GSCL_ARG_BUFFER(c->d_visits), GSCL_ARG(count),
                       GSCL_ARG_BUFFER(c->d_cells), GSCL_ARG_BUFFER(book->indices), GSCL_ARG_BUFFER(c->d_boxes),
                       GSCL_ARG_BUFFER(book->books[0].stored), GSCL_ARG_BUFFER(book->books[1].stored),
                       GSCL_ARG_BUFFER(c->d_bits[0]), GSCL_ARG_BUFFER(c->d_bits[1]), GSCL_ARG(c->settings),
                       GSCL_ARG(r->view), GSCL_ARG_BUFFER(r->image), GSCL_ARG_BUFFER(c->front),
                       GSCL_ARG_BUFFER(c->through), GSCL_ARG_BUFFER(book->fit->pyramid.levels[book->fit->level]),
                       GSCL_ARG(r->width), GSCL_ARG(r->height), GSCL_ARG(plane));
}

static gscl_result visit_all(chooser *c, int waves) {
    for (int wave = 0; wave < waves; wave++) {
        cl_int count = 0;
        for (size_t i = 0; i < c->count; i++)
            if (c->waves[i] == wave)
                c->visits[count++] = (cl_int)i;
        GSCL_TRY(visit_wave(c, c->visits, count));
    }
    return GSCL_OK;
}

/* Takes cells and words back, without the splats that were dropped. */
static gscl_result collect(chooser *c) {
    gscl_codebook *book = c->codebook;
    size_t kept = 0, row = GSCL_PARAMS * sizeof(float);
    GSCL_TRY(gscl_buffer_read(book->fit->context, &book->indices, 0, book->pairs, c->count * sizeof *book->pairs));
    GSCL_TRY(gscl_buffer_read(book->fit->context, &c->d_cells, 0, c->cells, c->count * sizeof *c->cells));
    size_t *order = malloc((c->count + 1) * sizeof *order);
    if (!order)
        return gscl_fail_memory(book->fit->context);
    for (size_t i = 0; i < c->count; i++) {
        float *p = book->params + i * GSCL_PARAMS;
        if (book->pairs[i][0] < 0)
            continue;
        p[GSCL_X] = ((float)c->cells[i][0] + 0.5f) * c->settings.cell_x;
        p[GSCL_Y] = ((float)c->cells[i][1] + 0.5f) * c->settings.cell_y;
        order[kept] = i;
        memmove(book->params + kept * GSCL_PARAMS, p, row);
        memmove(book->pairs[kept], book->pairs[i], sizeof book->pairs[i]);
        kept++;
    }
    gscl_result result = gscl_fit_reorder(book->fit, order, kept);
    free(order);
    gscl_codebook_compact(book);
    return result == GSCL_OK ? gscl_codebook_push(book) : result;
}

static gscl_result run(chooser *c, double lambda, bool keep_all) {
    gscl_codebook *book = c->codebook;
    gscl_fit *f = book->fit;
    int waves, last = (1 << book->position_bits) - 1;
    GSCL_TRY(allocate(c));
    GSCL_TRY(gscl_codebook_pull(book));
    GSCL_TRY(gscl_buffer_read(f->context, &book->books[0].stored, 0, c->stored,
                              (size_t)book->books[0].count * GSCL_BOOK_DIMS * sizeof(float)));
    c->settings = (gscl_word_rdo_settings){.lambda = (cl_float)lambda,
                                           .existence = (float)(2 * book->position_bits) - log2f((float)c->count),
                                           .leave_out = keep_all ? FLT_MAX : 0.0f,
                                           .cell_x = (cl_float)f->pyramid.width / (cl_float)(last + 1),
                                           .cell_y = (cl_float)f->pyramid.height / (cl_float)(last + 1),
                                           .last_x = last,
                                           .last_y = last,
                                           .colours = book->books[1].count};
    for (size_t i = 0; i < c->count; i++) {
        const float *p = book->params + i * GSCL_PARAMS;
        c->cells[i][0] = (cl_int)fmin(fmax(floor(p[GSCL_X] / c->settings.cell_x), 0), last);
        c->cells[i][1] = (cl_int)fmin(fmax(floor(p[GSCL_Y] / c->settings.cell_y), 0), last);
    }
    price_words(c, 0);
    price_words(c, 1);
    for (size_t i = 0; i < c->count; i++)
        find_box(c, i);
    GSCL_TRY(make_waves(c, &waves));
    GSCL_TRY(upload_all(c));
    GSCL_TRY(begin(c));
    GSCL_TRY(visit_all(c, waves));
    return collect(c);
}

gscl_result gscl_codebook_choose(gscl_codebook *codebook, double lambda, bool keep_all) {
    chooser c = {.codebook = codebook, .count = (size_t)codebook->fit->renderer.count};
    if (c.count == 0)
        return GSCL_OK;
    gscl_result result = run(&c, lambda, keep_all);
    chooser_free(&c);
    return result;
}
