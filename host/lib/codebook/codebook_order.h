/* The order of splats in a file with codebooks. */
#ifndef GSCL_LIB_CODEBOOK_ORDER_H
#define GSCL_LIB_CODEBOOK_ORDER_H

#include "codebook/codebook.h"
#include "decode/coded_image.h"

/* Puts the splats into the order in which the file stores and draws them (large ones in the back), and gives every
 * shape word s1 >= s2.  `coded`, which has the encode's header, is overwritten. */
gscl_result gscl_codebook_sort(gscl_codebook *codebook, gscl_coded_image *coded);

#endif
