#include "decode/renderer.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/tunables.h"
#include "image/image.h"
#include "runtime/mapping.h"
#include "runtime/queue.h"
#include "runtime/vectors.h"

#define PADDING_ENTRIES 8 /* after the last list: searches load vectors of entries */

static const gscl_links no_links;

/* Fails to compile unless kernels and public interface number the kinds of samples alike. */
typedef char sample_kinds_agree[(int)GSCL_SAMPLE_U8 == GSCL_SAMPLE_KIND_U8 &&
                                        (int)GSCL_SAMPLE_U16 == GSCL_SAMPLE_KIND_U16 &&
                                        (int)GSCL_SAMPLE_F32 == GSCL_SAMPLE_KIND_F32
                                    ? 1
                                    : -1];

gscl_result gscl_renderer_create(gscl_renderer *r, gscl_context *context, const gscl_kernel_options *options) {
    memset(r, 0, sizeof *r);
    r->context = context;
    gscl_renderer_set_options(r, options);
    GSCL_TRY(gscl_buffer_reserve(context, &r->background, 4 * sizeof(float)));
    return gscl_renderer_set_steps(r, NULL);
}

void gscl_renderer_set_options(gscl_renderer *r, const gscl_kernel_options *options) {
    r->options = *options;
    r->channels = options->colours + options->alpha_channel;
}

void gscl_renderer_free(gscl_renderer *r) {
    gscl_buffer *buffers[] = {&r->params,  &r->steps,       &r->projected,     &r->ellipse_bounds, &r->boxes,
                              &r->entries, &r->tile_counts, &r->tile_ranges,   &r->row_totals,     &r->background,
                              &r->image,   &r->listed,      &r->listed_counts, &r->samples};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        gscl_buffer_free(buffers[i]);
    gscl_release_after_copies(r->context, r->totals); /* NULL in a renderer that was never created */
    r->totals = NULL;
    r->totals_rows = 0;
    gscl_staging_free(r->context, &r->staged_params);
    gscl_staging_free(r->context, &r->staged_steps);
    gscl_staging_free(r->context, &r->staged_background);
}

gscl_result gscl_renderer_set_view(gscl_renderer *r, int level, uint32_t x, uint32_t y, uint32_t width,
                                   uint32_t height) {
    float scale = (float)(1 << level);
    if (r->row_step > 1)
        r->row_capacity = (int32_t)gscl_groups((size_t)r->row_capacity, (size_t)r->row_step);
    r->row_step = 1;
    r->first_row = 0;
    r->width = (int32_t)width;
    r->height = r->view_height = (int32_t)height;
    r->view_y = (float)y;
    r->view = (gscl_view){.inv_scale = 1.0f / scale,
                          .row_scale = 1.0f,
                          .blur = (scale * scale - 1.0f) / 12.0f,
                          .x = (float)x,
                          .y = r->view_y,
                          .tiles_x = (int32_t)gscl_groups(width, GSCL_TILE),
                          .tiles_y = (int32_t)gscl_groups(height, GSCL_TILE)};
    size_t tiles = gscl_renderer_tiles(r);
    GSCL_TRY(gscl_buffer_reserve(r->context, &r->tile_ranges, tiles * sizeof(gscl_int2)));
    return gscl_buffer_reserve(r->context, &r->row_totals, (size_t)r->view.tiles_y * sizeof(int32_t));
}

/* The centres of the drawn rows, which are first + 1/2, first + step + 1/2, ..., become those of rows 0, 1, ... */
void gscl_renderer_set_rows(gscl_renderer *r, int step, int first) {
    if (step != r->row_step)
        r->row_capacity = (int32_t)gscl_groups((size_t)r->row_capacity * (size_t)step, (size_t)r->row_step);
    r->row_step = step;
    r->first_row = first;
    r->height = (int32_t)gscl_groups((size_t)(r->view_height - first), (size_t)step);
    r->view.row_scale = 1.0f / (float)step;
    r->view.y = (r->view_y + (float)first + 0.5f) / (float)step - 0.5f;
    r->view.tiles_y = (int32_t)gscl_groups(gscl_groups((size_t)r->view_height, (size_t)step), GSCL_TILE);
}

gscl_result gscl_renderer_reserve(gscl_renderer *r, size_t count) {
    size_t used = (size_t)r->count * GSCL_PARAMS * sizeof(float);
    count = gscl_room_for_splats(count);
    GSCL_TRY(gscl_buffer_grow(r->context, &r->params, count * GSCL_PARAMS * sizeof(float), used));
    GSCL_TRY(gscl_buffer_reserve(r->context, &r->projected, count * GSCL_PROJECTED * sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve(r->context, &r->ellipse_bounds, count * GSCL_BOUNDS * sizeof(float)));
    return gscl_buffer_reserve(r->context, &r->boxes, count * sizeof(gscl_int4));
}

gscl_result gscl_renderer_set_splats_async(gscl_renderer *r, const float *params, size_t count,
                                           const float *background) {
    r->count = 0;
    GSCL_TRY(gscl_renderer_reserve(r, count));
    GSCL_TRY(gscl_buffer_write_async(r->context, &r->params, 0, params, count * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_write_async(r->context, &r->background, 0, background, (size_t)r->channels * sizeof(float)));
    r->count = (int32_t)count;
    return GSCL_OK;
}

gscl_result gscl_renderer_set_background(gscl_renderer *r, const float *background) {
    return gscl_buffer_write_staged(r->context, &r->staged_background, &r->background, 0, background,
                                    (size_t)r->channels * sizeof(float));
}

gscl_result gscl_renderer_set_splats(gscl_renderer *r, const float *params, size_t count, const float *background) {
    r->count = 0;
    GSCL_TRY(gscl_renderer_reserve(r, count));
    GSCL_TRY(gscl_buffer_write_staged(r->context, &r->staged_params, &r->params, 0, params,
                                      count * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_renderer_set_background(r, background));
    r->count = (int32_t)count;
    return GSCL_OK;
}

gscl_result gscl_renderer_set_steps(gscl_renderer *r, const float *steps) {
    static const float none[GSCL_STEP_COUNT];
    GSCL_TRY(gscl_buffer_reserve(r->context, &r->steps, sizeof none));
    return gscl_buffer_write_staged(r->context, &r->staged_steps, &r->steps, 0, steps ? steps : none, sizeof none);
}

gscl_result gscl_renderer_project(gscl_renderer *r) {
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_RENDER, &r->options, "project", &kernel));
    return GSCL_LAUNCH(r->context, kernel, gscl_groups((size_t)r->count, GSCL_SPLATS_PER_GROUP),
                       gscl_splat_group_size(r->context, GSCL_PROGRAM_RENDER), GSCL_ARG_BUFFER(r->params),
                       GSCL_ARG_BUFFER(r->steps), GSCL_ARG(r->count), GSCL_ARG(r->view), GSCL_ARG_BUFFER(r->projected),
                       GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG_BUFFER(r->boxes));
}

gscl_result gscl_renderer_begin_lengths(gscl_renderer *r) {
    const size_t size = (size_t)r->view.tiles_y * sizeof *r->totals;
    if (r->totals_rows < r->view.tiles_y) {
        int32_t *totals = malloc(size);
        if (!totals)
            return gscl_fail_memory(r->context);
        if (r->totals_wait == r->context->waits)
            gscl_release_after_copies(r->context, r->totals);
        else
            free(r->totals);
        r->totals = totals;
        r->totals_rows = r->view.tiles_y;
    }
    r->totals_wait = r->context->waits;
    r->totals_read = r->view.tiles_y;
    return gscl_buffer_read_async(r->context, &r->row_totals, r->totals, size);
}

/* The largest number of entries of a row of tiles, as last read. */
static int32_t largest_row(const gscl_renderer *r) {
    int32_t largest = 0;
    for (int32_t i = 0; i < r->totals_read; i++)
        if (r->totals[i] > largest)
            largest = r->totals[i];
    return largest;
}

static gscl_result set_row_capacity(gscl_renderer *r, size_t capacity) {
    if (capacity > INT_MAX / (size_t)r->view.tiles_y)
        return gscl_fail(r->context, GSCL_ERROR_DEVICE_MEMORY, "the splats overlap too much to be drawn");
    r->row_capacity = (int32_t)capacity;
    size_t entries = capacity * (size_t)r->view.tiles_y + PADDING_ENTRIES;
    return gscl_buffer_reserve(r->context, &r->entries, entries * sizeof(uint32_t));
}

/* Whether the splats of each tile are counted where those of bands are listed. */
static bool has_counted_tiles(const gscl_renderer *r, const gscl_bin_settings *settings) {
    return gscl_bin_group_size(r->context) > 1 && settings->band_rows == 1 && settings->tiles_x <= GSCL_COUNTED_TILES;
}

/* Lists the splats of each band of rows of tiles, so that not every row goes over all splats, and numbers links. */
static gscl_result begin_lists(gscl_renderer *r, gscl_bin_settings settings, const gscl_links *links) {
    static const gscl_buffer none;
    const int32_t bands = (int32_t)gscl_groups((size_t)settings.tiles_y, (size_t)settings.band_rows);
    const int32_t capacity = (int32_t)links->capacity;
    const size_t link_groups = links->block > 0 ? gscl_groups((size_t)r->count, gscl_link_splats(r->context)) : 0;
    const gscl_buffer *tile_counts = has_counted_tiles(r, &settings) ? &r->tile_counts : &none;
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(r->context, &r->listed, (size_t)bands * (size_t)r->count * sizeof(int32_t)));
    GSCL_TRY(gscl_buffer_reserve(r->context, &r->listed_counts, (size_t)bands * sizeof(int32_t)));
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_BIN, &r->options, "begin_lists", &kernel));
    return GSCL_LAUNCH(r->context, kernel, (size_t)bands + link_groups, gscl_band_group_size(r->context),
                       GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG_BUFFER(r->boxes),
                       GSCL_ARG(settings), GSCL_ARG(bands), GSCL_ARG_BUFFER(r->listed),
                       GSCL_ARG_BUFFER(r->listed_counts), GSCL_ARG_BUFFER(*tile_counts), GSCL_ARG(links->block),
                       GSCL_ARG_BUFFER(links->block_links), GSCL_ARG(capacity), GSCL_ARG_BUFFER(links->grids),
                       GSCL_ARG_BUFFER(links->links), GSCL_ARG_BUFFER(links->needed));
}

/* Fills the lists by a work-item for each row of tiles. */
static gscl_result bin_rows(gscl_renderer *r, gscl_bin_settings settings, const gscl_links *links) {
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_BIN, &r->options, "bin", &kernel));
    return GSCL_LAUNCH(r->context, kernel, (size_t)r->view.tiles_y, gscl_bin_group_size(r->context),
                       GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG_BUFFER(r->boxes),
                       GSCL_ARG_BUFFER(r->listed), GSCL_ARG_BUFFER(r->listed_counts), GSCL_ARG_BUFFER(links->grids),
                       GSCL_ARG(settings), GSCL_ARG_BUFFER(r->entries), GSCL_ARG_BUFFER(r->tile_ranges),
                       GSCL_ARG_BUFFER(r->row_totals), GSCL_ARG_BUFFER(links->links));
}

static gscl_result count_tiles(gscl_renderer *r, gscl_bin_settings settings) {
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_BIN, &r->options, "bin_count", &kernel));
    return GSCL_LAUNCH(r->context, kernel, gscl_renderer_tiles(r), gscl_bin_group_size(r->context),
                       GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG_BUFFER(r->boxes),
                       GSCL_ARG_BUFFER(r->listed), GSCL_ARG_BUFFER(r->listed_counts), GSCL_ARG(settings),
                       GSCL_ARG_BUFFER(r->tile_counts));
}

/* Fills the lists by a work-group for each tile. */
static gscl_result bin_tiles(gscl_renderer *r, gscl_bin_settings settings, const gscl_links *links) {
    gscl_kernel *kernel;
    if (!has_counted_tiles(r, &settings))
        GSCL_TRY(count_tiles(r, settings));
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_BIN, &r->options, "bin", &kernel));
    return GSCL_LAUNCH(r->context, kernel, gscl_renderer_tiles(r), gscl_bin_group_size(r->context),
                       GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->ellipse_bounds), GSCL_ARG_BUFFER(r->boxes),
                       GSCL_ARG_BUFFER(r->listed), GSCL_ARG_BUFFER(r->listed_counts), GSCL_ARG_BUFFER(links->grids),
                       GSCL_ARG(settings), GSCL_ARG_BUFFER(r->tile_counts), GSCL_ARG_BUFFER(r->entries),
                       GSCL_ARG_BUFFER(r->tile_ranges), GSCL_ARG_BUFFER(r->row_totals), GSCL_ARG_BUFFER(links->links));
}

/* The most bands of rows of tiles whose splats are listed. */
static int32_t max_bands(const gscl_renderer *r) {
    const struct gscl_decode_tunables *t = &gscl_decode_tunables;
    const size_t listed = r->count > 0 ? t->gpu_listed / (size_t)r->count : 0;
    if (gscl_bin_group_size(r->context) == 1 || listed <= (size_t)t->max_bands)
        return t->max_bands;
    return listed < (size_t)t->gpu_max_bands ? (int32_t)listed : t->gpu_max_bands;
}

/* Rows of tiles of a band. */
static int32_t rows_of_bands(const gscl_renderer *r) {
    const int32_t rows = r->view.tiles_y, most = max_bands(r), bands = rows < most ? rows : most;
    return (rows + bands - 1) / bands;
}

static gscl_result launch_bin(gscl_renderer *r, const gscl_links *links) {
    const gscl_bin_settings settings = {.splats = r->count,
                                        .tiles_x = r->view.tiles_x,
                                        .tiles_y = r->view.tiles_y,
                                        .row_capacity = r->row_capacity,
                                        .band_rows = rows_of_bands(r)};
    const bool has_group_per_tile = gscl_bin_group_size(r->context) > 1;
    if (has_group_per_tile)
        GSCL_TRY(gscl_buffer_reserve(r->context, &r->tile_counts, gscl_renderer_tiles(r) * sizeof(int32_t)));
    GSCL_TRY(begin_lists(r, settings, links));
    return has_group_per_tile ? bin_tiles(r, settings, links) : bin_rows(r, settings, links);
}

/* The first capacity: an estimate, or that of the buffer. */
static size_t first_row_capacity(const gscl_renderer *r) {
    size_t held = r->entries.size / sizeof(uint32_t),
           estimate = (size_t)r->count + (size_t)gscl_decode_tunables.first_entries;
    held = held > PADDING_ENTRIES ? (held - PADDING_ENTRIES) / (size_t)r->view.tiles_y : 0;
    return held > estimate ? held : estimate;
}

bool gscl_lists_have_room(size_t needed, size_t capacity) {
    return needed + needed / (size_t)gscl_decode_tunables.spare_part <= capacity;
}

size_t gscl_lists_capacity(size_t needed) {
    return needed + needed / (size_t)gscl_decode_tunables.growth_part;
}

gscl_result gscl_renderer_bin_linked(gscl_renderer *r, const gscl_links *links) {
    if (r->row_capacity == 0)
        GSCL_TRY(set_row_capacity(r, first_row_capacity(r)));
    GSCL_TRY(set_row_capacity(r, (size_t)r->row_capacity)); /* the view may have more rows than before */
    return launch_bin(r, links);
}

gscl_result gscl_renderer_bin(gscl_renderer *r, bool exact) {
    GSCL_TRY(gscl_renderer_bin_linked(r, &no_links));
    if (!exact)
        return GSCL_OK;
    gscl_lists_state state;
    GSCL_TRY(gscl_renderer_begin_lengths(r));
    GSCL_TRY(gscl_finish(r->context));
    GSCL_TRY(gscl_renderer_end_lengths(r, 1, &state));
    return state == GSCL_LISTS_KEPT ? GSCL_OK : launch_bin(r, &no_links);
}

gscl_result gscl_renderer_end_lengths(gscl_renderer *r, double growth, gscl_lists_state *state) {
    const int32_t largest = largest_row(r);
    const double expected = growth * largest;
    *state = largest > r->row_capacity ? GSCL_LISTS_CUT : GSCL_LISTS_KEPT;
    if (expected < INT_MAX && gscl_lists_have_room((size_t)expected, (size_t)r->row_capacity))
        return GSCL_OK;
    if (*state == GSCL_LISTS_KEPT)
        *state = GSCL_LISTS_ENLARGED;
    return set_row_capacity(r, gscl_lists_capacity((size_t)expected));
}

gscl_result gscl_renderer_reserve_image(gscl_renderer *r) {
    const size_t floats = (size_t)gscl_renderer_plane(r) * (size_t)r->channels;
    return gscl_buffer_reserve_image(r->context, &r->image, floats * sizeof(float));
}

gscl_result gscl_renderer_draw(gscl_renderer *r) {
    gscl_kernel *kernel;
    const gscl_image_shape shape = gscl_renderer_shape(r);
    GSCL_TRY(gscl_renderer_reserve_image(r));
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_RENDER, &r->options, "raster_forward", &kernel));
    return GSCL_LAUNCH(r->context, kernel, gscl_renderer_tiles(r), gscl_tile_group_size(r->context),
                       GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->entries), GSCL_ARG_BUFFER(r->tile_ranges),
                       GSCL_ARG_BUFFER(r->background), GSCL_ARG_BUFFER(r->image), GSCL_ARG(shape));
}

gscl_result gscl_renderer_render(gscl_renderer *r) {
    GSCL_TRY(gscl_renderer_project(r));
    GSCL_TRY(gscl_renderer_bin(r, true));
    return gscl_renderer_draw(r);
}

static gscl_result launch_samples(gscl_renderer *r, gscl_sample_layout layout) {
    gscl_kernel *kernel;
    const gscl_image_shape shape = gscl_renderer_shape(r);
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_RENDER, &r->options, "raster_samples", &kernel));
    return GSCL_LAUNCH(r->context, kernel, gscl_renderer_tiles(r), gscl_tile_group_size(r->context),
                       GSCL_ARG_BUFFER(r->projected), GSCL_ARG_BUFFER(r->entries), GSCL_ARG_BUFFER(r->tile_ranges),
                       GSCL_ARG_BUFFER(r->background), GSCL_ARG(shape), GSCL_ARG(layout), GSCL_ARG_BUFFER(r->samples));
}

static gscl_result read_samples(gscl_renderer *r, size_t row, void *pixels, size_t stride) {
    size_t rows = (size_t)r->height;
    return stride == row ? gscl_buffer_read(r->context, &r->samples, 0, pixels, row * rows)
                         : gscl_buffer_read_rows(r->context, &r->samples, row, rows, pixels, stride);
}

/* The estimated capacity is nearly always enough, and waiting for the exact one takes as long as filling the lists. */
gscl_result gscl_renderer_samples(gscl_renderer *r, gscl_sample_layout layout, void *pixels, size_t stride) {
    size_t row = (size_t)r->width * (size_t)layout.channels * gscl_sample_size((gscl_sample)layout.sample);
    GSCL_TRY(gscl_buffer_reserve(r->context, &r->samples, row * (size_t)r->height));
    GSCL_TRY(gscl_renderer_project(r));
    for (;;) {
        GSCL_TRY(gscl_renderer_bin(r, false));
        GSCL_TRY(launch_samples(r, layout));
        GSCL_TRY(gscl_renderer_begin_lengths(r)); /* after the launch, as a driver may wait for the device in it */
        GSCL_TRY(read_samples(r, row, pixels, stride));
        const int32_t largest = largest_row(r);
        if (largest <= r->row_capacity)
            return GSCL_OK;
        GSCL_TRY(set_row_capacity(r, (size_t)largest));
    }
}
