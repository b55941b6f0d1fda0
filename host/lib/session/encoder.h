/* The state of one encode.  Each stage of encode/encode.c takes it and leaves one named result in it. */
#ifndef GSCL_LIB_ENCODER_H
#define GSCL_LIB_ENCODER_H

#include "decode/coded_image.h"
#include "decode/packet_target.h"
#include "fit/fit.h"
#include "image/image.h"
#include "session/effects.h"
#include "session/progress.h"

typedef struct gscl_encode_trace gscl_encode_trace; /* encode_trace.h */

/* The image as it is fitted: planes of floats at the finest level of the pyramid.  Stages after "decide effects" work
 * on the planes; the caller's image serves to measure results. */
typedef struct gscl_source {
    uint32_t image_width, image_height; /* full size, pixels */
    int first_level;                    /* finest level that is fitted; 0 unless the image is very large */
    uint32_t width, height;             /* of that level, pixels */
    size_t pixels;                      /* width * height */
    float *planes;                      /* one after another, each of `pixels` values in 0..1; NULL after the last fit
                                           has taken them */
    gscl_flat_background background;
} gscl_source;

/* The size that the coded image of a fit should have.  During the encode it is bare: the container of the file is added
 * when it is written. */
typedef struct gscl_size_target {
    size_t bytes;  /* budget of the picture alone; 0: `splats` holds */
    size_t splats; /* the exact number, where `bytes` is 0 */
} gscl_size_target;

typedef struct gscl_encoder {
    /* Set before the first stage, constant afterwards. */
    gscl_context *context;
    gscl_encode_settings settings;     /* without AUTO; the tune from the stage "resolve target" on */
    int loss_kind;                     /* GSCL_LOSS_KIND_... of the settings' loss */
    gsf_bytes blocks[GSF_BLOCK_COUNT]; /* of the settings */

    /* Services of all stages. */
    gscl_progress_state progress;
    gscl_encode_trace *trace; /* NULL where the caller takes no report */

    /* Stage "prepare". */
    gscl_content content;
    gscl_source source; /* without planes where the image is flat */
    size_t max_splats;  /* beyond these, more bytes are of no use to this image */

    /* Stage "resolve target": of the first fit; where the target is a quality, a guess. */
    gscl_size_target target;
    bool accepts_less; /* the best file is the result where the target, a quality, cannot be reached */
    gscl_packet_target packets;

    /* Stage "decide effects". */
    gscl_effects effects;
    gsf_header header; /* of the coded image before the fit, with its effects */

    /* Stages "fit" to "meet the budget". */
    uint64_t random;        /* state of the random generator */
    gscl_coded_image coded; /* the result */
    bool may_search_smooth; /* another fit follows where the first one is nearly exact: the source is needed for it */
    uint32_t trials;        /* fits of the search for a quality, without its probes; 0 without one */
    double quality;         /* of `coded`, where the target is a quality; NAN: not measured */
} gscl_encoder;

/* Makes planes of the channels that the header has, and looks for a flat background.  `source` may hold anything
 * before, which is not freed. */
gscl_result gscl_source_create(gscl_source *source, gscl_context *context, const gscl_image *image,
                               const gsf_header *header);
/* Accepts a zeroed source. */
void gscl_source_free(gscl_source *source);

/* Frees the planes of encoder->source once a fit has taken them, unless fits for other sizes follow. */
void gscl_encoder_release_source(gscl_encoder *encoder);

/* Sets encoder->coded to a coded image without splats, of the header's effects. */
void gscl_encoder_restart(gscl_encoder *encoder);
/* Size of a coded image as a file. */
gscl_result gscl_file_size(gscl_context *context, gscl_coded_image *coded, size_t *size);
/* Whether this target is a quality, which takes encodes of several sizes to meet. */
static inline bool gscl_target_is_quality(gscl_target target) {
    return target == GSCL_TARGET_PSNR || target == GSCL_TARGET_SSIMULACRA2;
}

/* Quality of a coded image as its decoder draws it, against an image of the decode's kind; `measure`: a target that is a quality. */
gscl_result gscl_coded_quality(gscl_context *context, gscl_coded_image *coded, const gscl_image *image,
                               gscl_target measure, double *quality);
/* The same of encoder->coded as its decoder draws it, against the image; `measure`: a target that is a quality. */
gscl_result gscl_encoder_quality(gscl_encoder *encoder, const gscl_image *image, gscl_target measure, double *quality);
/* The same of a file, against an image of the decode's kind. */
gscl_result gscl_file_quality(gscl_context *context, const uint8_t *bytes, size_t size, bool bare,
                              const gscl_image *image, gscl_target measure, double *quality);

#endif
