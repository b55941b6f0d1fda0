#include "software/software.h"

#include <stdlib.h>

#include "image/image.h"
#include "software/projection.h"
#include "software/strips.h"

struct gscl_software {
    gscl_strips strips;
    gscl_software_view view;
    gscl_ellipse *ellipses; /* of the splats that touch the image */
};

static const gscl_ellipse *kept_ellipse(void *owner, uint32_t i, gscl_ellipse *room) {
    (void)room;
    return &((const gscl_ellipse *)owner)[i];
}

gscl_software *gscl_software_create(const gscl_kernel_options *options, const gscl_software_view *view,
                                    uint32_t count) {
    const size_t ellipses =
        ((size_t)count + 1) * sizeof(gscl_ellipse); /* a splat that does not touch the image has room */
    gscl_software *s =
        malloc(sizeof *s + ellipses + gscl_strips_memory(options, GSCL_BLOCK_COLUMNS, GSCL_BLOCK_ROWS, count));
    if (!s)
        return NULL;
    s->view = *view;
    s->ellipses = (gscl_ellipse *)(s + 1);
    s->strips.options = options;
    s->strips.source = kept_ellipse;
    s->strips.owner = s->ellipses;
    s->strips.columns = GSCL_BLOCK_COLUMNS;
    s->strips.rows = GSCL_BLOCK_ROWS;
    gscl_strips_begin(&s->strips, view->full_width, count, s->ellipses + count + 1);
    return s;
}

void gscl_software_free(gscl_software *s) {
    free(s);
}

void gscl_software_add(gscl_software *s, const float *params) {
    gscl_ellipse *e = &s->ellipses[s->strips.count];
    if (gscl_ellipse_project(s->strips.options, params, s->view.full_width, s->view.full_height, e))
        gscl_strips_add(&s->strips, e->box);
}

uint32_t gscl_software_rows(const gscl_software *s, uint32_t row, uint32_t height) {
    const uint32_t to_band = GSCL_BLOCK_ROWS - (s->view.y + row) % GSCL_BLOCK_ROWS, left = height - row;
    return to_band < left ? to_band : left;
}

void gscl_software_draw_rows(gscl_software *s, const float background[4], uint32_t row, const gscl_image *rows) {
    gscl_strips_draw(&s->strips, s->view.x, s->view.y + row, background, rows);
}

void gscl_software_draw(gscl_software *s, const float background[4], const gscl_image *image) {
    gscl_strips_draw(&s->strips, s->view.x, s->view.y, background, image);
}
