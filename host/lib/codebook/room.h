/* The paper profile: Zhang et al., "2D Gaussian Splatting for Image Compression".
 *
 * It may use: session/ and lower rooms.
 *
 * In the order in which to read them:
 *   encode_codebook.h: the profile from start to end
 *   codebook.h: codebooks while fitting
 *   kmeans.h: clustering
 *   codebook_rdo.c: choosing words by rate and distortion
 *   codebook_quantise.c: words as the file stores them */
#ifndef GSCL_ROOM_LIB_CODEBOOK_H
#define GSCL_ROOM_LIB_CODEBOOK_H
#endif
