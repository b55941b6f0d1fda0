/* Sums over square windows. */
#ifndef GSCL_LIB_BOX_SUM_H
#define GSCL_LIB_BOX_SUM_H

/* Replaces each value of a map by the sum of those at most `radius` columns and rows away; values outside count as
 * 0.  Sums are made in double precision.  `scratch`: as many values as the longer side has. */
void gscl_box_sum(float *map, int width, int height, int radius, double *scratch);

#endif
