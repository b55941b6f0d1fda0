/* From the coded channels of pixels to samples in memory. */
#ifndef GSCL_LIB_SAMPLES_H
#define GSCL_LIB_SAMPLES_H

#include <gscl/gscl.h>

/* Stores `count` pixels from `pixels` on, of the kind of `image`.  values[k] has channel k of the `colours` (1 or 3)
 * colours, and of alpha behind them where has_alpha; they are clamped in place. */
void gscl_store_samples(const gscl_image *image, float *const values[4], int colours, bool has_alpha, int count,
                        void *pixels);

#endif
