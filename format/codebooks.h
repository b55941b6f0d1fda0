/* Coding of the two codebooks (FORMAT.md, "Codebooks"). */
#ifndef GSCL_FORMAT_CODEBOOKS_H
#define GSCL_FORMAT_CODEBOOKS_H

#include "format/coder.h"
#include "format/set.h"
#include "format/types.h"

/* Dimensions of a shape word (radius; + second radius; + angle) and of a colour word. */
unsigned gsf_shape_dims(const gsf_header *header);
unsigned gsf_colour_dims(const gsf_header *header);

/* Bits per code, counts and ranges.  False when a decoded value is outside its limits. */
bool gsf_code_codebook_sides(gsf_coder *coder, const gsf_header *header, gsf_codebooks *books);
/* The words themselves; `points` is room for GSF_MAX_CODEBOOK. */
void gsf_code_codebook_words(gsf_coder *coder, const gsf_header *header, gsf_codebooks *books, gsf_point *points);

/* What the format asks of counts, bits and ranges (reader and writer). */
bool gsf_codebook_sides_are_valid(const gsf_header *header, const gsf_codebooks *books);
/* What it asks of the words (writer; the reader cannot read anything else). */
bool gsf_codebook_words_are_valid(const gsf_header *header, const gsf_codebooks *books);
/* Sets the dimensions whose effect is off: round splats have s2 = s1, unrotated ones theta = 0. */
void gsf_complete_shape_words(const gsf_header *header, gsf_codebooks *books);

/* Axis of a shape word in whole pixels, rounded up. */
uint32_t gsf_shape_sigma(const gsf_codebooks *books, unsigned word, unsigned axis);

#endif
