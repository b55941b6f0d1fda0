#include "image/metrics.h"

#include <math.h>
#include <stdlib.h>

#include "image/image.h"
#include "image/ssimulacra2.h"
#include "runtime/allocate.h"
#include "runtime/context.h"
#include "runtime/elementary.h"
#include "runtime/struct_size.h"

#define PEAK 255.0
#define WINDOW 11 /* taps of the Gaussian window, along each axis */
#define WINDOW_SIGMA 1.5
#define C1 (0.01 * PEAK * 0.01 * PEAK) /* keep the quotients of SSIM away from 0 / 0 */
#define C2 (0.03 * PEAK * 0.03 * PEAK)

const double gscl_ms_ssim_exponents[GSCL_MS_SSIM_SCALES] = {0.0448, 0.2856, 0.3001, 0.2363, 0.1333};

/* ---- Samples ----------------------------------------------------------------------------------- */

/* Both images as planes of floats in 0..1, colours premultiplied. */
typedef struct image_pair {
    uint32_t width, height, channels;
    float *a, *b;
} image_pair;

static bool is_valid(const gscl_image *image) {
    return image && image->pixels && image->width > 0 && image->height > 0 && image->width <= GSCL_MAX_DIMENSION &&
           image->height <= GSCL_MAX_DIMENSION && image->channels >= 1 && image->channels <= 4 &&
           image->sample >= GSCL_SAMPLE_U8 && image->sample <= GSCL_SAMPLE_F32 && gscl_image_has_layout(image) &&
           gscl_image_rows_fit(image);
}

static size_t plane_size(const image_pair *pair) {
    return (size_t)pair->width * pair->height;
}

static bool are_comparable(const gscl_image *a, const gscl_image *b) {
    return is_valid(a) && is_valid(b) && a->width == b->width && a->height == b->height && a->channels == b->channels;
}

static gscl_result open_pair(const gscl_image *a, const gscl_image *b, image_pair *pair) {
    *pair = (image_pair){.width = a->width, .height = a->height, .channels = a->channels};
    pair->a = gscl_allocate(2 * (uint64_t)plane_size(pair) * pair->channels, sizeof *pair->a);
    if (!pair->a)
        return GSCL_ERROR_OUT_OF_MEMORY;
    pair->b = pair->a + plane_size(pair) * pair->channels;
    const bool has_alpha = pair->channels % 2 == 0;
    const int colours = (int)pair->channels - has_alpha;
    gscl_image_to_planes(a, colours, has_alpha, 0, pair->a);
    gscl_image_to_planes(b, colours, has_alpha, 0, pair->b);
    return GSCL_OK;
}

static void close_pair(image_pair *pair) {
    free(pair->a);
}

/* Adds the squared differences of some pixels, and notes the largest difference. */
static void add_error(const float *a, const float *b, size_t count, double *sum, double *largest) {
    for (size_t i = 0; i < count; i++) {
        const double difference = fabs((double)a[i] - b[i]);
        *sum += difference * difference;
        *largest = difference > *largest ? difference : *largest;
    }
}

/* Of two images that are comparable. */
static void measure_error(const gscl_image *a, const gscl_image *b, gscl_comparison *comparison) {
    const int colours = a->channels >= 3 ? 3 : 1;
    double sum = 0.0, largest = 0.0;
    gscl_pixels of_a, of_b;
    for (uint32_t y = 0; y < a->height; y++)
        for (uint32_t x = 0; x < a->width; x += GSCL_MAX_READ) {
            const size_t count = gscl_image_read_count(a, x);
            gscl_image_read(a, x, y, count, &of_a);
            gscl_image_read(b, x, y, count, &of_b);
            for (int k = 0; k < colours; k++)
                add_error(of_a.colour[k], of_b.colour[k], count, &sum, &largest);
            if (a->channels % 2 == 0)
                add_error(of_a.alpha, of_b.alpha, count, &sum, &largest);
        }
    comparison->mse = PEAK * PEAK * sum / ((double)a->width * a->height * a->channels);
    comparison->psnr = 10.0 * gscl_log10(PEAK * PEAK / comparison->mse);
    comparison->max_difference = PEAK * largest;
}

/* ---- Structural similarity --------------------------------------------------------------------- */

/* Weighted sums over windows of a, b, a^2 + b^2 and a b, from which SSIM follows: one row of each. */
typedef struct window_rows {
    double *a, *b, *squares, *product;
} window_rows;

/* Means over a plane of SSIM and of its contrast-structure factor. */
typedef struct similarity {
    double ssim, contrast;
} similarity;

static void make_taps(double taps[WINDOW]) {
    double sum = 0.0;
    for (int i = 0; i < WINDOW; i++) {
        const double x = i - WINDOW / 2;
        sum += taps[i] = gscl_exp(-x * x / (2.0 * WINDOW_SIGMA * WINDOW_SIGMA));
    }
    for (int i = 0; i < WINDOW; i++)
        taps[i] /= sum;
}

/* Adds a row of the planes to the rows' sums with weight `tap`. */
static void add_row(const window_rows *rows, const float *restrict a, const float *restrict b, uint32_t width,
                    double tap) {
    double *restrict sum_a = rows->a, *restrict sum_b = rows->b;
    double *restrict squares = rows->squares, *restrict product = rows->product;
    for (uint32_t x = 0; x < width; x++) {
        const double va = PEAK * a[x], vb = PEAK * b[x];
        sum_a[x] += tap * va;
        sum_b[x] += tap * vb;
        squares[x] += tap * (va * va + vb * vb);
        product[x] += tap * (va * vb);
    }
}

/* In place: row[x] becomes the weighted sum of row[x .. x + WINDOW - 1], for the first `count` x. */
static void slide_window(double *row, uint32_t count, const double taps[WINDOW]) {
    for (uint32_t x = 0; x < count; x++) {
        double sum = 0.0;
        for (int k = 0; k < WINDOW; k++)
            sum += taps[k] * row[x + (uint32_t)k];
        row[x] = sum;
    }
}

/* Adds up SSIM and its contrast factor over one row of windows. */
static void add_similarity(const window_rows *rows, uint32_t count, similarity *sum) {
    for (uint32_t x = 0; x < count; x++) {
        const double a = rows->a[x], b = rows->b[x];
        const double variances = rows->squares[x] - a * a - b * b, covariance = rows->product[x] - a * b;
        const double contrast = (2.0 * covariance + C2) / (variances + C2);
        sum->contrast += contrast;
        sum->ssim += contrast * (2.0 * a * b + C1) / (a * a + b * b + C1);
    }
}

/* Similarity of two planes of at least WINDOW x WINDOW samples, over the windows that lie inside. */
static similarity plane_similarity(const float *a, const float *b, uint32_t width, uint32_t height,
                                   const window_rows *rows) {
    const uint32_t columns = width - (WINDOW - 1), lines = height - (WINDOW - 1);
    double taps[WINDOW];
    similarity sum = {0.0, 0.0};
    make_taps(taps);
    for (uint32_t y = 0; y < lines; y++) {
        for (uint32_t x = 0; x < width; x++)
            rows->a[x] = rows->b[x] = rows->squares[x] = rows->product[x] = 0.0;
        for (uint32_t k = 0; k < WINDOW; k++)
            add_row(rows, a + (size_t)(y + k) * width, b + (size_t)(y + k) * width, width, taps[k]);
        slide_window(rows->a, columns, taps);
        slide_window(rows->b, columns, taps);
        slide_window(rows->squares, columns, taps);
        slide_window(rows->product, columns, taps);
        add_similarity(rows, columns, &sum);
    }
    const double windows = (double)columns * lines;
    return (similarity){sum.ssim / windows, sum.contrast / windows};
}

/* Sample of the plane shifted by its padding: an odd side gets a row or column of zeros in front. */
static double padded_sample(const float *plane, uint32_t width, uint32_t height, uint32_t x, uint32_t y) {
    const uint32_t pad_x = width % 2, pad_y = height % 2;
    return x < pad_x || y < pad_y ? 0.0 : plane[(size_t)(y - pad_y) * width + (x - pad_x)];
}

/* Halves a plane in place by averaging 2x2 samples.  Writing never overtakes reading. */
static void halve_plane(float *plane, uint32_t width, uint32_t height) {
    const uint32_t half_width = (width + 1) / 2, half_height = (height + 1) / 2;
    for (uint32_t y = 0; y < half_height; y++) {
        for (uint32_t x = 0; x < half_width; x++) {
            const double sum = padded_sample(plane, width, height, 2 * x, 2 * y) +
                               padded_sample(plane, width, height, 2 * x + 1, 2 * y) +
                               padded_sample(plane, width, height, 2 * x, 2 * y + 1) +
                               padded_sample(plane, width, height, 2 * x + 1, 2 * y + 1);
            plane[(size_t)y * half_width + x] = (float)(sum / 4.0);
        }
    }
}

/* SSIM and MS-SSIM of one channel; NaN where the plane is too small.  Overwrites the planes. */
static void measure_channel(float *a, float *b, uint32_t width, uint32_t height, const window_rows *rows, double *ssim,
                            double *ms_ssim) {
    double product = 1.0;
    *ssim = *ms_ssim = NAN;
    for (int scale = 0; scale < GSCL_MS_SSIM_SCALES; scale++) {
        if (width < WINDOW || height < WINDOW)
            return;
        const similarity here = plane_similarity(a, b, width, height, rows);
        if (scale == 0)
            *ssim = here.ssim;
        product *= gscl_pow(fmax(scale < GSCL_MS_SSIM_SCALES - 1 ? here.contrast : here.ssim, 0.0),
                            gscl_ms_ssim_exponents[scale]);
        halve_plane(a, width, height);
        halve_plane(b, width, height);
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    *ms_ssim = product;
}

static gscl_result measure_structure(image_pair *pair, gscl_comparison *comparison) {
    double *memory = malloc(4 * (size_t)pair->width * sizeof *memory);
    if (!memory)
        return GSCL_ERROR_OUT_OF_MEMORY;
    const window_rows rows = {memory, memory + pair->width, memory + 2 * (size_t)pair->width,
                              memory + 3 * (size_t)pair->width};
    comparison->ssim = comparison->ms_ssim = 0.0;
    for (uint32_t c = 0; c < pair->channels; c++) {
        const size_t plane = c * plane_size(pair);
        double ssim, ms_ssim;
        measure_channel(pair->a + plane, pair->b + plane, pair->width, pair->height, &rows, &ssim, &ms_ssim);
        comparison->ssim += ssim / pair->channels;
        comparison->ms_ssim += ms_ssim / pair->channels;
    }
    free(memory);
    return GSCL_OK;
}

/* Before the structural measures, which overwrite the planes. */
static gscl_result measure_appearance(const image_pair *pair, double *score) {
    double sum;
    GSCL_TRY(gscl_ssimulacra2_sum(pair->a, pair->b, pair->width, pair->height, pair->channels, &sum));
    *score = gscl_ssimulacra2_score(sum);
    return GSCL_OK;
}

/* ---- The public measures ----------------------------------------------------------------------- */

gscl_result gscl_compare_samples(const gscl_image *a, const gscl_image *b, gscl_comparison *comparison) {
    if (!comparison || !are_comparable(a, b))
        return GSCL_ERROR_INVALID_ARGUMENT;
    *comparison = (gscl_comparison){.ssim = NAN, .ms_ssim = NAN, .ssimulacra2 = NAN};
    measure_error(a, b, comparison);
    return GSCL_OK;
}

gscl_result gscl_compare_appearance(const gscl_image *a, const gscl_image *b, double *score) {
    image_pair pair;
    if (!are_comparable(a, b))
        return GSCL_ERROR_INVALID_ARGUMENT;
    GSCL_TRY(open_pair(a, b, &pair));
    const gscl_result result = measure_appearance(&pair, score);
    close_pair(&pair);
    return result;
}

gscl_result gscl_compare(const gscl_image *a, const gscl_image *b, gscl_comparison *comparison) {
    image_pair pair;
    gscl_comparison measured;
    if (!comparison)
        return GSCL_ERROR_INVALID_ARGUMENT;
    GSCL_TRY(GSCL_STRUCT_CHECK(NULL, gscl_comparison, max_difference, comparison));
    GSCL_TRY(gscl_compare_samples(a, b, &measured));
    GSCL_TRY(open_pair(a, b, &pair));
    gscl_result result = measure_appearance(&pair, &measured.ssimulacra2);
    if (result == GSCL_OK)
        result = measure_structure(&pair, &measured);
    close_pair(&pair);
    if (result == GSCL_OK)
        gscl_struct_write(comparison, &measured);
    return result;
}
