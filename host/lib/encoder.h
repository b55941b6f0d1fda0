/* What the stages of an encode share, and the two profiles. */
#ifndef GSCL_LIB_ENCODER_H
#define GSCL_LIB_ENCODER_H

#include "fit.h"
#include "image.h"
#include "picture.h"
#include "progress.h"

typedef struct gscl_encoder {
    gscl_context *context;
    const gscl_image *image;
    gscl_encode_settings settings; /* resolved: no AUTO left */
    gscl_content content;
    gscl_progress_state progress;
    uint64_t random;
    int first_level; /* finest level that is fitted; 0 unless the image is very large */
    float *planes;   /* the image at that level, */
    size_t pixels;   /* of so many pixels each */
    gscl_ground ground;
    gscl_picture picture; /* header filled in; the result */
    size_t decision_count;
    gscl_effect_decision decisions[GSCL_MAX_EFFECTS];
    uint32_t trials; /* of the search for a quality; 0 when there was none */
} gscl_encoder;

/* Fits splats so that the file has about `bytes` bytes (a profile's own estimate turns bytes into splats), or
 * exactly `splats` splats when bytes is 0, and leaves the result in encoder->picture.  The file is never
 * larger than `bytes`. */
gscl_result gscl_encode_scalar(gscl_encoder *encoder, size_t bytes, size_t splats);
gscl_result gscl_encode_codebook(gscl_encoder *encoder, size_t bytes, size_t splats);
/* A quick fit of the default profile, for the same budget and with the effects that the settings give: `mse` is the
 * squared error per sample (weighted where the fit is) before anything is chosen by rate.  Of the encoder only the
 * picture changes, which has no meaning afterwards. */
gscl_result gscl_sketch_scalar(gscl_encoder *encoder, size_t bytes, size_t splats, double *mse);
/* Splats beyond which more bytes are of no use to this image; no limit but the format's when `bytes` is 0 (the caller
 * asked for a number of splats). */
size_t gscl_most_splats(const gscl_encoder *encoder, size_t bytes);

/* Makes encoder->planes anew, of the channels that the header says. */
gscl_result gscl_encoder_make_planes(gscl_encoder *encoder);

/* GSCL_LOSS_KIND_... of a loss: SSIM comes from outside the fit's kernel. */
int gscl_loss_kind(gscl_loss loss);

/* The one of the two that the settings ask for. */
gscl_result gscl_encode_fit(gscl_encoder *encoder, size_t bytes, size_t splats);

/* Size of the encoder's picture as a file. */
gscl_result gscl_encoder_size(gscl_encoder *encoder, size_t *size);
/* PSNR of a file as it is decoded, against an image of the decode's kind. */
gscl_result gscl_file_psnr(gscl_context *context, const uint8_t *bytes, size_t size, const gscl_image *image,
                           double *psnr);
/* PSNR of the encoder's picture as its decoder draws it, against the image. */
gscl_result gscl_encoder_psnr(gscl_encoder *encoder, double *psnr);

/* Searches for the smallest file that reaches settings.target_value dB. */
gscl_result gscl_encode_to_psnr(gscl_encoder *encoder);

#endif
