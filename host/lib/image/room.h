/* Images in memory: planar floats, quality metrics, flat backgrounds, box sums.
 *
 * It may use: runtime/.
 *
 * In the order in which to read them:
 *   image.h: from interleaved samples to planes
 *   metrics.h: PSNR, SSIM, MS-SSIM, SSIMULACRA 2
 *   ssimulacra2.h: the last of them, and its sum before the mapping to a score
 *   flat_background.h: the uniform background of drawings
 *   box_sum.h: sums over square windows
 *   tunables.h: the numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_IMAGE_H
#define GSCL_ROOM_LIB_IMAGE_H
#endif
