/* Coding of the two codebooks (FORMAT.md, "Codebooks"). */
#ifndef GSCL_FORMAT_CODEBOOKS_H
#define GSCL_FORMAT_CODEBOOKS_H

#include "format/coder.h"
#include "format/set.h"
#include "format/types.h"

/* Numbers of dimensions of a shape word (s1; s2 with anisotropy; theta with rotation) and of a colour word. */
unsigned gsf_shape_dims(const gsf_header *header);
unsigned gsf_colour_dims(const gsf_header *header);

/* Codes the bits of a code, counts and ranges. */
void gsf_code_codebook_parameters(gsf_coder *coder, const gsf_header *header, gsf_codebooks *books);
/* Codes the words.  `points` is working memory for GSF_MAX_CODEBOOK points. */
void gsf_code_codebook_words(gsf_coder *coder, const gsf_header *header, gsf_codebooks *books, gsf_point *points);

/* Whether counts, bits and ranges are within their limits (writer; decoded ones always are). */
bool gsf_codebook_parameters_are_valid(const gsf_header *header, const gsf_codebooks *books);
/* Whether the words are within their limits and in order (writer; decoded words always are). */
bool gsf_codebook_words_are_valid(const gsf_header *header, const gsf_codebooks *books);
/* Sets the dimensions whose effect is off: s2 = s1 without anisotropy, theta = 0 without rotation. */
void gsf_complete_shape_words(const gsf_header *header, gsf_codebooks *books);

/* Axis of a shape word in whole pixels, rounded up. */
uint32_t gsf_shape_sigma(const gsf_codebooks *books, unsigned word, unsigned axis);

#endif
