/* Draws gscl files in double precision and without optimisation, as format/FORMAT.md describes it under
 * "Dequantisation" and "Rendering".  It takes the codes of a file from gsf_read and shares no other code with the
 * library, so that each can be compared with the other. */
#ifndef GSCL_ORACLE_H
#define GSCL_ORACLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "format/format.h"

#define ORACLE_CHANNELS 4

typedef enum { ORACLE_NORMALIZED, ORACLE_ALPHA, ORACLE_SUM } oracle_blend;

typedef struct {
    uint32_t width, height, splats;
    oracle_blend blend;
    uint32_t layout; /* 0 grey, 1 grey and alpha, 2 RGB, 3 RGB and alpha */
    bool high_bit_depth, has_chroma, has_alpha;
    uint32_t colours;  /* coded colour channels: 1, or 3 with has_chroma */
    uint32_t channels; /* coded channels: the colours, then alpha when has_alpha is set */
} oracle_header;

/* In pixels and radians; colours are those of the coded channels. */
typedef struct {
    double x, y;
    double s1, s2, theta;
    double colour[ORACLE_CHANNELS];
    double opacity;
    double amplitude, wavelength, direction, phase; /* of the wave; no wave where the amplitude is 0 */
} oracle_splat;

typedef struct {
    oracle_header header;
    double background[ORACLE_CHANNELS];
    oracle_splat *splats; /* header.splats of them, in stored order */
    uint32_t samples;     /* of a pixel of the output: 1 to 4, by the layout */
    double *pixels;       /* the output, width * height * samples, within 0..1, not rounded */
    double *low, *high;   /* the same of the coded values at the ends of the range in which a decoder's must lie */
} oracle_image;

/* A pixel's sums over the splats. */
typedef struct {
    double weight;    /* sum of the weights, with that of the background */
    double magnitude; /* S of FORMAT.md, "Precision" */
} oracle_sums;

/* Reads and draws a file.  Returns false when it cannot be read or memory runs out.  The image must be freed in any
 * case. */
bool oracle_decode(const uint8_t *bytes, size_t size, oracle_image *image);

/* Reads a file without drawing it: `pixels` stays NULL. */
bool oracle_read(const uint8_t *bytes, size_t size, oracle_image *image);

/* Sets background and splats from the codes; the header is in place. */
void oracle_dequantise(const gsf_coded_image *coded, oracle_image *image);

/* Computes the coded channels of every pixel, before clamping, width * height * channels values, and the sums of each
 * pixel. */
void oracle_draw(const oracle_image *image, double *values, oracle_sums *sums);

/* Clamps the coded channels and converts them to the samples of the layout: pixels, low and high of the image. */
void oracle_output(oracle_image *image, const double *values, const oracle_sums *sums);

/* Whether a decoder may return this sample (FORMAT.md, "Precision").  `peak` is 255 or 65535 for a rounded sample, or 0
 * for a floating-point sample in 0..1. */
bool oracle_allows(const oracle_image *image, size_t index, double sample, uint32_t peak);

/* A sample of the output, rounded: `peak` is 255 or 65535. */
uint32_t oracle_round(double sample, uint32_t peak);

void oracle_free(oracle_image *image);

#endif
