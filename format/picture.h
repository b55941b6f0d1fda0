/* The picture of a file, which is one stream of the range coder: its header and the payload (FORMAT.md, "File"). */
#ifndef GSCL_FORMAT_PICTURE_H
#define GSCL_FORMAT_PICTURE_H

#include "format/coder.h"
#include "format/types.h"

/* A picture is valid only if its decoder consumes exactly its bytes. */
bool gsf_picture_is_at_end(const gsf_coder *coder);

/* Reads a whole picture, or that of a packet where image->header.packets is not 0.  `scratch`: of gsf_scratch_size. */
gsf_result gsf_read_picture(gsf_coded_image *image, gsf_bytes picture, void *scratch);

/* Writes the picture of an image whose splats are in the stored order.  The coder counts the bytes that do not fit, so that
 * a capacity of 0 gives the size alone, without bits by stream. */
gsf_result gsf_write_picture(gsf_coded_image *image, uint8_t *bytes, size_t capacity, size_t *size, void *scratch);

#endif
