/* Packets in format/: which cells each may have, and lists of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "format/classes.h"
#include "format/packet.h"
#include "format/quantiser.h"
#include "synthetic_packets.h"

enum { SPLATS = 150 };

/* ---- Cells ---- */

/* How often each cell of a class occurs in the grids of all packets. */
static uint8_t *count_cells(gsf_coded_image *image, uint32_t class_no, const gsf_grid *whole, uint32_t packets) {
    uint8_t *found = calloc((size_t)whole->cells_x * whole->cells_y, 1);
    assert_non_null(found);
    for (uint32_t k = 0; k < packets; k++) {
        image->header.packets = (uint16_t)packets;
        image->header.packet = (uint8_t)k;
        const gsf_grid grid = gsf_class_grid(image, class_no);
        for (uint32_t x = 0; x < grid.cells_x; x++)
            for (uint32_t y = 0; y < grid.cells_y; y++) {
                const gsf_point cell = gsf_class_cell(image, class_no, (gsf_point){x, y});
                assert_true(cell.x < whole->cells_x && cell.y < whole->cells_y);
                image->splats[0].x = cell.x;
                image->splats[0].y = cell.y;
                const gsf_point point = gsf_class_point(image, 0);
                assert_true(point.x == x && point.y == y);
                assert_true(gsf_packet_may_hold(image, 0, packets, k));
                found[cell.y * whole->cells_x + cell.x]++;
            }
    }
    return found;
}

/* Every cell belongs to as many packets as may have it: to all in a class with few cells; else to one, but in the last row or
 * column to one at least. */
static void check_class(gsf_coded_image *image, unsigned major, uint32_t packets) {
    const uint32_t class_no = GSF_MAX_SCALE_CODE - major;
    image->header.packets = 0;
    image->splats[0] = (gsf_splat){.major = (uint16_t)major};
    const gsf_grid whole = gsf_class_grid(image, class_no);
    const uint32_t cells = whole.cells_x >= whole.cells_y ? whole.cells_x : whole.cells_y;
    const bool is_part = packets > 1 && cells >= 2 * packets, in_x = whole.cells_x >= whole.cells_y;
    uint8_t *found = count_cells(image, class_no, &whole, packets);
    for (uint32_t x = 0; x < whole.cells_x; x++)
        for (uint32_t y = 0; y < whole.cells_y; y++) {
            uint32_t may_hold = 0;
            image->splats[0].x = x;
            image->splats[0].y = y;
            for (uint32_t k = 0; k < packets; k++)
                may_hold += gsf_packet_may_hold(image, 0, packets, k);
            assert_int_equal(may_hold, found[y * whole.cells_x + x]);
            if (!is_part)
                assert_int_equal(may_hold, packets);
            else if ((in_x ? x : y) + 1 < cells)
                assert_int_equal(may_hold, 1);
            else
                assert_in_range(may_hold, 1, packets);
        }
    free(found);
}

static void test_cells(void **unused) {
    (void)unused;
    static const uint32_t sizes[][2] = {{31, 20}, {20, 31}, {17, 17}, {100, 1}, {1, 100}, {3, 2}};
    static const uint32_t counts[] = {1, 2, 3, 5, 7, 12, 40, 100};
    const gsf_header header = {.layout = GSF_GREY, .splat_count = 1, .width = 1, .height = 1};
    synthetic_scene *scene = synthetic_scene_new(&header);
    assert_non_null(scene);
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
            for (unsigned major = 0; major < 30; major += 3) {
                scene->image.header.width = sizes[s][0];
                scene->image.header.height = sizes[s][1];
                scene->image.steps = (gsf_steps){.scale = 6, .position = 4};
                check_class(&scene->image, major, counts[c]);
            }
    synthetic_scene_free(scene);
}

/* ---- Lists ---- */

/* Reads a list; the caller frees the scene. */
static synthetic_scene *read_list(const uint8_t *list, size_t size) {
    gsf_header header;
    assert_int_equal(gsf_read_header(list, size, false, &header), GSF_OK);
    synthetic_scene *scene = synthetic_scene_new(&header);
    void *scratch = malloc(gsf_scratch_size(&header));
    assert_true(scene && scratch);
    assert_int_equal(gsf_read(list, size, &scene->image, scratch), GSF_OK);
    assert_true(scene->image.header.splat_count <= header.splat_count);
    free(scratch);
    return scene;
}

/* Where there is no header, reading has the same result. */
static gsf_result result_of_list(const uint8_t *list, size_t size) {
    gsf_header header;
    gsf_coded_image none = {.bare = false};
    const gsf_result result = gsf_read_header(list, size, false, &header);
    if (result != GSF_OK) {
        assert_int_equal(gsf_read(list, size, &none, NULL), result);
        return result;
    }
    synthetic_scene *scene = synthetic_scene_new(&header);
    void *scratch = malloc(gsf_scratch_size(&header));
    assert_true(scene && scratch);
    const gsf_result of_splats = gsf_read(list, size, &scene->image, scratch);
    free(scratch);
    synthetic_scene_free(scene);
    return of_splats;
}

/* Sorts the splats of a scene, and removes all but one of equal ones. */
static void make_distinct(gsf_coded_image *image) {
    uint32_t kept = 0;
    void *scratch = malloc(gsf_scratch_size(&image->header));
    assert_non_null(scratch);
    gsf_sort(image, scratch);
    free(scratch);
    for (uint32_t i = 0; i < image->header.splat_count; i++)
        if (kept == 0 || memcmp(&image->splats[i], &image->splats[kept - 1], sizeof *image->splats) != 0)
            image->splats[kept++] = image->splats[i];
    image->header.splat_count = kept;
}

static void assert_equal_splats(const gsf_coded_image *a, const gsf_coded_image *b) {
    assert_int_equal(a->header.splat_count, b->header.splat_count);
    assert_memory_equal(a->splats, b->splats, a->header.splat_count * sizeof *a->splats);
    assert_int_equal(a->has_mean_background, b->has_mean_background);
    assert_memory_equal(&a->steps, &b->steps, sizeof a->steps);
    assert_int_equal(a->header.blend, b->header.blend);
    assert_int_equal(a->header.width, b->header.width);
    assert_int_equal(a->header.packets, 0);
}

/* Reads packets in an order of its own and compares them with the scene. */
static void check_list(const synthetic_packets *packets, const gsf_coded_image *expected) {
    uint32_t numbers[GSF_MAX_PACKETS];
    size_t size;
    for (uint32_t i = 0; i < packets->count; i++)
        numbers[i] = i;
    for (uint32_t i = packets->count - 1; i > 0; i--) {
        const uint32_t j = synthetic_random(i + 1), number = numbers[i];
        numbers[i] = numbers[j];
        numbers[j] = number;
    }
    uint8_t *list = synthetic_list(packets, numbers, packets->count, &size);
    assert_non_null(list);
    synthetic_scene *read = read_list(list, size);
    assert_int_equal(read->image.packets_read, packets->count);
    assert_equal_splats(&read->image, expected);
    synthetic_scene_free(read);
    free(list);
}

static void check_round_trip(int number, uint32_t width, uint32_t height, uint32_t count) {
    synthetic_packets packets;
    synthetic_scene *scene = synthetic_divisible_scene(number, width, height, SPLATS);
    assert_non_null(scene);
    assert_true(synthetic_packets_write(&scene->image, count, 0, 7, &packets));
    make_distinct(&scene->image);
    if (!scene->image.header.has_chroma)
        scene->image.steps.chroma = 0;
    if (!scene->image.header.has_alpha)
        scene->image.steps.alpha = 0;
    check_list(&packets, &scene->image);
    synthetic_packets_free(&packets);
    synthetic_scene_free(scene);
}

static void test_round_trips(void **unused) {
    (void)unused;
    static const uint32_t counts[] = {1, 2, 3, 7, 40, 256};
    synthetic_random_state = 5;
    for (int number = 0; number < 12; number++)
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
            check_round_trip(number, 90, 60, counts[c]);
            check_round_trip(number, 20, 300, counts[c]);
            check_round_trip(number, 3, 2, counts[c]);
        }
}

/* The splats of each packet are those of the list that has it alone, and no packet has them all. */
static void test_single_packets(void **unused) {
    (void)unused;
    synthetic_packets packets;
    uint32_t sum = 0;
    size_t size;
    synthetic_scene *scene = synthetic_divisible_scene(2, 90, 60, SPLATS);
    assert_non_null(scene);
    assert_true(synthetic_packets_write(&scene->image, 5, 0, 7, &packets));
    for (uint32_t k = 0; k < 5; k++) {
        uint8_t *list = synthetic_list(&packets, &k, 1, &size);
        synthetic_scene *read = read_list(list, size);
        assert_in_range(read->image.header.splat_count, SPLATS / 5 / 2, SPLATS / 5 * 2);
        sum += read->image.header.splat_count;
        for (uint32_t i = 0; i < read->image.header.splat_count; i++)
            assert_true(gsf_packet_may_hold(&read->image, i, 5, k));
        synthetic_scene_free(read);
        free(list);
    }
    make_distinct(&scene->image);
    assert_int_equal(sum, scene->image.header.splat_count);
    synthetic_packets_free(&packets);
    synthetic_scene_free(scene);
}

/* A scene whose packets are all empty but the first. */
static void test_empty_packets(void **unused) {
    (void)unused;
    static const uint32_t order[] = {3, 2, 0, 1};
    synthetic_packets packets;
    size_t size;
    synthetic_scene *scene = synthetic_divisible_scene(1, 90, 60, 1);
    assert_non_null(scene);
    scene->image.splats[0] = (gsf_splat){.major = 40};
    assert_true(synthetic_packets_write(&scene->image, 4, 0, 7, &packets));
    uint8_t *list = synthetic_list(&packets, order, 4, &size);
    synthetic_scene *read = read_list(list, size);
    assert_int_equal(read->image.header.splat_count, 1);
    assert_int_equal(read->image.packets_read, 4);
    assert_true(read->image.has_mean_background);
    assert_int_equal(read->image.steps.scale, 6);
    synthetic_scene_free(read);
    free(list);
    synthetic_packets_free(&packets);
    synthetic_scene_free(scene);
}

/* Packets that are no good for a list are skipped: damaged, of another identity, repeated. */
static void test_mixed_lists(void **unused) {
    (void)unused;
    static const uint32_t order[] = {0, 7, 4, 5, 1, 1, 6, 2, 0, 3};
    synthetic_packets packets, others;
    size_t size;
    synthetic_random_state = 9;
    synthetic_scene *scene = synthetic_divisible_scene(6, 70, 50, SPLATS);
    assert_non_null(scene);
    for (uint32_t i = 0; i < SPLATS; i++)
        scene->image.splats[i].luma = 1;
    assert_true(synthetic_packets_write(&scene->image, 4, 0, 8, &others));
    for (uint32_t i = 0; i < SPLATS; i++)
        scene->image.splats[i].luma = 0;
    assert_true(synthetic_packets_write(&scene->image, 4, 0, 7, &packets));
    memcpy(packets.packets + 4, others.packets, 4 * sizeof *others.packets);
    ((uint8_t *)others.packets[0].data)[5] ^= 4;
    uint8_t *list = synthetic_list(&packets, order, sizeof order / sizeof *order, &size);
    synthetic_scene *read = read_list(list, size);
    make_distinct(&scene->image);
    assert_int_equal(read->image.packets_read, 4);
    assert_int_equal(read->image.header.splat_count, scene->image.header.splat_count);
    assert_memory_equal(read->image.splats, scene->image.splats,
                        read->image.header.splat_count * sizeof *read->image.splats);
    synthetic_scene_free(read);
    free(list);
    synthetic_packets_free(&packets);
    synthetic_packets_free(&others);
    synthetic_scene_free(scene);
}

static void test_refused_lists(void **unused) {
    (void)unused;
    static const uint32_t order[] = {0, 1};
    synthetic_packets packets;
    size_t size;
    synthetic_scene *scene = synthetic_divisible_scene(3, 40, 30, 20);
    assert_non_null(scene);
    assert_true(synthetic_packets_write(&scene->image, 2, 0, 7, &packets));
    uint8_t *list = synthetic_list(&packets, order, 2, &size);
    const size_t first = 5 + packets.packets[0].size;
    for (size_t cut = 0; cut <= size; cut++)
        assert_int_equal(result_of_list(list, cut), cut < 4 ? GSF_NOT_GSCL : cut < first ? GSF_TRUNCATED : GSF_OK);
    list[first - 1] ^= 1;
    assert_int_equal(result_of_list(list, first), GSF_DAMAGED);
    assert_int_equal(result_of_list(list, size), GSF_OK);
    list[size - 1] ^= 1;
    assert_int_equal(result_of_list(list, size), GSF_DAMAGED);
    free(list);
    synthetic_packets_free(&packets);
    synthetic_scene_free(scene);
}

/* What no packet may have is not written. */
static void test_invalid_packets(void **unused) {
    (void)unused;
    uint8_t *bytes = NULL;
    size_t size;
    synthetic_scene *scene = synthetic_divisible_scene(2, 300, 200, 1);
    assert_non_null(scene);
    gsf_coded_image *image = &scene->image;
    image->splats[0] = (gsf_splat){.major = 4, .x = 6};
    for (uint32_t k = 0; k < 5; k++) {
        image->header.packets = 5;
        image->header.packet = (uint8_t)k;
        const gsf_result expected = gsf_packet_may_hold(image, 0, 5, k) ? GSF_OK : GSF_INVALID;
        assert_int_equal(expected, k == 1 ? GSF_OK : GSF_INVALID);
        assert_int_equal(synthetic_scene_write(scene, &bytes, &size), expected);
        free(bytes);
    }
    image->header.packet = 1;
    image->identity = GSF_NO_IDENTITY;
    assert_int_equal(synthetic_scene_write(scene, &bytes, &size), GSF_INVALID);
    free(bytes);
    image->identity = 0;
    image->header.enhancement_layers = 1;
    assert_int_equal(synthetic_scene_write(scene, &bytes, &size), GSF_INVALID);
    free(bytes);
    image->header.enhancement_layers = 0;
    image->header.packet = 5;
    assert_int_equal(synthetic_scene_write(scene, &bytes, &size), GSF_INVALID);
    free(bytes);
    image->header.packet = 0;
    image->header.packets = GSF_MAX_PACKETS + 1;
    assert_int_equal(synthetic_scene_write(scene, &bytes, &size), GSF_INVALID);
    free(bytes);
    synthetic_scene_free(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cells),           cmocka_unit_test(test_round_trips),
        cmocka_unit_test(test_single_packets),  cmocka_unit_test(test_empty_packets),
        cmocka_unit_test(test_mixed_lists),     cmocka_unit_test(test_refused_lists),
        cmocka_unit_test(test_invalid_packets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
