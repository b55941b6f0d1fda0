#include "commands/export_svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* SVG paints one ellipse over the other: each replaces a part, its opacity, of what is there.  That expresses all three
 * blends.  The weighted mean of splats 1 to k is the mean of those before it, of which a part w / (w + W) is replaced by the
 * colour of splat k; w is its weight at the pixel, W the sum of the weights before it.  That part depends on the place, but a
 * gradient on the distance from the centre only: its stops are means over rings.  What a gradient cannot do is made good by
 * the colour, which is the one with the least squared error.  Waves are left out. */

#define STOPS 6                   /* rings of a gradient; 5 to 16 give the same PSNR within 0.1 dB */
#define MAX_GRID 1000000          /* pixels of the grid on which the colours are chosen */
#define MIN_OPACITY (1.0 / 400)   /* an ellipse with less is not visible */
#define RADIUS 3.7416573867739413 /* of an ellipse, standard deviations: where the exponent is -7 */
#define TAIL 9.118819655545162e-4 /* exp(-7), by which all weights are reduced */

/* What has been painted so far at one pixel of the grid. */
typedef struct cell {
    float weight;    /* sum of the weights, or the transmittance with the blend alpha */
    float target[3]; /* the exact picture of the splats so far */
    float shown[3];  /* what a viewer of the SVG image sees */
} cell;

typedef struct painter {
    output_file *output;
    gscl_blend blend;
    uint32_t width, height;  /* of the grid */
    double scale_x, scale_y; /* grid pixels in one pixel of the picture */
    cell *cells;
} painter;

/* A splat on the grid. */
typedef struct footprint {
    const gscl_splat *splat;
    double a, b, c; /* r^2 = a dx^2 + 2 b dx dy + c dy^2, r in standard deviations, dx and dy in grid pixels */
    double x, y;
    long left, right, top, bottom; /* pixels, the last ones excluded */
    double opacity[STOPS + 1];     /* at the radius RADIUS * i / STOPS */
    double colour[3];
} footprint;

void export_svg_grid(const gscl_info *info, uint32_t *width, uint32_t *height) {
    const double scale = fmin(1.0, sqrt((double)MAX_GRID / (double)info->pixels));
    *width = (uint32_t)fmax(1.0, floor(info->width * scale));
    *height = (uint32_t)fmax(1.0, floor(info->height * scale));
}

static long limited(double value, uint32_t limit) {
    return value < 0.0 ? 0 : value > limit ? (long)limit : (long)value;
}

static footprint footprint_of(const painter *p, const gscl_splat *splat) {
    const double cosine = cos(splat->theta), sine = sin(splat->theta);
    const double i1 = 1.0 / ((double)splat->sigma1 * splat->sigma1), i2 = 1.0 / ((double)splat->sigma2 * splat->sigma2);
    const double half_x = RADIUS * hypot(splat->sigma1 * cosine, splat->sigma2 * sine) * p->scale_x;
    const double half_y = RADIUS * hypot(splat->sigma1 * sine, splat->sigma2 * cosine) * p->scale_y;
    footprint f = {.splat = splat, .x = splat->x * p->scale_x, .y = splat->y * p->scale_y};
    f.a = (cosine * cosine * i1 + sine * sine * i2) / (p->scale_x * p->scale_x);
    f.b = cosine * sine * (i1 - i2) / (p->scale_x * p->scale_y);
    f.c = (sine * sine * i1 + cosine * cosine * i2) / (p->scale_y * p->scale_y);
    f.left = limited(floor(f.x - half_x), p->width);
    f.right = limited(ceil(f.x + half_x), p->width);
    f.top = limited(floor(f.y - half_y), p->height);
    f.bottom = limited(ceil(f.y + half_y), p->height);
    return f;
}

/* Distance of a pixel from the centre in standard deviations. */
static double radius_at(const footprint *f, long x, long y) {
    const double dx = (double)x + 0.5 - f->x, dy = (double)y + 0.5 - f->y;
    return sqrt(fmax(0.0, f->a * dx * dx + 2.0 * f->b * dx * dy + f->c * dy * dy));
}

static double weight_at(const footprint *f, double radius) {
    return f->splat->opacity * fmax(0.0, exp(-0.5 * radius * radius) - TAIL);
}

/* The part of a pixel that the splat replaces. */
static double opacity_of(const painter *p, double weight, double before) {
    switch (p->blend) {
    case GSCL_BLEND_NORMALIZED:
        return weight / (weight + before);
    case GSCL_BLEND_ALPHA:
        return fmin(weight, GSCL_LARGEST_ALPHA);
    default:
        return weight;
    }
}

/* ---- Opacity of an ellipse --------------------------------------------------------------------- */

/* The blend sum adds colours, which may be negative: a part A of what is there is replaced by a colour that differs from it by
 * the splat's colour / A.  The smallest A is best for which that colour exists. */
static double part_for_sum(const painter *p, const footprint *f) {
    const long x = limited(f->x, p->width - 1), y = limited(f->y, p->height - 1);
    const cell *centre = &p->cells[(size_t)y * p->width + (size_t)x];
    double part = 0.02;
    for (int i = 0; i < 3; i++) {
        const double added = f->splat->colour[i] * f->splat->opacity;
        const double room = added > 0.0 ? 1.0 - centre->target[i] : (double)centre->target[i];
        part = fmax(part, fabs(added) / fmax(room, 0.02));
    }
    return fmin(part, 1.0) / fmax(f->splat->opacity, 1e-6);
}

/* Means of the exact opacity over rings.  Rings without pixels take the mean weight of the whole ellipse. */
static void choose_opacities(const painter *p, footprint *f) {
    double sums[STOPS + 1] = {0}, counts[STOPS + 1] = {0}, before = 0.0, total = 0.0;
    for (long y = f->top; y < f->bottom; y++) {
        const cell *row = p->cells + (size_t)y * p->width;
        for (long x = f->left; x < f->right; x++) {
            const double radius = radius_at(f, x, y), weight = weight_at(f, radius);
            if (radius >= RADIUS)
                continue;
            const int ring = (int)(radius / RADIUS * STOPS + 0.5);
            sums[ring] += opacity_of(p, weight, row[x].weight);
            counts[ring] += 1.0;
            before += weight * row[x].weight;
            total += weight;
        }
    }
    const double mean = total > 0.0 ? before / total : GSCL_BACKGROUND_WEIGHT;
    const double part = p->blend == GSCL_BLEND_SUM ? part_for_sum(p, f) : 1.0;
    for (int i = 0; i <= STOPS; i++) {
        const double analytic = opacity_of(p, weight_at(f, RADIUS * i / STOPS), mean);
        f->opacity[i] = fmin(1.0, part * (counts[i] >= 4.0 ? sums[i] / counts[i] : analytic));
    }
    f->opacity[STOPS] = 0.0;
}

/* As SVG draws the gradient: linear between stops. */
static double drawn_opacity(const footprint *f, double radius) {
    const double place = radius / RADIUS * STOPS;
    const int i = (int)place;
    return i >= STOPS ? 0.0 : f->opacity[i] + (place - i) * (f->opacity[i + 1] - f->opacity[i]);
}

/* ---- Colour of an ellipse ---------------------------------------------------------------------- */

/* Adds the splat to the exact picture at one pixel. */
static void blend_exactly(const painter *p, const footprint *f, cell *at, double weight) {
    const double part = opacity_of(p, weight, at->weight);
    for (int i = 0; i < 3; i++) {
        const double colour = f->splat->colour[i];
        at->target[i] += (float)(p->blend == GSCL_BLEND_SUM ? weight * colour : part * (colour - at->target[i]));
    }
    at->weight = (float)(p->blend == GSCL_BLEND_ALPHA ? at->weight * (1.0 - part) : at->weight + weight);
}

/* Chooses the colour that, painted with the opacities of the ellipse, comes closest to the exact picture. */
static void choose_colour(const painter *p, footprint *f) {
    double dividend[3] = {0}, divisor = 0.0;
    for (long y = f->top; y < f->bottom; y++) {
        cell *row = p->cells + (size_t)y * p->width;
        for (long x = f->left; x < f->right; x++) {
            const double radius = radius_at(f, x, y);
            if (radius >= RADIUS)
                continue;
            const double part = drawn_opacity(f, radius);
            blend_exactly(p, f, &row[x], weight_at(f, radius));
            divisor += part * part;
            for (int i = 0; i < 3; i++)
                dividend[i] += part * (row[x].target[i] - (1.0 - part) * row[x].shown[i]);
        }
    }
    for (int i = 0; i < 3; i++) {
        const double colour = divisor > 0.0 ? dividend[i] / divisor : f->splat->colour[i];
        f->colour[i] = floor(fmin(fmax(colour, 0.0), 1.0) * 255.0 + 0.5) / 255.0;
    }
}

static void show(const painter *p, const footprint *f) {
    for (long y = f->top; y < f->bottom; y++) {
        cell *row = p->cells + (size_t)y * p->width;
        for (long x = f->left; x < f->right; x++) {
            const double part = drawn_opacity(f, radius_at(f, x, y));
            for (int i = 0; i < 3; i++)
                row[x].shown[i] += (float)(part * (f->colour[i] - row[x].shown[i]));
        }
    }
}

/* ---- The background ---------------------------------------------------------------------------- */

static void clear_cells(const painter *p, const double background[3]) {
    for (size_t i = 0; i < (size_t)p->width * p->height; i++) {
        cell *at = &p->cells[i];
        at->weight = p->blend == GSCL_BLEND_ALPHA ? 1.0f : (float)GSCL_BACKGROUND_WEIGHT;
        for (int c = 0; c < 3; c++)
            at->target[c] = at->shown[c] = (float)background[c];
    }
}

/* How much of the background is in sight at a pixel. */
static double background_part(const painter *p, const cell *at) {
    return p->blend == GSCL_BLEND_NORMALIZED ? GSCL_BACKGROUND_WEIGHT / at->weight
           : p->blend == GSCL_BLEND_ALPHA    ? at->weight
                                             : 1.0;
}

/* Finds the background as the colour that explains best what the splats alone do not. */
static void find_background(const painter *p, const gscl_splat *splats, size_t count, const gscl_image *decoded,
                            double background[3]) {
    const double black[3] = {0};
    const float *pixel = decoded->pixels;
    double dividend[3] = {0}, divisor[3] = {1e-9, 1e-9, 1e-9};
    clear_cells(p, black);
    for (size_t i = 0; i < count; i++) {
        const footprint f = footprint_of(p, &splats[i]);
        for (long y = f.top; y < f.bottom; y++)
            for (long x = f.left; x < f.right; x++)
                blend_exactly(p, &f, &p->cells[(size_t)y * p->width + (size_t)x], weight_at(&f, radius_at(&f, x, y)));
    }
    for (size_t i = 0; i < (size_t)p->width * p->height; i++, pixel += 3) {
        const double part = background_part(p, &p->cells[i]);
        for (int c = 0; c < 3; c++) {
            if (pixel[c] <= 0.0f || pixel[c] >= 1.0f) /* may have been clamped */
                continue;
            dividend[c] += part * (pixel[c] - p->cells[i].target[c]);
            divisor[c] += part * part;
        }
    }
    for (int c = 0; c < 3; c++)
        background[c] = fmin(fmax(dividend[c] / divisor[c], 0.0), 1.0);
}

/* ---- Writing ----------------------------------------------------------------------------------- */

static void write_text(output_file *output, const char *text) {
    output_write(output, text, strlen(text));
}

static void write_hex(char text[8], const double colour[3]) {
    snprintf(text, 8, "#%02x%02x%02x", (unsigned)(colour[0] * 255.0 + 0.5), (unsigned)(colour[1] * 255.0 + 0.5),
             (unsigned)(colour[2] * 255.0 + 0.5));
}

static void write_head(const painter *p, const gscl_info *info, const double background[3]) {
    char text[1024], colour[8];
    write_hex(colour, background);
    snprintf(
        text, sizeof text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%u\" height=\"%u\" viewBox=\"0 0 %u %u\">\n"
        "<desc>An approximation, by gscl %s: each of the %u Gaussians of a gscl file (%llu bytes) as an ellipse with a "
        "radial gradient. gscl decode draws the picture itself.</desc>\n"
        "<rect width=\"%u\" height=\"%u\" fill=\"%s\"/>\n",
        info->width, info->height, info->width, info->height, gscl_version(), info->splats,
        (unsigned long long)info->bytes, info->width, info->height, colour);
    write_text(p->output, text);
}

static void write_ellipse(const painter *p, const footprint *f, size_t number) {
    char text[256], colour[8];
    const gscl_splat *s = f->splat;
    write_hex(colour, f->colour);
    snprintf(text, sizeof text, "<radialGradient id=\"g%zu\">", number);
    write_text(p->output, text);
    for (int i = 0; i <= STOPS; i++) {
        snprintf(text, sizeof text, "<stop offset=\"%g\" stop-color=\"%s\" stop-opacity=\"%.3g\"/>", (double)i / STOPS,
                 colour, f->opacity[i]);
        write_text(p->output, text);
    }
    snprintf(text, sizeof text,
             "</radialGradient><ellipse rx=\"%.2f\" ry=\"%.2f\" transform=\"translate(%.2f %.2f) rotate(%.1f)\" "
             "fill=\"url(#g%zu)\"/>\n",
             s->sigma1 * RADIUS, s->sigma2 * RADIUS, s->x, s->y, s->theta * 57.29577951308232, number);
    write_text(p->output, text);
}

static void paint(const painter *p, const gscl_splat *splat, size_t number) {
    footprint f = footprint_of(p, splat);
    double most = 0.0;
    choose_opacities(p, &f);
    choose_colour(p, &f);
    for (int i = 0; i < STOPS; i++)
        most = fmax(most, f.opacity[i]);
    if (most < MIN_OPACITY)
        return;
    show(p, &f);
    write_ellipse(p, &f, number);
}

/* Wide ellipses first: what is below a narrow one then varies little.  The order of the shorter axes was better than that of
 * the areas by 0.2 dB and than that of the longer axes by 0.7 dB. */
static int by_width(const void *a, const void *b) {
    const gscl_splat *one = a, *two = b;
    const double difference = (double)fminf(two->sigma1, two->sigma2) - (double)fminf(one->sigma1, one->sigma2);
    return difference > 0.0 ? 1 : difference < 0.0 ? -1 : 0;
}

bool export_svg(output_file *output, const gscl_info *info, gscl_splat *splats, size_t count,
                const gscl_image *decoded) {
    painter p = {.output = output, .blend = info->blend, .width = decoded->width, .height = decoded->height};
    double background[3] = {0.0, 0.0, 0.0};
    p.scale_x = (double)decoded->width / info->width;
    p.scale_y = (double)decoded->height / info->height;
    p.cells = calloc((size_t)p.width * p.height, sizeof *p.cells);
    if (!p.cells)
        return false;
    find_background(&p, splats, count, decoded, background);
    clear_cells(&p, background);
    write_head(&p, info, background);
    if (p.blend != GSCL_BLEND_ALPHA)
        qsort(splats, count, sizeof *splats, by_width);
    for (size_t i = 0; i < count && !output->error; i++)
        paint(&p, &splats[i], i);
    write_text(output, "</svg>\n");
    free(p.cells);
    return true;
}
