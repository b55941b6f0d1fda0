/* Numbers of drawing by the host's processor that were found by trying. */
#ifndef GSCL_LIB_SOFTWARE_TUNABLES_H
#define GSCL_LIB_SOFTWARE_TUNABLES_H

/* Size of a block of pixels, whose sums stay in the processor's caches: columns and rows.  Tried on two Kodak images at
 * 0.183 bits per pixel: 512 x 16 and 768 x 16 take 2 % less time and twice or three times the memory, 128 x 16 and 256 x 8
 * take 3 % more, 64 x 16 takes 15 % more. */
#define GSCL_BLOCK_COLUMNS 256
#define GSCL_BLOCK_ROWS 16
/* Pixels that are drawn together: rows of a splat are lengthened to a multiple of it. */
#define GSCL_ROW_LANES 4

#endif
