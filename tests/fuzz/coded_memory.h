/* Memory of coded images for fuzz targets.  It is allocated once, because allocations would take most of the time of an
 * input.  With AddressSanitizer, what lies behind the arrays of an image must not be touched. */
#ifndef GSCL_FUZZ_CODED_MEMORY_H
#define GSCL_FUZZ_CODED_MEMORY_H

#include "format/format.h"

#define FUZZ_MAX_SPLATS 5000u  /* keeps the time of an input short; above the number of priors */
#define FUZZ_MAX_FILE 2000000u /* bytes: gsf_write_bound of FUZZ_MAX_SPLATS splats is below it */

typedef struct fuzz_memory {
    gsf_splat splats[FUZZ_MAX_SPLATS + 1];
    gsf_indexed_splat indexed[FUZZ_MAX_SPLATS + 1];
    uint16_t shape_words[GSF_MAX_CODEBOOK][GSF_SHAPE_DIMS];
    uint16_t colour_words[GSF_MAX_CODEBOOK][GSF_MAX_COLOUR_DIMS];
    uint64_t stream_bits256[GSF_STREAM_COUNT];
} fuzz_memory;

/* An image with this header and the arrays that it needs.  Returns false when it has too many splats. */
bool fuzz_create(gsf_coded_image *image, fuzz_memory *memory, const gsf_header *header);
/* Working memory of gsf_scratch_size, until the next call. */
void *fuzz_scratch(const gsf_header *header);
/* Ends the program with this message unless the condition holds. */
void fuzz_require(bool condition, const char *message);

#endif
