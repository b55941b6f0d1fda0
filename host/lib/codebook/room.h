/* The paper profile: Zhang et al., "2D Gaussian Splatting for Image Compression".
 *
 * It may use: session/ and lower rooms.
 *
 * In the order in which to read them:
 *   encode_codebook.h: the encode, a list of stages
 *   codebook_state.h: the state that the stages share
 *   codebook_plan.h: numbers of words, bits and splats of a file
 *   codebook_fit.h: the fit, at first of free splats, then with the straight-through estimator
 *   codebook_rounds.h: RDO rounds, and the passes that meet the budget
 *   codebook.h: the two codebooks, on the device and on the host
 *   codebook_cluster.h, kmeans.h: words by clustering
 *   codebook_order.h: the order of splats in the file
 *   codebook_step.h: steps of the optimiser
 *   codebook_rdo.h: a pass that chooses words and positions by rate and distortion
 *   codebook_quantise.h: words and splats as the file stores them
 *   tunables.h: the numbers that were found by trying */
#ifndef GSCL_ROOM_LIB_CODEBOOK_H
#define GSCL_ROOM_LIB_CODEBOOK_H
#endif
