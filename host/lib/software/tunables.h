/* Numbers of drawing by the host's processor that were found by trying. */
#ifndef GSCL_LIB_SOFTWARE_TUNABLES_H
#define GSCL_LIB_SOFTWARE_TUNABLES_H

/* Size of a block of pixels, whose sums stay in the processor's first cache: columns and rows.  128 x 16 and 256 x 8 are
 * equally fast, 32 x 16 and 512 x 16 slower by a tenth. */
#define GSCL_BLOCK_COLUMNS 256
#define GSCL_BLOCK_ROWS 16
/* Pixels that are drawn together: rows of a splat are lengthened to a multiple of it. */
#define GSCL_ROW_LANES 4

#endif
