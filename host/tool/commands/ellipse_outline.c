#include "commands/ellipse_outline.h"

#include <math.h>
#include <stddef.h>

#define HALF_WIDTH 0.5 /* of the line, pixels */
#define SMOOTHING 0.5  /* pixels on either side over which the line fades */
#define OPACITY 0.8

/* The contour of a splat in pixels of the image: points where a quadratic form of the offset from the centre is 1.
 * Unequal scales of x and y change the axes of an ellipse, so the form is scaled instead of the axes. */
typedef struct contour {
    double x, y;                    /* centre */
    double a, b, c;                 /* a dx^2 + 2 b dx dy + c dy^2 */
    double half_width, half_height; /* of the bounding box */
} contour;

static contour make_contour(const gscl_splat *splat, double scale_x, double scale_y) {
    const double cosine = cos(splat->theta), sine = sin(splat->theta);
    const double p = 1.0 / ((double)splat->sigma1 * splat->sigma1), q = 1.0 / ((double)splat->sigma2 * splat->sigma2);
    const double half_width = hypot(splat->sigma1 * cosine, splat->sigma2 * sine);
    const double half_height = hypot(splat->sigma1 * sine, splat->sigma2 * cosine);
    return (contour){
        .x = splat->x * scale_x,
        .y = splat->y * scale_y,
        .a = (cosine * cosine * p + sine * sine * q) / (scale_x * scale_x),
        .b = cosine * sine * (p - q) / (scale_x * scale_y),
        .c = (sine * sine * p + cosine * cosine * q) / (scale_y * scale_y),
        .half_width = half_width * scale_x,
        .half_height = half_height * scale_y,
    };
}

/* The part of a pixel that the line covers, 0..1.  With f, the square root of the form, the distance from the line is
 * |f - 1| / |grad f| to first order. */
static double coverage(const contour *line, double dx, double dy) {
    const double gx = line->a * dx + line->b * dy, gy = line->b * dx + line->c * dy; /* f grad f */
    const double f = sqrt(fmax(dx * gx + dy * gy, 0.0));
    const double distance = fabs(f - 1.0) * f / (hypot(gx, gy) + 1e-12);
    return fmin(fmax((HALF_WIDTH + SMOOTHING - distance) / (2.0 * SMOOTHING), 0.0), 1.0);
}

static void blend_pixel(uint8_t *pixel, unsigned channels, double amount) {
    static const double colour[4] = {255.0, 230.0, 0.0, 255.0};
    for (unsigned c = 0; c < channels; c++)
        pixel[c] = (uint8_t)(pixel[c] + amount * (colour[c] - pixel[c]) + 0.5);
}

/* The pixels of 0..size - 1 whose centres lie within `reach` of `centre`. */
static void pixel_range(double centre, double reach, uint32_t size, uint32_t *begin, uint32_t *end) {
    *begin = (uint32_t)fmin(fmax(floor(centre - reach), 0.0), size);
    *end = (uint32_t)fmin(fmax(ceil(centre + reach), 0.0), size);
}

void outline_draw(gscl_image *image, const gscl_splat *splat, double scale_x, double scale_y) {
    const contour line = make_contour(splat, scale_x, scale_y);
    const double margin = HALF_WIDTH + SMOOTHING;
    uint32_t left, right, top, bottom;
    pixel_range(line.x, line.half_width + margin, image->width, &left, &right);
    pixel_range(line.y, line.half_height + margin, image->height, &top, &bottom);
    for (uint32_t y = top; y < bottom; y++) {
        uint8_t *row = (uint8_t *)image->pixels + (size_t)y * image->width * image->channels;
        for (uint32_t x = left; x < right; x++) {
            const double covered = coverage(&line, x + 0.5 - line.x, y + 0.5 - line.y);
            if (covered > 0.0)
                blend_pixel(row + (size_t)x * image->channels, image->channels, OPACITY * covered);
        }
    }
}
