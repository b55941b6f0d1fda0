/* The plan of 'gscl tradeoff', its results, and the measurements. */
#ifndef GSCL_TOOL_TRADEOFF_H
#define GSCL_TOOL_TRADEOFF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>
#include <gscl/measure.h>

#include "cli/device_choice.h"

#define TRADEOFF_EFFORTS (GSCL_MAX_EFFORT + 1)
#define TRADEOFF_RATES 6
#define TRADEOFF_BLENDS 3 /* all but GSCL_BLEND_AUTO */
#define TRADEOFF_MAX_ACCURACIES 128
#define TRADEOFF_MAX_GRADIENTS 64

typedef struct tradeoff_plan {
    device_choice choice;
    const char *image_name;
    const gscl_image *image;
    uint64_t bytes;  /* file size at which efforts are compared */
    uint64_t effort; /* effort at which rates are compared */
    bool quick;
} tradeoff_plan;

/* One encode and the decode of its file. */
typedef struct tradeoff_encode {
    int effort;
    double bpp;                /* of the file */
    double psnr, ms_ssim;      /* psnr in dB; NaN if the image is too small */
    double encode_s, decode_s; /* fastest of several runs, with compiled kernels */
    gscl_encode_report report;
} tradeoff_encode;

typedef struct tradeoff_accuracy {
    gscl_accuracy row; /* row.variant points to `variant` */
    char variant[32];
    double
        psnr_same_size; /* dB of an encode with these steps at the fixed size; 0 for other choices than "quantiser" */
} tradeoff_accuracy;

typedef struct tradeoff_results {
    gscl_device_info device;
    size_t effort_count, rate_count, accuracy_count, gradient_count;
    tradeoff_encode efforts[TRADEOFF_EFFORTS]; /* at the fixed size */
    tradeoff_encode rates[TRADEOFF_RATES];     /* at the fixed effort, small files first */
    tradeoff_accuracy accuracies[TRADEOFF_MAX_ACCURACIES];
    gscl_gradient_accuracy gradients[TRADEOFF_MAX_GRADIENTS];
    uint8_t *files[TRADEOFF_BLENDS]; /* of the fixed size and effort */
    size_t sizes[TRADEOFF_BLENDS];
    char subtitle[320]; /* of the plots: image, size, effort, device */
} tradeoff_results;

/* Measures efforts and rates, and leaves a file of each blend.  Reports errors and returns an exit code. */
int tradeoff_measure_codec(const tradeoff_plan *plan, tradeoff_results *results);
/* Measures the accuracy of the renderer and of the gradients on those files.  Reports errors and returns an exit code. */
int tradeoff_measure_accuracy(const tradeoff_plan *plan, tradeoff_results *results);

#endif
