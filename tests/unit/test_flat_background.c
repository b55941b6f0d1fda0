/* The ground of a picture: its colour, and what parts of the pixels and of the tiles it takes. */
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

static const float plain[3] = {0.2f, 0.6f, 0.4f};

/* Noise, with the plain colour right of column `from`. */
static float *picture_plain_from(int from) {
    float *planes = malloc(3 * PIXELS * sizeof *planes);
    uint64_t random = 7;
    assert_non_null(planes);
    for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < PIXELS; i++)
            planes[k * PIXELS + i] = (int)(i % WIDTH) >= from ? plain[k] : gscl_random_unit(&random);
    return planes;
}

static gscl_flat_background find_in(const float *planes, int channels) {
    gscl_flat_background flat;
    assert_true(gscl_find_flat_background(planes, WIDTH, HEIGHT, channels, &flat));
    return flat;
}

static void test_finds_colour_and_shares(void **state) {
    (void)state;
    float *planes = picture_plain_from(20);
    gscl_flat_background ground = find_in(planes, 3);
    for (int k = 0; k < 3; k++)
        assert_float_equal(ground.colour[k], plain[k], 0.5 / 255);
    assert_float_equal(ground.pixels, 0.8, 1e-3);      /* a pixel of noise may have the colour, too */
    assert_float_equal(ground.tiles, 5.0 / 7.0, 1e-9); /* columns 20 to 31 share a tile with noise */
    free(planes);
}

static void test_one_other_pixel_makes_a_tile_busy(void **state) {
    (void)state;
    float *planes = picture_plain_from(0);
    assert_true(find_in(planes, 3).tiles == 1);
    planes[PIXELS - 1] = 1.0f; /* in the last tile, which is cut off */
    assert_float_equal(find_in(planes, 3).tiles, 20.0 / 21.0, 1e-9);
    free(planes);
}

static void test_ground_in_busy_tiles(void **state) {
    (void)state;
    float *planes = picture_plain_from(20);
    gscl_flat_background ground = find_in(planes, 3);
    /* 12 of the 32 columns of busy tiles, were the last tile a whole one */
    assert_float_equal(gscl_background_share_of_non_flat_tiles(&ground), 12.0 / 32.0, 0.1);
    free(planes);
    planes = picture_plain_from(0);
    ground = find_in(planes, 3);
    assert_true(gscl_background_share_of_non_flat_tiles(&ground) == 0);
    free(planes);
    planes = picture_plain_from(32);
    ground = find_in(planes, 3);
    assert_true(gscl_background_share_of_non_flat_tiles(&ground) < 0.1); /* the border is a border of tiles */
    free(planes);
}

static void test_too_small_a_part_is_no_ground(void **state) {
    (void)state;
    float *planes = picture_plain_from(80);
    gscl_flat_background ground = find_in(planes, 3);
    assert_true(ground.pixels == 0 && ground.tiles == 0);
    free(planes);
}

static void test_grey(void **state) {
    (void)state;
    float *planes = picture_plain_from(50);
    gscl_flat_background ground = find_in(planes, 1);
    assert_float_equal(ground.colour[0], plain[0], 2.0 / 255);
    assert_true(ground.pixels > 0.49 && ground.pixels < 0.53);
    free(planes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_finds_colour_and_shares),
        cmocka_unit_test(test_one_other_pixel_makes_a_tile_busy),
        cmocka_unit_test(test_ground_in_busy_tiles),
        cmocka_unit_test(test_too_small_a_part_is_no_ground),
        cmocka_unit_test(test_grey),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
