#include "software/software.h"

#include <stdlib.h>

#include "cl/constants.h"
#include "image/image.h"
#include "software/canvas.h"
#include "software/projection.h"
#include "software/samples.h"

/* Rows of a splat that the outline touches: all splats are searched for those of each row of blocks. */
typedef struct row_range {
    uint16_t first, last;
} row_range;

struct gscl_software {
    gscl_kernel_options options;
    gscl_software_view view;
    uint32_t count;   /* splats that touch the image */
    uint32_t *listed; /* those of the current row of blocks, in their order */
    uint32_t listed_count;
    row_range *rows;
    gscl_ellipse *ellipses;
    gscl_canvas canvas;
};

gscl_software *gscl_software_create(const gscl_kernel_options *options, const gscl_software_view *view,
                                    uint32_t count) {
    gscl_software *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    s->options = *options;
    s->view = *view;
    s->listed = malloc(((size_t)count + 1) * sizeof *s->listed);
    s->rows = malloc(((size_t)count + 1) * sizeof *s->rows);
    s->ellipses = malloc(((size_t)count + 1) * sizeof *s->ellipses);
    if (!s->listed || !s->rows || !s->ellipses) {
        gscl_software_free(s);
        return NULL;
    }
    return s;
}

void gscl_software_free(gscl_software *s) {
    if (!s)
        return;
    free(s->listed);
    free(s->rows);
    free(s->ellipses);
    free(s);
}

void gscl_software_add(gscl_software *s, const float *params) {
    gscl_ellipse *e = &s->ellipses[s->count];
    if (!gscl_ellipse_project(&s->options, params, s->view.full_width, s->view.full_height, e))
        return;
    s->rows[s->count++] = (row_range){e->first_row, e->last_row};
}

/* Lists the splats of the rows of blocks that begin at `y`, front to back for blend `alpha`. */
static void list_splats(gscl_software *s, uint32_t y) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        s->listed[n] = i;
        n += s->rows[i].first < y + GSCL_BLOCK_ROWS && s->rows[i].last >= y;
    }
    s->listed_count = n;
}

/* Runs are counted in the list of all splats of these rows, and blocks begin at multiples of their size, so that no sum
 * depends on the rectangle. */
static void draw_block(gscl_software *s) {
    gscl_canvas *c = &s->canvas;
    const int last_column = c->x + c->width - 1;
    for (uint32_t i = 0; i < s->listed_count; i++) {
        const uint32_t at = s->options.blend == GSCL_ALPHA ? s->listed_count - 1 - i : i;
        const gscl_ellipse *e = &s->ellipses[s->listed[at]];
        if (i % GSCL_RUN == 0)
            gscl_canvas_end_run(c);
        if (e->first_column <= last_column && e->last_column >= c->x)
            gscl_canvas_draw(c, e);
    }
    gscl_canvas_end_run(c);
}

/* Stores the part of a block that lies in the rectangle. */
static void store_block(gscl_software *s, const float background[4], const gscl_image *image) {
    gscl_canvas *c = &s->canvas;
    const uint32_t x = (uint32_t)c->x, y = (uint32_t)c->y, left = x > s->view.x ? x : s->view.x;
    const uint32_t end = s->view.x + image->width, right = x + (uint32_t)c->width < end ? x + (uint32_t)c->width : end;
    const size_t pixel = image->channels * gscl_sample_size(image->sample), stride = gscl_image_stride(image);
    for (int row = 0; row < c->height; row++) {
        const uint32_t to = y + (uint32_t)row - s->view.y;
        if (y + (uint32_t)row < s->view.y || to >= image->height)
            continue;
        gscl_canvas_finish_row(c, row, background);
        float *values[4];
        for (int k = 0; k < 4; k++)
            values[k] = c->total[k] + (size_t)row * GSCL_CANVAS_STRIDE + (left - x);
        gscl_store_samples(image, values, s->options.colours, s->options.alpha_channel != 0, (int)(right - left),
                           (unsigned char *)image->pixels + to * stride + (left - s->view.x) * pixel);
    }
}

static int lesser(uint32_t a, uint32_t b) {
    return (int)(a < b ? a : b);
}

void gscl_software_draw_rows(gscl_software *s, const float background[4], const gscl_image *image, uint32_t *row) {
    const gscl_software_view *v = &s->view;
    gscl_canvas *c = &s->canvas;
    const uint32_t y = (v->y + *row) / GSCL_BLOCK_ROWS * GSCL_BLOCK_ROWS;
    c->blend = s->options.blend;
    c->colours = s->options.colours;
    c->channels = s->options.colours + s->options.alpha_channel;
    c->image_width = (int)v->full_width;
    list_splats(s, y);
    c->y = (int)y;
    c->height = lesser(GSCL_BLOCK_ROWS, v->full_height - y);
    for (uint32_t x = v->x / GSCL_BLOCK_COLUMNS * GSCL_BLOCK_COLUMNS; x < v->x + image->width;
         x += GSCL_BLOCK_COLUMNS) {
        c->x = (int)x;
        c->width = lesser(GSCL_BLOCK_COLUMNS, v->full_width - x);
        gscl_canvas_begin(c, background);
        draw_block(s);
        store_block(s, background, image);
    }
    *row = (uint32_t)lesser(y + GSCL_BLOCK_ROWS - v->y, image->height);
}

void gscl_software_draw(gscl_software *s, const float background[4], const gscl_image *image) {
    for (uint32_t row = 0; row < image->height;)
        gscl_software_draw_rows(s, background, image, &row);
}
