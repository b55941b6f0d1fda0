/* Images that are hard to fit, with ordinary splats. */
#include "scene.h"
#include "synthetic_scene.h"

static void resize_and_add_splats(scene *s, int width, int height) {
    scene_resize(s, width, height);
    for (int i = 0; i < 10; i++)
        scene_add(s);
}

/* Paints the target in one hue, with the given brightness. */
static void paint_target(scene *s, float (*value)(int x, int y)) {
    static const float hue[SCENE_CHANNELS] = {1.0f, 0.8f, 0.6f};
    const int pixels = s->width * s->height;
    for (int i = 0; i < pixels * SCENE_CHANNELS; i++)
        s->target[i] = hue[i / pixels] * value(i % pixels % s->width, i % pixels / s->width);
}

static float grey(int x, int y) {
    (void)x;
    (void)y;
    return 0.4f;
}
static float checkers(int x, int y) {
    return (float)((x + y) % 2);
}
static float hot(int x, int y) {
    return x == 7 && y == 5 ? 1.0f : 0.0f;
}
static float ramp(int x, int y) { /* steps of 1/65535 */
    return (float)(30000 + x + 40 * y) / 65535.0f;
}

static void one_colour(scene *s) {
    resize_and_add_splats(s, s->width, s->height);
    paint_target(s, grey);
}
static void one_pixel(scene *s) {
    resize_and_add_splats(s, 1, 1);
}
static void one_row(scene *s) {
    resize_and_add_splats(s, (int)scene_scaled(61, 19), 1);
}
static void one_column(scene *s) {
    resize_and_add_splats(s, 1, (int)scene_scaled(61, 19));
}
static void primes(scene *s) {
    resize_and_add_splats(s, (int)scene_scaled(37, 17), (int)scene_scaled(31, 7));
}
static void checkerboard(scene *s) {
    resize_and_add_splats(s, s->width, s->height);
    paint_target(s, checkers);
}
static void white_noise(scene *s) {
    resize_and_add_splats(s, s->width, s->height);
    for (int i = 0; i < s->width * s->height * SCENE_CHANNELS; i++)
        s->target[i] = (float)synthetic_random(2);
}
static void hot_pixel(scene *s) {
    resize_and_add_splats(s, s->width, s->height);
    paint_target(s, hot);
}
static void gradient_16_bits(scene *s) {
    resize_and_add_splats(s, s->width, s->height);
    paint_target(s, ramp);
}

const scene_case image_cases[] = {
    {"image of one colour", one_colour},   {"image of one pixel", one_pixel},
    {"image of one row", one_row},         {"image of one column", one_column},
    {"image of prime sizes", primes},      {"checkerboard", checkerboard},
    {"white noise", white_noise},          {"one hot pixel", hot_pixel},
    {"16-bit gradient", gradient_16_bits}, {0},
};
