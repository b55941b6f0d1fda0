/* Sorting of splats into the stored order (FORMAT.md, "Order"). */
#ifndef GSCL_FORMAT_ORDER_H
#define GSCL_FORMAT_ORDER_H

#include "format/types.h"

/* Bytes of memory (aligned for uint64_t) that gsf_sort_splats needs. */
size_t gsf_order_size(const gsf_header *header);
/* Sorts the splats into the stored order and zeroes the codes whose effect is off. */
void gsf_sort_splats(gsf_coded_image *image, void *memory);

#endif
