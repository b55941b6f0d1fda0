/* Code words by K-means over the splats' own parameters. */
#ifndef GSCL_LIB_CODEBOOK_CLUSTER_H
#define GSCL_LIB_CODEBOOK_CLUSTER_H

#include "codebook/codebook.h"

/* Clusters the splats' own parameters into at most `shapes` and `colours` words and assigns a word of each book to each
 * splat.  `warm` starts from the current words. */
gscl_result gscl_codebook_cluster(gscl_codebook *codebook, int shapes, int colours, bool warm, uint64_t *random);

#endif
