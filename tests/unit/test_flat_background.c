/* The flat background of an image: its colour, and its part of the pixels and of the tiles. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "image/flat_background.h"
#include "fit/random.h"

#define WIDTH 100 /* 7 tiles, the last one 4 pixels wide */
#define HEIGHT 48 /* 3 tiles */
#define PIXELS ((size_t)WIDTH * HEIGHT)

static const float flat_colour[3] = {0.2f, 0.6f, 0.4f};

/* Noise, with the flat colour right of column `from`. */
static float *planes_flat_from(int from) {
    float *planes = malloc(3 * PIXELS * sizeof *planes);
    uint64_t random = 7;
    assert_non_null(planes);
    for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < PIXELS; i++)
            planes[k * PIXELS + i] = (int)(i % WIDTH) >= from ? flat_colour[k] : gscl_random_unit(&random);
    return planes;
}

static gscl_flat_background find_in(const float *planes, int channels) {
    gscl_flat_background flat;
    assert_true(gscl_find_flat_background(planes, WIDTH, HEIGHT, channels, &flat));
    return flat;
}

static void test_finds_colour_and_shares(void **state) {
    (void)state;
    float *planes = planes_flat_from(20);
    gscl_flat_background flat = find_in(planes, 3);
    for (int k = 0; k < 3; k++)
        assert_float_equal(flat.colour[k], flat_colour[k], 0.5 / 255);
    assert_float_equal(flat.pixels, 0.8, 1e-3);      /* a pixel of noise may have the same colour */
    assert_float_equal(flat.tiles, 5.0 / 7.0, 1e-9); /* columns 20 to 31 share a tile with noise */
    free(planes);
}

static void test_one_other_pixel_makes_a_tile_busy(void **state) {
    (void)state;
    float *planes = planes_flat_from(0);
    assert_true(find_in(planes, 3).tiles == 1);
    planes[PIXELS - 1] = 1.0f; /* in the last tile, which is cut off */
    assert_float_equal(find_in(planes, 3).tiles, 20.0 / 21.0, 1e-9);
    free(planes);
}

static void test_background_in_non_flat_tiles(void **state) {
    (void)state;
    float *planes = planes_flat_from(20);
    gscl_flat_background flat = find_in(planes, 3);
    /* Background covers 12 of the 32 columns of non-flat tiles.  The tolerance allows for the cut-off last tile. */
    assert_float_equal(gscl_background_share_of_non_flat_tiles(&flat), 12.0 / 32.0, 0.1);
    free(planes);
    planes = planes_flat_from(0);
    flat = find_in(planes, 3);
    assert_true(gscl_background_share_of_non_flat_tiles(&flat) == 0);
    free(planes);
    planes = planes_flat_from(32);
    flat = find_in(planes, 3);
    assert_true(gscl_background_share_of_non_flat_tiles(&flat) < 0.1); /* the noise ends on a border of tiles */
    free(planes);
}

static void test_too_small_a_part_is_no_background(void **state) {
    (void)state;
    float *planes = planes_flat_from(80);
    gscl_flat_background flat = find_in(planes, 3);
    assert_true(flat.pixels == 0 && flat.tiles == 0);
    free(planes);
}

static void test_grey(void **state) {
    (void)state;
    float *planes = planes_flat_from(50);
    gscl_flat_background flat = find_in(planes, 1);
    assert_float_equal(flat.colour[0], flat_colour[0], 2.0 / 255);
    assert_true(flat.pixels > 0.49 && flat.pixels < 0.53);
    free(planes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_finds_colour_and_shares),
        cmocka_unit_test(test_one_other_pixel_makes_a_tile_busy),
        cmocka_unit_test(test_background_in_non_flat_tiles),
        cmocka_unit_test(test_too_small_a_part_is_no_background),
        cmocka_unit_test(test_grey),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
