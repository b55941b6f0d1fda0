/* The renderer: splats on the device, projected into a view, binned and drawn.  The decoder and every step of the fit
 * share it, so that the encoder optimises exactly what the decoder draws. */
#ifndef GSCL_LIB_RENDERER_H
#define GSCL_LIB_RENDERER_H

#include "cl/structs.h"
#include "runtime/mapping.h"
#include "runtime/buffer.h"
#include "runtime/launch.h"
#include "runtime/staging.h"

/* The links of splats to their entries in the lists of the tiles (cl/links.cl).  The buffers have room for those of all
 * splats. */
typedef struct gscl_links {
    gscl_buffer grids; /* where those of each splat are */
    gscl_buffer links;
    gscl_buffer needed;      /* int32_t: links that the splats need */
    size_t capacity;         /* links of `links`; those of the last splats are left out where they do not fit */
    int32_t block;           /* splats of a block, whose links are counted; more than all: they are not; 0: no links */
    gscl_buffer block_links; /* of each block */
} gscl_links;

typedef struct gscl_renderer {
    gscl_context *context;
    gscl_kernel_options options; /* gscl_renderer_set_options sets these two */
    int channels;
    gscl_view view;
    int32_t width, height;       /* of the view, pixels: `height` of the rows that are drawn */
    int32_t row_step, first_row; /* of the view, which are drawn */
    int32_t view_height;         /* with all rows */
    float view_y;                /* origin of the view with all rows */
    int32_t count;               /* splats */
    int32_t row_capacity;        /* list entries that each row of tiles owns */
    int32_t *totals;             /* entries of each row of tiles, as last read from row_totals; lists may be shorter */
    int32_t totals_rows;         /* rows that totals has room for */
    int32_t totals_read;         /* rows that were read: those of the view at that time */
    uint64_t totals_wait;        /* waits of the context when they were last read: a later one has ended the copy */
    gscl_staging staged_params, staged_steps, staged_background;
    gscl_buffer params, steps, projected, ellipse_bounds, boxes, entries, tile_counts, tile_ranges, row_totals,
        background, image;
    gscl_buffer listed, listed_counts; /* splats by bands of rows of tiles */
    gscl_buffer samples;
} gscl_renderer;

/* `renderer` may hold anything before. */
gscl_result gscl_renderer_create(gscl_renderer *renderer, gscl_context *context, const gscl_kernel_options *options);
/* Sets the options that kernels are built with.  This alone changes them. */
void gscl_renderer_set_options(gscl_renderer *renderer, const gscl_kernel_options *options);
/* Accepts a renderer that was zeroed and never created. */
void gscl_renderer_free(gscl_renderer *renderer);

/* Sets the size and origin of what is drawn, in pixels of level `level` (0: full size). */
gscl_result gscl_renderer_set_view(gscl_renderer *renderer, int level, uint32_t x, uint32_t y, uint32_t width,
                                   uint32_t height);
/* Draws every `step`-th row of the view, from row `first` < `step` on; gscl_renderer_set_view draws all of them.  The
 * lists get as much more room as a row of tiles becomes higher. */
void gscl_renderer_set_rows(gscl_renderer *renderer, int step, int first);
/* Copies `count` splats (GSCL_PARAMS floats each) and a background colour to the device, without waiting. */
gscl_result gscl_renderer_set_splats(gscl_renderer *renderer, const float *params, size_t count,
                                     const float *background);
/* Replaces the background alone, likewise. */
gscl_result gscl_renderer_set_background(gscl_renderer *renderer, const float *background);
/* Like gscl_renderer_set_splats, without a copy on the host: both must stay valid until the queue has reached the copy
 * to the device (gscl_release_after_copies). */
gscl_result gscl_renderer_set_splats_async(gscl_renderer *renderer, const float *params, size_t count,
                                           const float *background);
/* Makes room for `count` splats without touching those that are there. */
gscl_result gscl_renderer_reserve(gscl_renderer *renderer, size_t count);
/* Sets the steps of the quantiser through which splats are projected (GSCL_STEP_COUNT floats), or NULL for none. */
gscl_result gscl_renderer_set_steps(gscl_renderer *renderer, const float *steps);

/* Computes the projected splats, the bounds of their ellipses and their boxes of tiles from the parameters. */
gscl_result gscl_renderer_project(gscl_renderer *renderer);
/* Fills the tiles' lists.  `exact` waits for the device and enlarges the lists where they are too short; otherwise a
 * list that overflows is cut short. */
gscl_result gscl_renderer_bin(gscl_renderer *renderer, bool exact);
/* The same without waiting, and links the entries to their splats. */
gscl_result gscl_renderer_bin_linked(gscl_renderer *renderer, const gscl_links *links);
/* What is known of the tiles' lists: they have room, or were cut short.  ENLARGED: they have more room now, which is empty
 * until they are filled again. */
typedef enum gscl_lists_state { GSCL_LISTS_KEPT, GSCL_LISTS_ENLARGED, GSCL_LISTS_CUT } gscl_lists_state;
/* Starts to read the lengths of the lists as last filled, without waiting. */
gscl_result gscl_renderer_begin_lengths(gscl_renderer *renderer);
/* After a wait, enlarges the lists (CUT, ENLARGED) where they have no room for `growth` times these lengths. */
gscl_result gscl_renderer_end_lengths(gscl_renderer *renderer, double growth, gscl_lists_state *state);
/* Whether lists of this capacity have room for the entries that are needed and for some more, and such a capacity. */
bool gscl_lists_have_room(size_t needed, size_t capacity);
size_t gscl_lists_capacity(size_t needed);
/* Makes room for renderer->image: planes of width * height floats. */
gscl_result gscl_renderer_reserve_image(gscl_renderer *renderer);
/* Draws the binned splats into it. */
gscl_result gscl_renderer_draw(gscl_renderer *renderer);
/* Projects, bins and draws. */
gscl_result gscl_renderer_render(gscl_renderer *renderer);
/* The same into an image in memory, rows `stride` bytes apart.  Waits once, for the image, unless a list was too short:
 * then it draws again. */
gscl_result gscl_renderer_samples(gscl_renderer *renderer, gscl_sample_layout layout, void *pixels, size_t stride);

/* Floats from the start of one plane of renderer->image to the next. */
static inline uint64_t gscl_renderer_plane(const gscl_renderer *r) {
    return (uint64_t)r->width * (uint64_t)r->height;
}
/* Tiles of the view. */
static inline size_t gscl_renderer_tiles(const gscl_renderer *r) {
    return (size_t)r->view.tiles_x * (size_t)r->view.tiles_y;
}
/* The shape of renderer->image, as kernels take it. */
static inline gscl_image_shape gscl_renderer_shape(const gscl_renderer *r) {
    return (gscl_image_shape){r->width, r->height, r->view.tiles_x, r->view.tiles_y};
}
/* Groups of `size` that cover `count` work-items. */
static inline size_t gscl_groups(size_t count, size_t size) {
    return (count + size - 1) / size;
}
/* Work-items of a group that handles GSCL_SPLATS_PER_GROUP splats with kernels of this program. */
static inline size_t gscl_splat_group_size(const gscl_context *context, gscl_program_kind kind) {
    return GSCL_SPLAT_ITEMS((size_t)gscl_splat_lanes(context, kind));
}
/* Buffers of splats have room for whole vectors of them. */
static inline size_t gscl_room_for_splats(size_t count) {
    return gscl_groups(count, GSCL_MAX_SPLAT_LANES) * GSCL_MAX_SPLAT_LANES;
}

#endif
