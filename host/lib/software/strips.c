#include "software/strips.h"

#include "cl/constants.h"
#include "image/image.h"
#include "software/samples.h"

#define NO_BAND UINT32_MAX

size_t gscl_strips_memory(const gscl_kernel_options *options, int columns, int rows, uint32_t count) {
    return ((size_t)count + 1) * (sizeof(gscl_box) + sizeof(uint32_t)) +
           gscl_canvas_floats(options, columns, rows) * sizeof(float);
}

void gscl_strips_begin(gscl_strips *s, uint32_t full_width, uint32_t count, void *memory) {
    s->count = 0;
    s->band = NO_BAND;
    s->boxes = memory;
    s->listed = (uint32_t *)(s->boxes + count);
    s->canvas.image_width = (int)full_width;
    /* Listing writes one number beyond the last splat. */
    gscl_canvas_init(&s->canvas, s->options, s->columns, s->rows, (float *)(s->listed + count + 1));
}

/* Lists the splats of a band of rows, which begins at a multiple of GSCL_BLOCK_ROWS. */
static void list_splats(gscl_strips *s, uint32_t band) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        s->listed[n] = i;
        n += s->boxes[i].first_row < band + GSCL_BLOCK_ROWS && s->boxes[i].last_row >= band;
    }
    s->listed_count = n;
    s->band = band;
}

static bool touches(const gscl_box *box, const gscl_canvas *c) {
    return box->first_column < c->x + c->width && box->last_column >= c->x && box->first_row < c->y + c->height &&
           box->last_row >= c->y;
}

/* Runs are counted in the list of all splats of the band, front to back for blend `alpha`, so that no sum depends on the
 * block. */
static void draw_block(gscl_strips *s) {
    gscl_canvas *c = &s->canvas;
    gscl_ellipse room;
    for (uint32_t i = 0; i < s->listed_count; i++) {
        const uint32_t at = s->options->blend == GSCL_ALPHA ? s->listed_count - 1 - i : i, splat = s->listed[at];
        if (i % GSCL_RUN == 0)
            gscl_canvas_end_run(c);
        if (touches(&s->boxes[splat], c))
            gscl_canvas_draw(c, s->source(s->owner, splat, &room));
    }
    gscl_canvas_end_run(c);
}

static uint32_t lesser(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Stores the part of a block that lies in the image, whose left column is column `x` of the drawn image.  `to`: the row of
 * the image where the block begins. */
static void store_block(gscl_strips *s, uint32_t x, uint32_t to, const gscl_image *image) {
    gscl_canvas *c = &s->canvas;
    const uint32_t first = (uint32_t)c->x, left = first > x ? first : x, end = x + image->width;
    const uint32_t right = lesser(first + (uint32_t)c->width, end);
    const size_t pixel = image->channels * gscl_sample_size(image->sample);
    const ptrdiff_t stride = gscl_image_stride(image);
    unsigned char *at = (unsigned char *)image->pixels + (ptrdiff_t)to * stride + (left - x) * pixel;
    for (int row = 0; row < c->height; row++, at += stride) {
        float *values[4];
        for (int k = 0; k < c->channels; k++)
            values[k] = c->total + k * c->plane + row * c->stride + (left - first);
        gscl_store_samples(image, values, s->options->colours, s->options->alpha_channel != 0, (int)(right - left), at);
    }
}

/* Draws the rows of the canvas, the first of which is row `to` of the image. */
static void draw_blocks(gscl_strips *s, uint32_t x, uint32_t to, const float background[4], const gscl_image *image) {
    gscl_canvas *c = &s->canvas;
    const uint32_t columns = (uint32_t)s->columns;
    for (uint32_t left = x / columns * columns; left < x + image->width; left += columns) {
        const uint32_t rest = (uint32_t)c->image_width - left;
        c->x = (int)left;
        c->width = (int)lesser(rest, columns);
        gscl_canvas_begin(c, background);
        draw_block(s);
        gscl_canvas_finish(c, background);
        store_block(s, x, to, image);
    }
}

void gscl_strips_draw(gscl_strips *s, uint32_t x, uint32_t y, const float background[4], const gscl_image *image) {
    gscl_canvas *c = &s->canvas;
    for (uint32_t row = 0; row < image->height; row += (uint32_t)c->height) {
        const uint32_t first = y + row, band = first & -(uint32_t)GSCL_BLOCK_ROWS;
        if (band != s->band)
            list_splats(s, band);
        c->y = (int)first;
        c->height = (int)lesser(lesser((uint32_t)s->rows, band + GSCL_BLOCK_ROWS - first), image->height - row);
        draw_blocks(s, x, row, background, image);
    }
}
