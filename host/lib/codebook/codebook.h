/* The paper profile's codebooks while fitting (P5): shapes (ln s1, ln s2, theta) and colours (channels, opacity logit)
 * of all splats are words of two codebooks, learnt with the splats on the device (cl/codebook.cl). */
#ifndef GSCL_LIB_CODEBOOK_H
#define GSCL_LIB_CODEBOOK_H

#include "cl/constants.h"
#include "decode/coded_image.h"
#include "fit/fit.h"

typedef struct gscl_book {
    int count;                                               /* words */
    int bits;                                                /* of each dimension in the file */
    float *words;                                            /* the host's copy, as of the last gscl_codebook_pull */
    gscl_buffer learnt, stored, first_moment, second_moment; /* stored: rounded to what the file can hold */
} gscl_book;

typedef struct gscl_codebook {
    gscl_fit *fit;
    gscl_book books[GSCL_BOOKS];
    int position_bits;
    int age;             /* steps of the books' optimiser */
    gscl_buffer learnt;  /* the splats' own parameters; fit->renderer.params is what their words make of them */
    gscl_buffer indices; /* cl_int2: shape, colour */
    float *params;       /* host copies, as of the last gscl_codebook_pull */
    cl_int (*pairs)[2];
    size_t capacity;
} gscl_codebook;

/* Takes over the fit's splats.  `codebook` may hold anything before. */
gscl_result gscl_codebook_create(gscl_codebook *codebook, gscl_fit *fit, int position_bits, int shape_bits,
                                 int colour_bits);
void gscl_codebook_free(gscl_codebook *codebook);

/* Clusters the splats' own parameters into at most `shapes` and `colours` words; `warm` starts from the words
 * there are. */
gscl_result gscl_codebook_cluster(gscl_codebook *codebook, int shapes, int colours, bool warm, uint64_t *random);
/* Puts the splats into the order in which the file stores and draws them (large ones in the back), with the words' axes
 * in order, s1 >= s2.  `picture`, of the encode's header, is overwritten. */
gscl_result gscl_codebook_sort(gscl_codebook *codebook, gscl_coded_image *picture);
/* Projects what the words make of the splats. */
gscl_result gscl_codebook_project(gscl_codebook *codebook);
/* A step of the splats' own parameters, straight through the codebooks. */
gscl_result gscl_codebook_step_through(gscl_codebook *codebook, float rate);
/* A step of the words and the positions. */
gscl_result gscl_codebook_step(gscl_codebook *codebook, float rate);
/* Starts the optimiser of words and positions afresh. */
gscl_result gscl_codebook_rest(gscl_codebook *codebook);

/* Copies parameters, indices and words to the host, and back. */
gscl_result gscl_codebook_pull(gscl_codebook *codebook);
gscl_result gscl_codebook_push(gscl_codebook *codebook);
/* Drops the words that no splat uses (host copies). */
void gscl_codebook_compact(gscl_codebook *codebook);

/* Writes the splats as codes (host copies must be current). */
gscl_result gscl_codebook_quantise(const gscl_codebook *codebook, gscl_coded_image *picture);

/* Drops the words of a picture that none of its splats uses. */
void gscl_codebook_drop_unused(gsf_coded_image *file);

/* A pass over all splats that chooses words and cells by rate and distortion (cl/codebook_rdo.cl); `lambda`: squared
 * error per bit; `keep_all`: none is dropped.  Splats must be in drawing order and projected. */
gscl_result gscl_codebook_choose(gscl_codebook *codebook, double lambda, bool keep_all);

#endif
