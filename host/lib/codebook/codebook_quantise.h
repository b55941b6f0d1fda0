/* Words and splats as the integers of the file (P8). */
#ifndef GSCL_LIB_CODEBOOK_QUANTISE_H
#define GSCL_LIB_CODEBOOK_QUANTISE_H

#include "codebook/codebook.h"
#include "decode/coded_image.h"

/* Writes words and splats as codes, from the host copies. */
gscl_result gscl_codebook_quantise(const gscl_codebook *codebook, gscl_coded_image *coded);

/* Drops the words of a coded image that none of its splats uses. */
void gscl_coded_codebooks_drop_unused(gsf_coded_image *file);

#endif
