/* The difference of a decode from a drawing in double precision. */
#include <gscl/measure.h>
#include <math.h>
#include <stdlib.h>

#include "cl/constants.h"
#include "decode/coded_image.h"
#include "measure/reference.h"
#include "runtime/allocate.h"

/* A file's splats drawn in double precision: planes of the coded channels. */
typedef struct exact_drawing {
    gscl_kernel_options options;
    size_t pixels;
    double *planes; /* one for each channel, and one for weights */
} exact_drawing;

static gscl_result drawing_make(gscl_context *context, const gscl_coded_image *coded, exact_drawing *drawing) {
    const gsf_header *header = &coded->file.header;
    const gscl_rectangle all = {0, 0, (int)header->width, (int)header->height};
    gscl_reference reference = {0};
    float background[4], *params = malloc(((size_t)header->splat_count + 1) * GSCL_PARAMS * sizeof *params);
    drawing->options = gscl_coded_image_options(header);
    drawing->pixels = (size_t)header->width * header->height;
    drawing->planes =
        gscl_allocate((uint64_t)drawing->pixels * (gsf_channel_count(header) + 1), sizeof *drawing->planes);
    gscl_result result = params && drawing->planes ? GSCL_OK : gscl_fail_memory(context);
    if (result == GSCL_OK) {
        gscl_coded_image_params(coded, params, background);
        result = gscl_reference_create(&reference, &drawing->options, params, header->splat_count, background, true);
    }
    if (result == GSCL_OK)
        gscl_reference_draw(&reference, all, drawing->planes,
                            drawing->planes + drawing->pixels * gsf_channel_count(header));
    gscl_reference_free(&reference);
    free(params);
    return result;
}

static double clamped(double sample, double limit) {
    return fmin(fmax(sample, 0), limit);
}

/* Sample `k` of a pixel (FORMAT.md, "Rendering"): premultiplied colours do not exceed alpha. */
static double drawing_sample(const exact_drawing *drawing, size_t pixel, uint32_t k, uint32_t channels) {
    const double *at = drawing->planes + pixel;
    const int colours = drawing->options.colours;
    const bool has_alpha = channels == 2 || channels == 4;
    const double alpha = drawing->options.alpha_channel ? clamped(at[(size_t)colours * drawing->pixels], 1) : 1;
    if (has_alpha && k == channels - 1)
        return alpha;
    return clamped(at[colours == 1 ? 0 : k * drawing->pixels], has_alpha ? alpha : 1);
}

/* The largest difference in units of 1/255.  A sample that is no number differs by 255. */
static double drawing_compare(const exact_drawing *drawing, const gscl_image *image) {
    const float *samples = image->pixels;
    double largest = 0;
    for (size_t i = 0; i < drawing->pixels; i++)
        for (uint32_t k = 0; k < image->channels; k++) {
            const double sample = samples[i * image->channels + k];
            const double error = fabs(sample - drawing_sample(drawing, i, k, image->channels));
            largest = fmax(largest, isfinite(sample) ? 255 * error : 255);
        }
    return largest;
}

static gscl_result decode_as_floats(gscl_context *context, const uint8_t *bytes, size_t size, gscl_image *image) {
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.sample = GSCL_SAMPLE_F32;
    settings.premultiplied = true;
    *image = (gscl_image){0};
    return gscl_decode(context, bytes, size, &settings, image);
}

gscl_result gscl_measure_decoding(gscl_context *context, const uint8_t *bytes, size_t size, double *largest_error) {
    gscl_coded_image coded = {0};
    gscl_image image;
    exact_drawing drawing = {.planes = NULL};
    if (!context || !bytes || !largest_error)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_result result = decode_as_floats(context, bytes, size, &image);
    if (result == GSCL_OK)
        result = gscl_coded_image_read(&coded, bytes, size, false);
    if (result == GSCL_OK)
        result = drawing_make(context, &coded, &drawing);
    if (result == GSCL_OK)
        *largest_error = drawing_compare(&drawing, &image);
    gscl_coded_image_free(&coded);
    free(drawing.planes);
    gscl_free(image.pixels);
    return gscl_complete_message(context, result);
}
