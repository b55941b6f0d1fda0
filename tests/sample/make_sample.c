/* Draws the project's sample image: make_sample OUT.png
 *
 * A harbour at sunset, 768x512 RGB: smooth gradients (sky, water), sharp edges (house, boat), texture
 * (leaves, grass, shingles) and fine lines (rigging, fence, window bars).  The seed is fixed, so that every run
 * draws the same image, back to front. */
#include <math.h>
#include <stdio.h>

#include <png.h>

#include "canvas.h"

#define PI 3.14159265f
#define HORIZON 296.0f
#define SUN_X 300.0f
#define SUN_Y 250.0f

/* ---- Sky, mountains, water --------------------------------------------------------------------- */

static colour sky(const void *opaque, float x, float y) {
    static const struct {
        float y;
        uint32_t hex;
    } stops[] = {{0, 0x1d2f57}, {90, 0x3c5c92}, {170, 0x8a94b4}, {225, 0xe0b09a}, {270, 0xf6b070}, {HORIZON, 0xf7c07c}};
    (void)opaque;
    size_t i = 1;
    while (i + 1 < COUNT(stops) && y > stops[i].y)
        i++;
    colour c =
        mix(rgb(stops[i - 1].hex), rgb(stops[i].hex), clamp01((y - stops[i - 1].y) / (stops[i].y - stops[i - 1].y)));

    float dx = x - SUN_X, dy = (y - SUN_Y) * 1.25f, d = sqrtf(dx * dx + dy * dy);
    c = add(c, rgb(0xff9040), 0.55f * expf(-d / 95));
    c = add(c, rgb(0xffd890), 0.7f * expf(-d / 30));

    /* Long clouds, lit from below where they are thin. */
    float bend = 14 * clouds(x / 210, y / 60, 2);
    float density = clouds(x / 150 + 3, (y + bend) / 24, 5) * smooth(10, 90, y) * (1 - smooth(215, 275, y));
    float cover = smooth(0.46f, 0.68f, density);
    colour lit = mix(rgb(0xffb184), rgb(0xffdca8), expf(-d / 160)), shade = rgb(0x6d6a90);
    c = mix(c, mix(lit, shade, smooth(0.54f, 0.78f, density)), 0.85f * cover);

    return mix(c, rgb(0xfff4cf), 1 - smooth(18.7f, 19.3f, sqrtf(dx * dx + (y - SUN_Y) * (y - SUN_Y))));
}

typedef struct ridge {
    float height, width, shift; /* size of the features, and offset into the noise; pixels */
    uint32_t top, foot;         /* colours */
} ridge;

static float ridge_line(const ridge *r, float x) {
    float peak = 1 - fabsf(2 * clouds((x + r->shift) / r->width, r->shift, 6) - 1);
    return HORIZON - r->height * peak * peak;
}

/* Mountains between `from` and `to`, where they meet the water. */
static void draw_ridge(const ridge *r, float from, float to) {
    const float shoulder = 130;
    for (int cx = to_canvas(from); cx < to_canvas(to); cx++) {
        float x = from_canvas(cx), rise = smooth(from, from + shoulder, x) * (1 - smooth(to - shoulder, to, x));
        float line_y = HORIZON - (HORIZON - ridge_line(r, x)) * rise;
        for (int cy = to_canvas(line_y); cy < to_canvas(HORIZON); cy++) {
            float y = from_canvas(cy), depth = clamp01((y - line_y) / (HORIZON - line_y + 1));
            float rock = 0.8f + 0.4f * clouds(x / 7 + y / 9, y / 16 + r->shift, 4);
            paint(cx, cy, scaled(mix(rgb(r->top), rgb(r->foot), depth), rock), 1);
        }
    }
}

static void draw_mountains(void) {
    static const ridge far = {92, 230, 40, 0x9088ac, 0xd9a890};
    static const ridge middle = {104, 170, 1330, 0x5e5f86, 0xa98391};
    static const ridge near = {88, 120, 777, 0x3b4468, 0x6d6479};
    draw_ridge(&far, 300, WIDTH + 200);
    draw_ridge(&middle, -200, 276);
    draw_ridge(&middle, 330, WIDTH + 200);
    draw_ridge(&near, 430, WIDTH + 200);
}

/* The mirror image of everything above the water, broken by waves that grow towards the viewer. */
static colour water(const void *opaque, float x, float y) {
    (void)opaque;
    float near = (y - HORIZON) / (HEIGHT - HORIZON), size = 0.35f + 3.2f * near;
    float wave = clouds(x / (15 * size), y / (2.1f * size), 3) - 0.5f;
    float fine = noise(x / (4.5f * size) + 50, y / (0.9f * size)) - 0.5f;
    float swell = wave + 0.35f * fine;
    float mirrored_y = HORIZON - (y - HORIZON) * 0.92f + swell * (6 + 62 * near);
    colour seen = canvas_at(x + fine * 6 * near, fminf(mirrored_y, HORIZON - 0.5f));
    colour c = mix(scaled(seen, 0.92f), rgb(0x14304e), 0.22f + 0.42f * near);
    c = scaled(c, 1 + 0.5f * swell);
    float path = expf(-fabsf(x - SUN_X) / (10 + 60 * near));
    float glint = smooth(0.15f, 0.32f, swell + 0.30f * path - 0.09f) * path;
    return add(c, rgb(0xffc27a), 1.1f * glint);
}

/* ---- Boat -------------------------------------------------------------------------------------- */

static colour sail_cloth(const void *opaque, float x, float y) {
    const point *mast = opaque;
    float belly = clamp01(fabsf(x - mast->x) / 46);
    colour c = mix(rgb(0xfff1d8), rgb(0xd79a78), belly * belly);
    float seam = fmodf(y + 0.35f * x, 13);
    return seam < 0.7f ? scaled(c, 0.82f) : c;
}

static void draw_boat(float x, float y) {
    const point mast = {x, y - 112};
    const colour wood = rgb(0x4a2c22), rope = rgb(0x2b2730);
    const point main_sail[] = {
        {x + 2.5f, y - 108}, {x + 14, y - 78}, {x + 32, y - 44}, {x + 50, y - 17}, {x + 2.5f, y - 15}};
    const point jib[] = {{x - 2, y - 96}, {x - 14, y - 62}, {x - 30, y - 32}, {x - 43, y - 14}, {x - 5, y - 19}};
    fill_polygon(main_sail, COUNT(main_sail), sail_cloth, &mast);
    fill_polygon(jib, COUNT(jib), sail_cloth, &mast);
    fill_box(x - 1.1f, y - 114, x + 1.1f, y - 2, wood);
    draw_line((point){x, y - 14}, (point){x + 53, y - 15.5f}, 1.8f, 1.2f, wood);
    draw_line(mast, (point){x - 52, y - 10}, 0.6f, 0.6f, rope);
    draw_line(mast, (point){x + 58, y - 8}, 0.6f, 0.6f, rope);
    draw_line((point){x, y - 100}, (point){x - 22, y - 7}, 0.5f, 0.5f, rope);
    draw_line((point){x, y - 100}, (point){x + 22, y - 7}, 0.5f, 0.5f, rope);
    FILL(rgb(0xd8483a), {x, y - 114}, {x + 14, y - 110.5f}, {x, y - 107});

    FILL(rgb(0xf3ead8), {x - 55, y - 11}, {x - 30, y - 8}, {x + 30, y - 7.5f}, {x + 60, y - 9}, {x + 56, y - 3},
         {x - 48, y - 3});
    FILL(rgb(0x1f3f66), {x - 51, y - 5}, {x + 57.5f, y - 5}, {x + 47, y + 6}, {x - 38, y + 6});
    FILL(rgb(0xa8382f), {x - 41, y + 3.6f}, {x + 50, y + 3.6f}, {x + 47, y + 6}, {x - 38, y + 6});
    FILL(rgb(0xc9a77b), {x - 16, y - 15}, {x + 16, y - 15}, {x + 20, y - 8}, {x - 20, y - 8});
    for (int i = 0; i < 3; i++)
        fill_box(x - 12 + 9 * (float)i, y - 13, x - 7 + 9 * (float)i, y - 10, rgb(0x2a3546));
}

/* The reflection of the boat: everything above its water line `y`, mirrored, distorted and darkened. */
static void mirror_boat(float left, float right, float y, float height) {
    for (int cy = to_canvas(y); cy < to_canvas(y + height); cy++)
        for (int cx = to_canvas(left); cx < to_canvas(right); cx++) {
            float px = from_canvas(cx), py = from_canvas(cy), depth = (py - y) / height;
            float sway = (clouds(px / 30, py / 2.6f, 2) - 0.5f) * (2 + 26 * depth);
            float mirrored_y = 2 * y - py - sway * 0.5f;
            if (mirrored_y >= y)
                continue;
            float edge = smooth(left, left + 12, px) * (1 - smooth(right - 12, right, px));
            float alpha = edge * 0.75f * (1 - depth) * (1 - depth);
            paint(cx, cy, mix(canvas_at(px + sway, mirrored_y), rgb(0x14304e), 0.3f), alpha);
        }
}

/* ---- Shore ------------------------------------------------------------------------------------- */

static float hill_line(float x) {
    float rise = smooth(395, 560, x);
    return 530 - 138 * rise - 20 * smooth(600, 768, x) + 3 * (noise(x / 23, 1) - 0.5f);
}

static colour soil(const void *opaque, float x, float y) {
    (void)opaque;
    float light = 0.55f + 0.75f * clouds(x / 34, y / 16, 4);
    colour c = mix(rgb(0x8a8a3c), rgb(0x2c3d22), smooth(0, 120, y - hill_line(x)));
    return scaled(c, light);
}

/* Draws blades from the far edge to the near one, so that near blades cover far ones. */
static void draw_grass(float from, float to, contour top) {
    enum { BLADES = 15000 };
    for (int i = 0; i < BLADES; i++) {
        const float x = random_in(from, to), lean = random_in(-3, 2), tall = random_in(0, 1);
        const float hue = random_in(-0.35f, 0.35f), light = random_in(0.5f, 1.25f);
        const float y = top(x) + (HEIGHT + 12 - top(x)) * (float)i / BLADES, near = clamp01((y - top(x)) / 130);
        const float height = 2.5f + 2.5f * tall + 4 * near * (1 + tall);
        const colour c = mix(rgb(0xb9a84c), rgb(0x2f4a24), clamp01(near + hue));
        draw_line((point){x, y}, (point){x + lean, y - height}, 0.9f + near * 0.6f, 0.1f, scaled(c, light));
    }
}

static void draw_hill(void) {
    fill_below(380, WIDTH, hill_line, HEIGHT, soil);
    draw_grass(395, WIDTH, hill_line);
}

/* ---- House ------------------------------------------------------------------------------------- */

static colour shingles(const void *opaque, float x, float y) {
    (void)opaque;
    float row = floorf(y / 4.2f), in_row = y / 4.2f - row;
    float along = x / 6 + (fmodf(row, 2) > 0.5f ? 0.5f : 0), column = floorf(along), in_column = along - column;
    colour c = scaled(rgb(0xa8442f), 0.68f + 0.55f * lattice((int)column, (int)row));
    return in_row > 0.84f || in_column < 0.1f ? scaled(c, 0.5f) : scaled(c, 0.85f + 0.25f * in_row);
}

static colour bricks(const void *opaque, float x, float y) {
    (void)opaque;
    float row = floorf(y / 3), column = x / 6 + (fmodf(row, 2) > 0.5f ? 0.5f : 0);
    if (y / 3 - row > 0.8f || column - floorf(column) < 0.12f)
        return rgb(0xb09a88);
    return scaled(rgb(0x96503c), 0.75f + 0.5f * lattice((int)floorf(column), (int)row + 99));
}

static colour planks(const void *opaque, float x, float y) {
    float board = fmodf(y, 5.0f);
    colour c = scaled(*(const colour *)opaque, 0.93f + 0.12f * noise(x / 30, floorf(y / 5) * 3.7f));
    return board < 0.7f ? scaled(c, 0.62f) : c;
}

static void draw_window(float x, float y, float width, float height) {
    const colour frame = rgb(0xfbf6ea), glass = rgb(0xffca63), bright = rgb(0xfff0b8);
    fill_box(x - 2, y - 2, x + width + 2, y + height + 2, frame);
    fill_box(x, y, x + width, y + height, glass);
    FILL(bright, {x, y + height}, {x, y + height * 0.45f}, {x + width * 0.75f, y + height});
    fill_box(x + width / 2 - 0.6f, y, x + width / 2 + 0.6f, y + height, frame);
    fill_box(x, y + height / 2 - 0.5f, x + width, y + height / 2 + 0.5f, frame);
    fill_box(x - 3.5f, y + height + 2, x + width + 3.5f, y + height + 3.8f, rgb(0xd9cdb8));
    for (int side = 0; side < 2; side++) {
        float left = side ? x + width + 2.6f : x - 8.6f;
        fill_box(left, y - 2, left + 6, y + height + 2, rgb(0x2f5d62));
        for (float slat = y; slat < y + height; slat += 2.6f)
            fill_box(left + 0.8f, slat, left + 5.2f, slat + 0.8f, rgb(0x1d3f45));
    }
}

static void draw_house(float x, float y) {
    const colour front = rgb(0xeadcc2), side = rgb(0xa99a98), trim = rgb(0xfbf6ea);
    const point front_wall[] = {{x, y - 62}, {x + 38, y - 108}, {x + 76, y - 62}, {x + 76, y}, {x, y}};
    const point side_wall[] = {{x + 76, y - 62}, {x + 158, y - 62}, {x + 158, y - 3}, {x + 76, y}};
    const point roof[] = {{x + 38, y - 113}, {x + 132, y - 113}, {x + 167, y - 58}, {x + 76, y - 58}};
    const point chimney[] = {{x + 104, y - 134}, {x + 120, y - 134}, {x + 120, y - 96}, {x + 104, y - 96}};

    for (int i = 0; i < 26; i++) { /* smoke */
        const float t = (float)i / 26, drift = random_in(-3, 3);
        blob((point){x + 112 + 34 * t * t + drift, y - 138 - 78 * t}, 5 + 15 * t, 5 + 11 * t, rgb(0xe7d3cf),
             0.16f * (1 - t), 1);
    }
    fill_polygon(side_wall, COUNT(side_wall), planks, &side);
    fill_polygon(front_wall, COUNT(front_wall), planks, &front);
    fill_polygon(chimney, COUNT(chimney), bricks, NULL);
    fill_box(x + 102, y - 137, x + 122, y - 133, rgb(0x6b5248));
    fill_polygon(roof, COUNT(roof), shingles, NULL);
    draw_line((point){x + 38, y - 111}, (point){x - 6, y - 57.5f}, 4, 4, trim);
    draw_line((point){x + 38, y - 111}, (point){x + 80, y - 60}, 4, 4, trim);
    draw_line((point){x + 76, y - 57.5f}, (point){x + 167, y - 57.5f}, 2.2f, 2.2f, rgb(0x5d3028));

    draw_window(x + 12, y - 46, 15, 20);
    draw_window(x + 94, y - 45, 14, 18);
    draw_window(x + 130, y - 45, 14, 18);
    blob((point){x + 38, y - 80}, 8.5f, 8.5f, trim, 1, 0);
    blob((point){x + 38, y - 80}, 6.4f, 6.4f, rgb(0xffca63), 1, 0);
    draw_line((point){x + 38, y - 87}, (point){x + 38, y - 73}, 1, 1, trim);
    draw_line((point){x + 31, y - 80}, (point){x + 45, y - 80}, 1, 1, trim);

    fill_box(x + 44, y - 40, x + 64, y, trim);
    fill_box(x + 46, y - 38, x + 62, y, rgb(0x8c3a2c));
    for (int i = 1; i < 4; i++)
        fill_box(x + 46 + 4 * (float)i - 0.3f, y - 38, x + 46 + 4 * (float)i + 0.3f, y, rgb(0x5d251d));
    blob((point){x + 59, y - 18}, 1.3f, 1.3f, rgb(0xf0c860), 1, 0);
    fill_box(x + 40, y - 1, x + 68, y + 4, rgb(0x9a9088));
}

static void draw_fence(float from, float to) {
    const colour white = rgb(0xf4e6d0), shade = rgb(0xa08d8c);
    point last = {0, 0};
    for (float x = from; x < to; x += 9) {
        float y = hill_line(x) + 31 + 0.06f * (x - from);
        if (last.x > 0)
            for (int rail = 0; rail < 2; rail++)
                draw_line((point){last.x, last.y - 7 - 9 * (float)rail}, (point){x, y - 7 - 9 * (float)rail}, 1.7f,
                          1.7f, shade);
        last = (point){x, y};
    }
    for (float x = from; x < to; x += 9) {
        float y = hill_line(x) + 31 + 0.06f * (x - from);
        FILL(white, {x - 1.7f, y + 2}, {x - 1.7f, y - 20}, {x, y - 23}, {x + 1.7f, y - 20}, {x + 1.7f, y + 2});
        fill_box(x + 0.9f, y - 20, x + 1.7f, y + 2, shade);
    }
}

/* ---- Tree -------------------------------------------------------------------------------------- */

static float bank_line(float x) {
    return 452 + 62 * smooth(30, 235, x) + 4 * (noise(x / 17, 4) - 0.5f);
}

static void draw_leaves(point at) {
    for (int i = 0; i < 46; i++) {
        const float angle = random_in(0, 2 * PI), reach = 30 * sqrtf(random_in(0, 1)), chance = random_in(-0.3f, 0.3f);
        const float width = random_in(1.4f, 3.2f), height = random_in(1.0f, 2.2f);
        const point p = {at.x + reach * cosf(angle), at.y + 0.75f * reach * sinf(angle)};
        /* The evening sun is on the right: leaves on that side are warm, the others nearly black. */
        const float lit = clamp01(0.35f + 0.016f * (p.x - at.x) - 0.012f * (p.y - at.y) + chance);
        const colour c = mix(rgb(0x14261c), mix(rgb(0x55702c), rgb(0xd9a441), lit * lit), lit);
        blob(p, width, height, c, 1, 0);
    }
}

static void draw_branch(point from, float angle, float length, float width, int depth) {
    const point to = {from.x + length * cosf(angle), from.y - length * sinf(angle)};
    const float light = random_in(0, 0.6f);
    draw_line(from, to, width, width * 0.72f, mix(rgb(0x241a1a), rgb(0x6a4632), light));
    if (depth == 0) {
        draw_leaves(to);
        return;
    }
    const int twigs = depth > 2 ? 2 : 3;
    for (int i = 0; i < twigs; i++) {
        const float turn = random_in(0.22f, 0.62f), shrink = random_in(0.68f, 0.86f), extra = i == 2 ? 0.25f : 0;
        draw_branch(to, angle + (i % 2 ? turn : extra - turn), length * shrink, width * 0.68f, depth - 1);
    }
}

static colour bark(const void *opaque, float x, float y) {
    const point *foot = opaque;
    float light = 0.35f + 0.9f * clouds(x / 3.2f, y / 22, 4) + 0.02f * (x - foot->x);
    return scaled(rgb(0x5b4032), fmaxf(light, 0.15f));
}

static void draw_tree(point foot) {
    const float x = foot.x, y = foot.y;
    const point trunk[] = {{x - 20, y + 8},  {x - 11, y - 14}, {x - 8, y - 90},  {x - 5, y - 142},
                           {x + 9, y - 142}, {x + 9, y - 90},  {x + 12, y - 16}, {x + 24, y + 8}};
    const point crown = {x + 2, y - 136};
    fill_polygon(trunk, COUNT(trunk), bark, &foot);
    draw_branch((point){x + 4, y - 92}, 0.45f, 48, 6, 3);
    draw_branch((point){x - 4, y - 104}, 2.6f, 42, 6, 3);
    draw_branch(crown, 2.1f, 64, 9, 4);
    draw_branch(crown, 1.5f, 70, 9, 4);
    draw_branch(crown, 0.85f, 66, 9, 4);
}

static colour dark_soil(const void *opaque, float x, float y) {
    (void)opaque;
    return scaled(rgb(0x33421f), 0.5f + 0.9f * clouds(x / 20, y / 9, 4));
}

static void draw_bank(void) {
    fill_below(0, 240, bank_line, HEIGHT, dark_soil);
    draw_tree((point){70, 470});
    draw_grass(0, 240, bank_line);
}

static void draw_birds(void) {
    const colour c = rgb(0x2d3149);
    for (int i = 0; i < 9; i++) {
        const float jitter_x = random_in(-6, 6), jitter_y = random_in(-3, 3);
        const float x = 400 + 19 * (float)i + jitter_x, y = 118 + 5.5f * fabsf((float)i - 3) + jitter_y;
        const float span = random_in(4, 7), lift = random_in(1.5f, 3.2f);
        draw_line((point){x, y}, (point){x - span * 0.5f, y - lift}, 1.1f, 0.9f, c);
        draw_line((point){x - span * 0.5f, y - lift}, (point){x - span, y - lift * 0.5f}, 0.9f, 0.3f, c);
        draw_line((point){x, y}, (point){x + span * 0.5f, y - lift}, 1.1f, 0.9f, c);
        draw_line((point){x + span * 0.5f, y - lift}, (point){x + span, y - lift * 0.5f}, 0.9f, 0.3f, c);
    }
}

/* ---- The whole image --------------------------------------------------------------------------- */

static float top_edge(float x) {
    (void)x;
    return 0;
}

static float horizon(float x) {
    (void)x;
    return HORIZON;
}

static void draw_scene(void) {
    fill_below(0, WIDTH, top_edge, HORIZON, sky);
    draw_mountains();
    draw_birds();
    fill_below(0, WIDTH, horizon, HEIGHT, water);
    draw_boat(366, 372);
    mirror_boat(290, 440, 378, 92);
    draw_hill();
    draw_house(556, 398);
    draw_fence(468, WIDTH + 8);
    draw_bank();
}

int main(int argc, char **argv) {
    static uint8_t pixels[WIDTH * HEIGHT * 3];
    png_image image = {.version = PNG_IMAGE_VERSION, .width = WIDTH, .height = HEIGHT, .format = PNG_FORMAT_RGB};
    if (argc != 2) {
        fputs("usage: make_sample OUT.png\n", stderr);
        return 2;
    }
    if (!canvas_create()) {
        fputs("make_sample: out of memory\n", stderr);
        return 1;
    }
    draw_scene();
    canvas_finish(pixels);
    if (!png_image_write_to_file(&image, argv[1], 0, pixels, 0, NULL)) {
        fprintf(stderr, "make_sample: %s: %s\n", argv[1], image.message);
        return 1;
    }
    return 0;
}
