/* gscl: measuring quality, time, speed and accuracy.  gscl/gscl.h states the conventions and how structs grow.
 *
 * Contents: comparing images; time of stages and kernels; costs of effects in a file; speed of a device; accuracy of
 * drawing and of derivatives.  A library that was built without OpenCL has none of it: all functions that can fail return
 * GSCL_ERROR_NO_ENCODER. */
#ifndef GSCL_MEASURE_H
#define GSCL_MEASURE_H

#include <gscl/gscl.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Quality ------------------------------------------------------------------------------- */

/* How much two images differ. */
typedef struct gscl_comparison {
    size_t struct_size; /* set by the caller */
    double mse;         /* mean squared error over all channels, samples in 0..255, colours premultiplied */
    double psnr;        /* dB, 10 log10(255^2 / mse); infinite for equal images */
    double ssim;        /* mean over channels; 11x11 Gaussian window of sigma 1.5, valid area; NaN for images with a
                              side below 11 pixels */
    double ms_ssim;     /* five scales (Wang et al. 2003); NaN where a side of the smallest scale is below 11 pixels */
    double max_difference; /* of samples in 0..255 */
    double ssimulacra2; /* SSIMULACRA 2.1 of b as a version of a, sRGB: 100 for equal images, higher is better, may be
                              negative; grey as RGB; with alpha the lower score of those in front of a dark and a bright
                              background; NaN for images with a side below 8 pixels */
} gscl_comparison;

/* Compares two images of equal size and channels; sample types may differ.  The caller sets comparison->struct_size.
 * Errors: GSCL_ERROR_INVALID_ARGUMENT, _STRUCT_SIZE, _IMAGE_SIZE, _IMAGE_NOT_FINITE, _OUT_OF_MEMORY. */
GSCL_API GSCL_CHECKED gscl_result gscl_compare(const gscl_image *a, const gscl_image *b, gscl_comparison *comparison);

/* ---- Time of a context ---------------------------------------------------------------------- */

/* Time of one stage or kernel since the context was created or its timings were reset. */
typedef struct gscl_timing {
    const struct gscl_timing *next; /* NULL for the last row */
    const char *name;               /* of a stage, as "pyramid", or of a kernel, as "fit_tiles" */
    bool is_kernel;                 /* kernels run within stages: adding up rows of both kinds counts time twice */
    uint64_t count;                 /* stages that began; kernels that were launched */
    double seconds;                 /* stage: wall clock with the device's work; kernel: the device's clock */
    double kernel_seconds;          /* of a stage: the device's clock over all of its kernels; of a kernel: 0 */
    double build_seconds; /* kernel: wall clock of its first launches, in which some OpenCL implementations build
                                       it, unless it came from a cache; resetting keeps it; of a stage: 0 */
    uint64_t waits; /* of a stage: calls in which the host waited for the device (blocking copies, clFinish), without
                       those at the end of a stage, which only measuring makes; of a kernel: 0 */
    uint64_t items; /* of a kernel: work-items of all its launches; of a stage: 0 */
    uint64_t fewest_items; /* of a kernel: work-items of its smallest launch; of a stage: 0 */
} gscl_timing;

/* Returns the first row of a list, first stages, then kernels in the order of their first launch.  NULL for a context that
 * was created without `timing`, or before anything ran.  The list is valid until the context's next call. */
GSCL_API const gscl_timing *gscl_context_timings(const gscl_context *context);
/* Sets all times to zero. */
GSCL_API void gscl_context_reset_timings(gscl_context *context);

/* ---- Effects of a file ---------------------------------------------------------------------- */

/* The cost and the gain of one effect in a file.  This struct never changes. */
typedef struct gscl_effect_use {
    gscl_effect effect; /* exactly one */
    double bits;    /* of the file less those of the same splats written without the effect; NaN in the paper profile */
    double gain_db; /* PSNR of the file less that of the same splats drawn without the effect; NaN without an image, and
                       in the paper profile */
} gscl_effect_use;

/* Writes the splats of a file again without each effect that is on, and draws them if there is an image.  It does
 * not fit splats again without the effect.  `uses` has room for GSCL_MAX_EFFECTS rows; *count is the number of rows
 * written.  `settings` may be NULL for the defaults.  `image` is the encoded image with the channels of the decoded
 * one, or NULL; `context` may be NULL when `image` is.  Errors as gscl_inspect, and with an image those of
 * gscl_decode and gscl_compare. */
GSCL_API GSCL_CHECKED gscl_result gscl_inspect_effects(gscl_context *context, const uint8_t *bytes, size_t size,
                                                       const gscl_read_settings *settings, const gscl_image *image,
                                                       gscl_effect_use *uses, size_t *count);

/* ---- Speed of a device ---------------------------------------------------------------------- */

/* What the functions of this section draw and fit. */
typedef struct gscl_benchmark_settings {
    size_t struct_size;     /* set by gscl_benchmark_settings_default */
    uint32_t width, height; /* of the synthetic image, pixels; default 768x512 */
    uint32_t splats;        /* synthetic, with sizes and shapes like those of fitted splats; default 2500 */
    uint32_t repetitions;   /* timed runs, 1..1000; default 20; three more runs come first */
} gscl_benchmark_settings;

/* Sets a struct of struct_size bytes to the defaults.  Programs in C and C++ call gscl_benchmark_settings_default. */
GSCL_API void gscl_benchmark_settings_init(gscl_benchmark_settings *settings, size_t struct_size);
static inline void gscl_benchmark_settings_default(gscl_benchmark_settings *settings) {
    gscl_benchmark_settings_init(settings, sizeof *settings);
}

/* Times of one kernel, or of "fit step", which is all kernels of a gradient step on the wall clock.  Of kernels that do
 * not run in each step it is the mean of a step. */
typedef struct gscl_measurement {
    const char *name; /* static */
    const char *unit; /* of `work`: "flop", "byte", or "evaluation" of a splat at a pixel; static */
    gscl_blend blend; /* AUTO where it does not apply */
    uint32_t splats;  /* 0 where it does not apply */
    double work;      /* of one run, in `unit` */
    double needed;    /* evaluations inside the outlines of splats, the minimum for any renderer */
    double flop;      /* of one run, nominal: 28 for an evaluation of drawing, 100 for one of a step; 0 where unknown */
    double median_s, fastest_s, slowest_s; /* seconds of one run */
} gscl_measurement;
/* `measurement` is valid during the call. */
typedef void (*gscl_measurement_callback)(void *opaque, const gscl_measurement *measurement);

/* Measures the peak rates of the device: "multiply_add" and "copy".
 * This and all functions below need a context with `timing`, take NULL for the default settings, reset the context's
 * timings and call back once for each result, in order.  Errors: GSCL_ERROR_INVALID_ARGUMENT, _STRUCT_SIZE, and those of
 * memory and the device. */
GSCL_API GSCL_CHECKED gscl_result gscl_benchmark_device(gscl_context *context, const gscl_benchmark_settings *settings,
                                                        gscl_measurement_callback callback, void *opaque);
/* Measures the kernels of drawing and fitting, for each blend. */
GSCL_API GSCL_CHECKED gscl_result gscl_benchmark_kernels(gscl_context *context, const gscl_benchmark_settings *settings,
                                                         gscl_measurement_callback callback, void *opaque);

/* ---- Accuracy -------------------------------------------------------------------------------- */

/* How often the functions of this section run, and over how many splats. */
typedef struct gscl_accuracy_settings {
    size_t struct_size;   /* set by gscl_accuracy_settings_default */
    uint32_t repetitions; /* timed runs, 1..1000; default 20; three more runs come first */
    uint32_t splats;      /* whose derivatives are compared, 1..1000; default 48 */
} gscl_accuracy_settings;

/* Sets a struct of struct_size bytes to the defaults.  Programs in C and C++ call gscl_accuracy_settings_default. */
GSCL_API void gscl_accuracy_settings_init(gscl_accuracy_settings *settings, size_t struct_size);
static inline void gscl_accuracy_settings_default(gscl_accuracy_settings *settings) {
    gscl_accuracy_settings_init(settings, sizeof *settings);
}

/* Error and time of one way of drawing a file's splats.  `choice` names the property that varies:
 *   "support"      the radius at which Gaussians are cut off; `value` in sigmas.  Errors are against Gaussians that are
 *                  not cut off
 *   "exponential"  the variants "polynomial", "exp2" and "native_exp2"
 *   "precision"    the variants "float32" and, where the device has it, "float64"
 *   "early stop"   the transmittance below which no further splat is drawn; `value` 0 draws all.  Blend ALPHA only
 *   "quantiser"    the quantiser steps; `value` scales those of the encoder, rounded to steps that the format has.  Errors
 *                  are against splats that are not quantised.  Default profile with blends NORMALIZED and SUM only
 * All other errors are against the format's definition in double precision. */
typedef struct gscl_accuracy {
    const char *choice;               /* static */
    const char *variant;              /* one phrase, as "3.74 sigma"; valid during the callback */
    double value;                     /* of `choice`, which says what it is */
    bool is_default;                  /* whether gscl_decode draws in this way */
    gscl_blend blend;                 /* of the file */
    double largest_error, mean_error; /* of samples clamped to 0..1, in units of 1/255 */
    double ns_per_pixel;   /* all kernels of a drawing on the device's clock, median; 0 where it is the same */
    double bits_per_splat; /* of the file, for "quantiser"; else 0 */
    double psnr;           /* dB of the rendering against the image */
} gscl_accuracy;
/* `accuracy` is valid during the call. */
typedef void (*gscl_accuracy_callback)(void *opaque, const gscl_accuracy *accuracy);

/* Error of the derivatives of the fit's squared error, against central differences in double precision, for one kind of
 * parameter. */
typedef struct gscl_gradient_accuracy {
    const char *kind;     /* "position", "scale", "angle", "opacity" or "colour"; static */
    const char *variant;  /* of the exponential, as in gscl_accuracy; static */
    bool is_default;      /* whether gscl_encode uses this variant */
    gscl_blend blend;     /* of the file */
    uint32_t parameters;  /* number compared */
    double rms_error;     /* root mean square of the errors over that of the derivatives */
    double largest_error; /* largest error over the largest derivative */
    double ns_per_pixel;  /* drawing and differentiating on the device's clock, median */
} gscl_gradient_accuracy;
/* `accuracy` is valid during the call. */
typedef void (*gscl_gradient_callback)(void *opaque, const gscl_gradient_accuracy *accuracy);

/* Draws a file's splats in each way.  `image` is the image that was encoded, with the channels of the decoded one. */
GSCL_API GSCL_CHECKED gscl_result gscl_measure_accuracy(gscl_context *context, const gscl_image *image,
                                                        const uint8_t *bytes, size_t size,
                                                        const gscl_accuracy_settings *settings,
                                                        gscl_accuracy_callback callback, void *opaque);
/* Differentiates the squared error of a file's splats in a part of the image: at most 128x128 pixels around the splat that
 * is nearest to the image's centre. */
GSCL_API GSCL_CHECKED gscl_result gscl_measure_gradients(gscl_context *context, const gscl_image *image,
                                                         const uint8_t *bytes, size_t size,
                                                         const gscl_accuracy_settings *settings,
                                                         gscl_gradient_callback callback, void *opaque);

/* Decodes a file and draws it by the format's definition in double precision, which takes as long as on the device "host".
 * *largest_error is the largest difference of their samples, clamped to 0..1, with colours multiplied by alpha, in units of
 * 1/255.  The context needs no `timing` and may be that of the device "host".  Errors: as gscl_decode. */
GSCL_API GSCL_CHECKED gscl_result gscl_measure_decoding(gscl_context *context, const uint8_t *bytes, size_t size,
                                                        double *largest_error);

#ifdef __cplusplus
}
#endif
#endif
