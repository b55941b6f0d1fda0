/* Gradient descent on splats: a pyramid of the image, gradients and Adam on the device, density control.
 *
 * It may use: decode/ and lower rooms.
 *
 * In the order in which to read them:
 *   fit.h: the fit and its steps
 *   density.h: where splats are added
 *   ssim_loss.h: the SSIM term of the loss
 *   ssim_weights.c: squared error weighted for MS-SSIM
 *   level_detail.c: what a finer level would add
 *   random.h: the random generator */
#ifndef GSCL_ROOM_LIB_FIT_H
#define GSCL_ROOM_LIB_FIT_H
#endif
