/* A supersampled canvas: shapes are painted back to front in linear light, and samples are averaged at the end.
 * Coordinates are pixels of the finished image; to_canvas and from_canvas convert them to samples and back. */
#ifndef GSCL_SAMPLE_CANVAS_H
#define GSCL_SAMPLE_CANVAS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { WIDTH = 768, HEIGHT = 512, SCALE = 4, MAX_CORNERS = 64 };

#define COUNT(array) (sizeof(array) / sizeof *(array))

typedef struct colour {
    float r, g, b; /* linear light, 0..1 */
} colour;

typedef struct point {
    float x, y;
} point;

/* The colour of a surface at a point; `opaque` is the argument of the caller. */
typedef colour (*shader)(const void *opaque, float x, float y);
/* The height of an outline at x. */
typedef float (*contour)(float x);

float clamp01(float v);
/* A smooth step: 0 up to `from`, 1 beyond `to`. */
float smooth(float from, float to, float v);
/* Uniform in low..high.  Use it once per expression, because the order of evaluation is not defined. */
float random_in(float low, float high);
/* A fixed random number in 0..1 for each cell of a grid. */
float lattice(int x, int y);
/* Smooth noise in 0..1 with features one unit wide. */
float noise(float x, float y);
/* Noise with detail at several scales, 0..1. */
float clouds(float x, float y, int octaves);

/* The colour of a hexadecimal sRGB code, 0xRRGGBB. */
colour rgb(uint32_t hex);
colour mix(colour a, colour b, float t);
colour scaled(colour a, float factor);
colour add(colour a, colour b, float amount);

bool canvas_create(void);
/* The colour that has been painted so far; outside the canvas, that of the nearest sample. */
colour canvas_at(float x, float y);
/* Averages the canvas down to WIDTH * HEIGHT * 3 sRGB bytes and frees it. */
void canvas_finish(uint8_t *pixels);

int to_canvas(float v);
float from_canvas(int c);
void paint(int cx, int cy, colour c, float alpha);
/* Fills from an outline down to `bottom`. */
void fill_below(float from, float to, contour top, float bottom, shader surface);
/* Fills a polygon of at most MAX_CORNERS corners (even-odd rule). */
void fill_polygon(const point *corners, size_t count, shader surface, const void *opaque);
/* Fills a polygon with one colour; its corners are {x, y}, {x, y}, ... */
#define FILL(colour_value, ...)                                        \
    do {                                                               \
        const point corners_[] = {__VA_ARGS__};                        \
        const colour colour_ = (colour_value);                         \
        fill_polygon(corners_, COUNT(corners_), one_colour, &colour_); \
    } while (0)
/* A shader; `opaque` is a colour. */
colour one_colour(const void *opaque, float x, float y);
void fill_box(float left, float top, float right, float bottom, colour c);
void draw_line(point a, point b, float width_a, float width_b, colour c);
/* An ellipse; `softness` 0 has a sharp edge, 1 fades from the centre. */
void blob(point centre, float rx, float ry, colour c, float alpha, float softness);

#endif
