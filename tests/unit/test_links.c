/* Links of splats to their entries in the lists of the tiles (cl/links.cl), in both mappings. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include <gscl/gscl.h>

#include "both_mappings.h"
#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/random.h"
#include "runtime/mapping.h"

/* Sizes of images, pixels: a small one; ones of more rows of tiles than bands in one mapping, and in both; one of more tiles in a
 * row than a group has work-items. */
static const uint32_t sizes[][2] = {{70, 45}, {40, 600}, {20, 4200}, {4200, 20}};
#define MAX_PIXELS (4200 * 20)
#define MANY 8500 /* splats: several blocks are counted */
#define FEW 300   /* those of more than one block, which are not counted */

/* What the device made of a fit's splats. */
typedef struct device_lists {
    size_t count, tiles, tiles_x;
    int32_t *boxes;
    gscl_link_grid *grids;
    int32_t *links;
    uint32_t *entries;
    int32_t *ranges; /* two of each tile */
    int32_t needed;
} device_lists;

static void *read_all(gscl_context *context, const gscl_buffer *buffer, size_t size) {
    void *data = malloc(size);
    assert_non_null(data);
    assert_true(size <= buffer->size);
    assert_int_equal(gscl_buffer_read(context, buffer, 0, data, size), GSCL_OK);
    return data;
}

static device_lists read_lists(const gscl_fit *fit) {
    gscl_context *context = fit->context;
    const gscl_renderer *r = &fit->renderer;
    device_lists lists = {
        .count = (size_t)r->count, .tiles = gscl_renderer_tiles(r), .tiles_x = (size_t)r->view.tiles_x};
    lists.boxes = read_all(context, &r->boxes, lists.count * 4 * sizeof(int32_t));
    lists.grids = read_all(context, &fit->links.grids, lists.count * sizeof(gscl_link_grid));
    lists.links = read_all(context, &fit->links.links, fit->links.capacity * sizeof(int32_t));
    lists.entries = read_all(context, &r->entries, r->entries.size);
    lists.ranges = read_all(context, &r->tile_ranges, lists.tiles * 2 * sizeof(int32_t));
    assert_int_equal(gscl_buffer_read(context, &fit->links.needed, 0, &lists.needed, sizeof lists.needed), GSCL_OK);
    return lists;
}

static void free_lists(device_lists *lists) {
    free(lists->boxes);
    free(lists->grids);
    free(lists->links);
    free(lists->entries);
    free(lists->ranges);
}

/* Splats of all sizes, some of them beyond the image. */
static void append_splats(gscl_fit *fit, size_t count, const uint32_t size[2]) {
    static float params[MANY * GSCL_PARAMS];
    uint64_t random = 1;
    for (size_t i = 0; i < count; i++) {
        float *p = params + i * GSCL_PARAMS;
        p[GSCL_X] = (float)(size[0] * (1.4 * gscl_random_unit(&random) - 0.2));
        p[GSCL_Y] = (float)(size[1] * (1.4 * gscl_random_unit(&random) - 0.2));
        p[GSCL_LOG_S1] = (float)(3 * gscl_random_unit(&random));
        p[GSCL_LOG_S2] = (float)(2 * gscl_random_unit(&random));
        p[GSCL_THETA] = (float)(3 * gscl_random_unit(&random));
    }
    assert_int_equal(gscl_fit_append(fit, params, count), GSCL_OK);
}

/* Links are numbered in the order of the splats; those that do not fit have none.  Returns how many there are. */
static int32_t check_numbers(const device_lists *lists, size_t capacity) {
    int32_t before = 0, used = 0;
    for (size_t i = 0; i < lists->count; i++) {
        const int32_t *box = lists->boxes + 4 * i;
        const gscl_link_grid *grid = &lists->grids[i];
        const bool is_empty = box[0] > box[1] || box[2] > box[3];
        const int32_t tiles = is_empty ? 0 : (box[1] - box[0] + 1) * (box[3] - box[2] + 1);
        const bool fits = (size_t)(before + tiles) <= capacity;
        assert_int_equal(grid->count, fits ? tiles : 0);
        if (fits) {
            assert_int_equal(grid->first, before);
            used = before + tiles;
        }
        before += tiles;
    }
    assert_int_equal(lists->needed, before);
    return used;
}

/* Each entry is linked at its tile; all other links are -1. */
static void check_entries(const device_lists *lists, int32_t used) {
    int32_t linked = 0, left = 0;
    for (size_t tile = 0; tile < lists->tiles; tile++)
        for (int32_t i = lists->ranges[2 * tile]; i < lists->ranges[2 * tile + 1]; i++) {
            const gscl_link_grid *grid = &lists->grids[GSCL_ENTRY_SPLAT(lists->entries[i])];
            const int32_t x = (int32_t)(tile % lists->tiles_x), y = (int32_t)(tile / lists->tiles_x);
            const int32_t link = grid->origin + y * grid->stride + x;
            if (grid->count == 0)
                continue;
            assert_in_range(link, grid->first, grid->first + grid->count - 1);
            assert_int_equal(lists->links[link], i);
            linked++;
        }
    for (int32_t k = 0; k < used; k++)
        left += lists->links[k] == -1;
    assert_true(linked > (int32_t)lists->count / 2);
    assert_int_equal(linked + left, used);
}

static void check_links(const gscl_fit *fit) {
    device_lists lists = read_lists(fit);
    check_entries(&lists, check_numbers(&lists, fit->links.capacity));
    free_lists(&lists);
}

static void check_fit(gscl_context *context, size_t count, const uint32_t size[2]) {
    static float planes[MAX_PIXELS];
    const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1};
    gscl_fit fit;
    assert_int_equal(gscl_fit_create(&fit, context, &options, size[0], size[1], 0, planes), GSCL_OK);
    append_splats(&fit, count, size);
    assert_int_equal(gscl_fit_bin(&fit, true), GSCL_OK);
    check_links(&fit);
    fit.links.capacity = 2 * (size_t)fit.reading->links / 3; /* too few, and the host does not look */
    assert_int_equal(gscl_fit_bin(&fit, false), GSCL_OK);
    check_links(&fit);
    gscl_fit_free(&fit);
}

static void test_entries_are_linked(void **unused) {
    (void)unused;
    for (int i = 0; i < mapping_count; i++) {
        assert_true(FEW > GSCL_LINK_BLOCK && FEW <= gscl_counted_links(contexts[i]));
        assert_true(MANY > gscl_counted_links(contexts[i]));
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
            check_fit(contexts[i], FEW, sizes[k]);
        check_fit(contexts[i], MANY, sizes[0]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_entries_are_linked)};
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
