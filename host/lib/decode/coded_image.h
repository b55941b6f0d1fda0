/* A gsf_coded_image that owns its memory, and its conversion from and to bytes and parameters. */
#ifndef GSCL_LIB_CODED_IMAGE_H
#define GSCL_LIB_CODED_IMAGE_H

#include <gscl/gscl.h>

#include "format/format.h"
#include "runtime/context.h"
#include "runtime/kernel_options.h"

typedef struct gscl_coded_image {
    gsf_coded_image file;
    size_t capacity;  /* splats that fit in the arrays */
    uint32_t packets; /* among which it is going to be divided; 0: it is going to be a file */
    void *scratch;
} gscl_coded_image;

/* Makes room for `splats` splats of the coding that the header names; header and codes are kept. */
gscl_result gscl_coded_image_reserve(gscl_coded_image *coded, size_t splats);
/* Frees the arrays; accepts a zeroed coded image. */
void gscl_coded_image_free(gscl_coded_image *coded);

/* Reads a file, which may be bare; `coded` may hold anything before. */
gscl_result gscl_coded_image_read(gscl_coded_image *coded, const uint8_t *bytes, size_t size, bool bare);
/* The same, and counts 1/256 bits in `stream_bits256`: GSF_STREAM_COUNT numbers that must live as long as the coded
 * image, or NULL. */
gscl_result gscl_coded_image_read_counted(gscl_coded_image *coded, const uint8_t *bytes, size_t size, bool bare,
                                          uint64_t *stream_bits256);
/* Reads the splats that the first bytes of a file hold; *total is the number of splats of the whole file. */
gscl_result gscl_coded_image_read_prefix(gscl_coded_image *coded, const uint8_t *bytes, size_t size, bool bare,
                                         uint32_t *total);
/* Adds the packets that a list lacks and that its repair packets replace: in a new buffer, or *repaired is NULL where there
 * are none.  The functions above do it themselves. */
gscl_result gscl_repair_list(const uint8_t *list, size_t size, uint8_t **repaired, size_t *repaired_size);
/* Writes the file into a new buffer (gscl_free); sorts the splats into the stored order. */
gscl_result gscl_coded_image_write(gscl_coded_image *coded, uint8_t **bytes, size_t *size);
/* Sorts the splats into the stored order.  `order` is NULL or receives their old places: place i then holds the splat
 * that was at place order[i]. */
gscl_result gscl_coded_image_sort(gscl_coded_image *coded, size_t *order);

/* Stores a message for a result of the format, with versions and sizes, and returns the result. */
gscl_result gscl_coded_image_fail(gscl_context *context, gscl_result result, const uint8_t *bytes, size_t size);

/* The options of the kernels that draw the coded image (the loss stays 0). */
gscl_kernel_options gscl_coded_image_options(const gsf_header *header);
/* Clears the effects of splats in a header that has none: they are not coded. */
void gscl_forget_effects_without_splats(gsf_header *header);
/* Channels of the decoded image, 1..4. */
uint32_t gscl_coded_image_channels(const gsf_header *header);

/* Dequantises all splats (splat_count * GSCL_PARAMS parameters in drawing order) and the background. */
void gscl_coded_image_params(const gscl_coded_image *coded, float *params, float background[4]);

#endif
