/* The paper profile's two codebooks while fitting (P5): shapes (ln s1, ln s2, theta) and colours (channels, opacity
 * logit) of all splats are code words, learnt together with the splats on the device (cl/codebook.cl). */
#ifndef GSCL_LIB_CODEBOOK_H
#define GSCL_LIB_CODEBOOK_H

#include "cl/constants.h"
#include "fit/fit.h"
#include "format/format.h"

#define GSCL_BOOK_BYTES (GSF_MAX_CODEBOOK * GSCL_BOOK_DIMS * sizeof(float))

typedef struct gscl_book {
    int count;                               /* words */
    int bits;                                /* of each dimension in the file */
    float *words;                            /* the host's copy, as of the last gscl_codebook_read_back */
    gscl_buffer learnt;                      /* words of the optimiser, not rounded */
    gscl_buffer stored;                      /* the same, rounded to values of the file */
    gscl_buffer first_moment, second_moment; /* of Adam */
} gscl_book;

typedef struct gscl_codebook {
    gscl_fit *fit;
    gscl_book books[GSCL_BOOKS];
    int position_bits;
    int age;              /* steps of the books' optimiser since its last restart */
    gscl_buffer learnt;   /* the splats' own parameters; fit->renderer.params has those that the words give them */
    gscl_buffer indices;  /* int2: shape, colour */
    float *words;         /* of all books */
    float *params;        /* host copy of `learnt`, as of the last gscl_codebook_read_back */
    int32_t (*pairs)[2];  /* host copy of `indices` */
    float *sorted_params; /* scratch of gscl_codebook_sort, as are the next two */
    int32_t (*sorted_pairs)[2];
    size_t *order;
} gscl_codebook;

/* Creates empty books for the fit's splats, whose number must not grow afterwards.  `codebook` may hold anything
 * before. */
gscl_result gscl_codebook_create(gscl_codebook *codebook, gscl_fit *fit, int position_bits, int shape_bits,
                                 int colour_bits);
/* Accepts a codebook that was zeroed and never created. */
void gscl_codebook_free(gscl_codebook *codebook);

/* Copies parameters, indices and words from the device to the host. */
gscl_result gscl_codebook_read_back(gscl_codebook *codebook);
/* Copies parameters, indices and words from the host to the device. */
gscl_result gscl_codebook_upload(gscl_codebook *codebook);
/* Drops the words that no splat uses, in the host copies. */
void gscl_codebook_drop_unused(gscl_codebook *codebook);

static inline size_t gscl_codebook_splats(const gscl_codebook *codebook) {
    return (size_t)codebook->fit->renderer.count;
}
static inline int gscl_codebook_channels(const gscl_codebook *codebook) {
    return codebook->fit->renderer.channels;
}
/* Dimensions of a word, 1..GSCL_BOOK_DIMS. */
static inline int gscl_codebook_dims(const gscl_codebook *codebook, int book) {
    return book == GSCL_BOOK_SHAPE ? GSCL_BOOK_SHAPE_DIMS : gscl_codebook_channels(codebook) + 1;
}

#endif
