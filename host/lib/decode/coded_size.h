/* The size of a coded image as a file or as packets. */
#ifndef GSCL_LIB_CODED_SIZE_H
#define GSCL_LIB_CODED_SIZE_H

#include "decode/coded_image.h"

/* The exact size of the file that gscl_coded_image_write would write, or of the packets (gscl_packets_size).  The splats
 * must be in the stored order. */
gscl_result gscl_coded_image_size(gscl_coded_image *coded, size_t *size);

#endif
