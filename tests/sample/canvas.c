#include "canvas.h"

#include <math.h>
#include <stdlib.h>

enum { CANVAS_WIDTH = WIDTH * SCALE, CANVAS_HEIGHT = HEIGHT * SCALE };

static colour *canvas;

float clamp01(float v) {
    return v < 0 ? 0 : v > 1 ? 1 : v;
}

float smooth(float from, float to, float v) {
    float t = clamp01((v - from) / (to - from));
    return t * t * (3 - 2 * t);
}

/* xorshift32 (Marsaglia). */
static uint32_t random_state = 20260101;

float random_in(float low, float high) {
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return low + (high - low) * (float)(random_state >> 8) / 16777216.0f;
}

float lattice(int x, int y) {
    uint32_t h = (uint32_t)x * 0x9e3779b1u ^ (uint32_t)y * 0x85ebca77u;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return (float)((h ^ h >> 15) >> 8) / 16777216.0f;
}

float noise(float x, float y) {
    int ix = (int)floorf(x), iy = (int)floorf(y);
    float u = smooth(0, 1, x - (float)ix), v = smooth(0, 1, y - (float)iy);
    float top = lattice(ix, iy) * (1 - u) + lattice(ix + 1, iy) * u;
    float bottom = lattice(ix, iy + 1) * (1 - u) + lattice(ix + 1, iy + 1) * u;
    return top * (1 - v) + bottom * v;
}

float clouds(float x, float y, int octaves) {
    float sum = 0, weight = 0.5f, total = 0;
    for (int i = 0; i < octaves; i++) {
        sum += weight * noise(x, y);
        total += weight;
        weight *= 0.5f;
        x = x * 2.03f + 17.3f;
        y = y * 2.01f + 5.1f;
    }
    return sum / total;
}

static float to_linear(float v) {
    return v <= 0.04045f ? v / 12.92f : powf((v + 0.055f) / 1.055f, 2.4f);
}

static float from_linear(float v) {
    return v <= 0.0031308f ? v * 12.92f : 1.055f * powf(v, 1 / 2.4f) - 0.055f;
}

colour rgb(uint32_t hex) {
    colour c = {to_linear((float)(hex >> 16) / 255), to_linear((float)(hex >> 8 & 255) / 255),
                to_linear((float)(hex & 255) / 255)};
    return c;
}

colour mix(colour a, colour b, float t) {
    colour c = {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
    return c;
}

colour scaled(colour a, float factor) {
    colour c = {a.r * factor, a.g * factor, a.b * factor};
    return c;
}

colour add(colour a, colour b, float amount) {
    colour c = {a.r + b.r * amount, a.g + b.g * amount, a.b + b.b * amount};
    return c;
}

colour one_colour(const void *opaque, float x, float y) {
    (void)x;
    (void)y;
    return *(const colour *)opaque;
}

void paint(int cx, int cy, colour c, float alpha) {
    if (cx >= 0 && cy >= 0 && cx < CANVAS_WIDTH && cy < CANVAS_HEIGHT) {
        colour *target = &canvas[cy * CANVAS_WIDTH + cx];
        *target = mix(*target, c, alpha);
    }
}

int to_canvas(float v) {
    return (int)ceilf(v * SCALE - 0.5f);
}

float from_canvas(int c) {
    return ((float)c + 0.5f) / SCALE;
}

void fill_below(float from, float to, contour top, float bottom, shader surface) {
    for (int cx = to_canvas(fmaxf(from, 0)); cx < to_canvas(fminf(to, WIDTH)); cx++) {
        const float x = from_canvas(cx);
        for (int cy = to_canvas(top(x)); cy < to_canvas(bottom); cy++)
            paint(cx, cy, surface(NULL, x, from_canvas(cy)), 1);
    }
}

void fill_polygon(const point *corners, size_t count, shader surface, const void *opaque) {
    float top = HEIGHT, bottom = 0;
    for (size_t i = 0; i < count; i++) {
        top = fminf(top, corners[i].y);
        bottom = fmaxf(bottom, corners[i].y);
    }
    for (int cy = to_canvas(fmaxf(top, 0)); cy < to_canvas(fminf(bottom, HEIGHT)); cy++) {
        float y = from_canvas(cy), crossings[MAX_CORNERS];
        size_t n = 0;
        for (size_t i = 0; i < count; i++) {
            point a = corners[i], b = corners[(i + 1) % count];
            if ((a.y <= y) == (b.y <= y))
                continue;
            float x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
            size_t at = n++;
            for (; at > 0 && crossings[at - 1] > x; at--)
                crossings[at] = crossings[at - 1];
            crossings[at] = x;
        }
        for (size_t i = 0; i + 1 < n; i += 2)
            for (int cx = to_canvas(crossings[i]); cx < to_canvas(crossings[i + 1]); cx++)
                paint(cx, cy, surface(opaque, from_canvas(cx), y), 1);
    }
}

void fill_box(float left, float top, float right, float bottom, colour c) {
    FILL(c, {left, top}, {right, top}, {right, bottom}, {left, bottom});
}

void draw_line(point a, point b, float width_a, float width_b, colour c) {
    float dx = b.x - a.x, dy = b.y - a.y, length = sqrtf(dx * dx + dy * dy) + 1e-6f;
    float nx = -dy / length / 2, ny = dx / length / 2;
    FILL(c, {a.x + nx * width_a, a.y + ny * width_a}, {b.x + nx * width_b, b.y + ny * width_b},
         {b.x - nx * width_b, b.y - ny * width_b}, {a.x - nx * width_a, a.y - ny * width_a});
}

void blob(point centre, float rx, float ry, colour c, float alpha, float softness) {
    for (int cy = to_canvas(centre.y - ry); cy < to_canvas(centre.y + ry); cy++)
        for (int cx = to_canvas(centre.x - rx); cx < to_canvas(centre.x + rx); cx++) {
            float dx = (from_canvas(cx) - centre.x) / rx, dy = (from_canvas(cy) - centre.y) / ry;
            float d = sqrtf(dx * dx + dy * dy);
            if (d < 1)
                paint(cx, cy, c, softness > 0 ? alpha * (1 - smooth(1 - softness, 1, d)) : alpha);
        }
}

bool canvas_create(void) {
    canvas = calloc((size_t)CANVAS_WIDTH * CANVAS_HEIGHT, sizeof *canvas);
    return canvas != NULL;
}

colour canvas_at(float x, float y) {
    int cx = to_canvas(x), cy = to_canvas(y);
    cx = cx < 0 ? 0 : cx >= CANVAS_WIDTH ? CANVAS_WIDTH - 1 : cx;
    cy = cy < 0 ? 0 : cy >= CANVAS_HEIGHT ? CANVAS_HEIGHT - 1 : cy;
    return canvas[cy * CANVAS_WIDTH + cx];
}

static uint8_t to_byte(float linear) {
    return (uint8_t)(255 * from_linear(clamp01(linear)) + 0.5f);
}

void canvas_finish(uint8_t *pixels) {
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            colour sum = {0, 0, 0};
            for (int i = 0; i < SCALE * SCALE; i++)
                sum = add(sum, canvas[(y * SCALE + i / SCALE) * CANVAS_WIDTH + x * SCALE + i % SCALE],
                          1.0f / (SCALE * SCALE));
            uint8_t *pixel = pixels + 3 * (y * WIDTH + x);
            pixel[0] = to_byte(sum.r);
            pixel[1] = to_byte(sum.g);
            pixel[2] = to_byte(sum.b);
        }
    free(canvas);
}
