/* The state of an encode, which its stages share, and the questions that all of them ask of it. */
#ifndef GSCL_LIB_ENCODER_H
#define GSCL_LIB_ENCODER_H

#include "fit/fit.h"
#include "image/image.h"
#include "decode/coded_image.h"
#include "session/progress.h"

typedef struct gscl_encode_trace gscl_encode_trace; /* encode_trace.h */

/* The image as it is fitted: planes of floats at the finest level of the pyramid. */
typedef struct gscl_source {
    int first_level; /* finest level that is fitted; 0 unless the image is very large */
    float *planes;   /* one after another, each of `pixels` values in 0..1 */
    size_t pixels;
    gscl_flat_background background;
} gscl_source;

typedef struct gscl_encoder {
    gscl_context *context;
    const gscl_image *image;
    gscl_encode_settings settings; /* resolved: no AUTO left */
    gscl_content content;
    gscl_progress_state progress;
    gscl_encode_trace *trace; /* NULL where the caller takes no report */
    uint64_t random;
    gscl_source source;
    gscl_coded_image coded; /* header filled in; the result */
    size_t decision_count;
    gscl_effect_decision decisions[GSCL_MAX_EFFECTS];
    uint32_t trials; /* of the search for a quality; 0 when there was none */
} gscl_encoder;

/* Splats beyond which more bytes are of no use to this image; no limit but the format's when `bytes` is 0 (the caller
 * asked for a number of splats). */
size_t gscl_max_splats(const gscl_encoder *encoder, size_t bytes);

/* Makes encoder->source.planes anew, of the channels that the header says. */
gscl_result gscl_encoder_make_planes(gscl_encoder *encoder);

/* GSCL_LOSS_KIND_... of a loss: SSIM comes from outside the fit's kernel. */
int gscl_loss_kind(gscl_loss loss);

/* Size of the encoder's picture as a file. */
gscl_result gscl_encoder_size(gscl_encoder *encoder, size_t *size);
/* PSNR of a file as it is decoded, against an image of the decode's kind. */
gscl_result gscl_file_psnr(gscl_context *context, const uint8_t *bytes, size_t size, const gscl_image *image,
                           double *psnr);
/* PSNR of the encoder's picture as its decoder draws it, against the image. */
gscl_result gscl_encoder_psnr(gscl_encoder *encoder, double *psnr);

#endif
