#include "decode/draw_rows.h"

#include "cl/constants.h"
#include "decode/dequantise.h"
#include "image/image.h"
#include "software/strips.h"

/* What a drawing reads while it draws. */
typedef struct drawing {
    const gsf_coded_image *coded;
    const gscl_rows *rows;
    gscl_kernel_options options;
    float background[4];
    gscl_strips strips;
} drawing;

static uint32_t lesser(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Columns of a block: those of a narrow image take less memory. */
static int block_columns(const gscl_frame *f) {
    return (int)(lesser(f->full_width + GSCL_ROW_LANES - 1, GSCL_BLOCK_COLUMNS) & -GSCL_ROW_LANES);
}

/* Rows of a strip where blocks have so many rows. */
static uint32_t strip_height(const gscl_rows *rows, uint32_t block_rows) {
    return lesser(rows->strip_rows ? rows->strip_rows : block_rows, rows->frame.height);
}

/* Memory for the sums of blocks of so many rows. */
static size_t strips_memory(const gsf_header *header, const gscl_rows *rows, uint32_t block_rows) {
    const gscl_kernel_options options = gscl_frame_options(header, &rows->frame);
    return gscl_strips_memory(&options, block_columns(&rows->frame), (int)block_rows, header->splat_count);
}

static uint64_t memory_for(const gsf_header *header, const gscl_rows *rows, uint32_t block_rows) {
    const uint64_t row = gscl_image_row_size(&rows->output.drawn); /* at most 2^18 */
    return strips_memory(header, rows, block_rows) + row * strip_height(rows, block_rows);
}

uint64_t gscl_draw_rows_memory(const gsf_header *header, const gscl_rows *rows) {
    return memory_for(header, rows, 1);
}

/* The most rows of a block for which there is memory; 0: none. */
static uint32_t largest_block(const gsf_header *header, const gscl_rows *rows, size_t memory_size) {
    uint32_t block_rows = strip_height(rows, GSCL_BLOCK_ROWS);
    block_rows = lesser(block_rows, GSCL_BLOCK_ROWS);
    while (block_rows > 0 && memory_for(header, rows, block_rows) > memory_size)
        block_rows--;
    return block_rows;
}

/* Splats are projected again for each block that they touch, because their ellipses would take more memory than all else. */
static bool project_splat(const drawing *d, uint32_t i, float *params, gscl_ellipse *e) {
    const gscl_frame *f = &d->rows->frame;
    gscl_frame_splat(d->coded, i, f, params);
    return gscl_ellipse_project(&d->options, params, f->full_width, f->full_height, e);
}

static const gscl_ellipse *projected_splat(void *owner, uint32_t i, gscl_ellipse *room) {
    float params[GSCL_PARAMS];
    project_splat(owner, i, params, room);
    return room;
}

/* Adds the boxes of all splats, and computes the background. */
static void add_splats(drawing *d) {
    const gsf_header *header = &d->coded->header;
    gscl_real sums[4] = {0};
    for (uint32_t i = 0; i < header->splat_count; i++) {
        float params[GSCL_PARAMS];
        gscl_ellipse e;
        gscl_strips_add(&d->strips, project_splat(d, i, params, &e) ? e.box : GSCL_NO_BOX);
        for (unsigned k = 0; k < gsf_channel_count(header); k++)
            sums[k] += params[GSCL_COLOUR + k];
    }
    gscl_dequantise_background(d->coded, sums, d->background);
}

static gscl_result draw_strips(drawing *d, uint32_t height, void *pixels) {
    const gscl_rows *rows = d->rows;
    const gscl_frame *f = &rows->frame;
    gscl_image strip = rows->output.image;
    strip.pixels = pixels;
    for (uint32_t y = 0; y < f->height; y += height) {
        strip.height = lesser(height, f->height - y);
        const gscl_image target = gscl_output_target(&rows->output, &strip, pixels);
        gscl_strips_draw(&d->strips, f->x, f->y + y, d->background, &target);
        gscl_output_finish(&rows->output, &target, &strip);
        if (!rows->callback(rows->opaque, y, &strip))
            return GSCL_ERROR_CANCELLED;
    }
    return GSCL_OK;
}

gscl_result gscl_draw_rows(const gsf_coded_image *coded, const gscl_rows *rows, void *memory, size_t memory_size) {
    const gsf_header *header = &coded->header;
    const uint32_t block_rows = largest_block(header, rows, memory_size);
    if (block_rows == 0)
        return GSCL_ERROR_OUT_OF_MEMORY;
    drawing d = {.coded = coded, .rows = rows, .options = gscl_frame_options(header, &rows->frame)};
    d.strips.options = &d.options;
    d.strips.columns = block_columns(&rows->frame);
    d.strips.rows = (int)block_rows;
    d.strips.source = projected_splat;
    d.strips.owner = &d;
    gscl_strips_begin(&d.strips, rows->frame.full_width, header->splat_count, memory);
    add_splats(&d);
    return draw_strips(&d, strip_height(rows, block_rows),
                       (unsigned char *)memory + strips_memory(header, rows, block_rows));
}
