/* The start of the picture (FORMAT.md, "Header"): kind, size, number of splats, steps and background. */
#ifndef GSCL_FORMAT_HEADER_H
#define GSCL_FORMAT_HEADER_H

#include "format/coder.h"
#include "format/types.h"

/* Number of coded channels: 1 or 3 for colour, and 1 for alpha. */
unsigned gsf_channel_count(const gsf_header *header);

/* Whether all fields are within their limits (writer; a decoded header always is). */
bool gsf_header_is_valid(const gsf_header *header);

/* The steps that take one bit in a file with so many splats: finer colours from GSF_MANY_SPLATS on. */
#define GSF_MANY_SPLATS 640u
gsf_steps gsf_default_steps(uint64_t splat_count);

/* Codes kind, size and number of splats, and before them what a packet says of itself: a reader sets header->packets to 1
 * for a packet, to 0 for a whole picture.  Every decoded header is valid. */
void gsf_code_fields(gsf_coder *coder, gsf_header *header);
/* Codes the whole header: the fields, the steps of scalar coding where there are splats, and the background.  The caller
 * checks whether the input ran out. */
void gsf_code_header(gsf_coder *coder, gsf_coded_image *image);

#endif
