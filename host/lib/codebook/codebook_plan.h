/* Numbers of words, bits and splats of a file (P6). */
#ifndef GSCL_LIB_CODEBOOK_PLAN_H
#define GSCL_LIB_CODEBOOK_PLAN_H

#include "codebook/codebook.h"
#include "session/encoder.h"

typedef struct gscl_codebook_plan {
    size_t bytes;          /* budget; 0 where the number of splats is given */
    int words[GSCL_BOOKS]; /* at most, in each book */
    int word_bits;         /* of each dimension of a word */
    size_t first_splats;   /* splats at the first step of the fit */
    size_t splats;         /* splats at the end of the fit */
    int steps;             /* of free fit and straight-through fit together */
    int rounds;            /* RDO rounds */
    int round_steps;       /* steps of words and positions in each round */
} gscl_codebook_plan;

/* Plans a file of at most `bytes` bytes or, where `bytes` is 0, of `splats` splats. */
gscl_codebook_plan gscl_codebook_plan_make(const gscl_encoder *encoder, size_t bytes, size_t splats);

/* Splats that a file of `bits` bits holds, with words of `word_bits` bits a dimension. */
double gscl_codebook_splats_for(double bits, int shape_words, int colour_words, int word_bits, int colour_dims);

#endif
