/* Gradient descent on splats: a pyramid of the source, gradients and Adam on the device, density control.
 *
 * It may use: decode/ and lower rooms.
 *
 * In the order in which to read them:
 *   fit.h: the state of a fit, and its steps; the interface of the room
 *   pyramid.h: the source at sizes that halve from level to level
 *   fit_splats.c: the splats and the state of the optimiser for each
 *   fit_bin.c: the lists of the tiles, and links from splats to their entries
 *   fit_step.c: gradients and Adam
 *   fit_control.c: the loss and the bound on the tile occupancy, which the device follows
 *   tile_skip.h: tiles that are skipped for some steps
 *   fit_target.c: what splats are compared with
 *   fit_error.c: losses and errors
 *   level_residual.c: the detail that a finer level would add
 *   density.h: where splats are added
 *   placement.h: where a density puts new splats, how large and in which direction
 *   ssim_loss.h: kernels of SSIM: a term of the loss, weights and contrast gains
 *   ssim_weights.h: squared error that is weighted in place of MS-SSIM
 *   visual_loss.h: squared error and what people see, by SSIMULACRA 2, and a quadratic model of it
 *   tunables.h: numbers that were found by trying
 *   random.h: the random generator */
#ifndef GSCL_ROOM_LIB_FIT_H
#define GSCL_ROOM_LIB_FIT_H
#endif
