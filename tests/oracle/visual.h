/* The visual loss (cl/visual.cl) in double precision. */
#ifndef GSCL_ORACLE_VISUAL_H
#define GSCL_ORACLE_VISUAL_H

/* The weighted sum of errors in luma of SSIMULACRA 2 with the weights of the visual loss, for planes of `colours` (1 or 3)
 * sRGB samples in 0..1.  The images are `level` of a pyramid: they have no finer scale.  Scales before `first` are not
 * counted: 2 for the visual loss, 0 for SSIMULACRA 2.  `peaks`: weight of the 6-norm of the error at the first scale. */
double oracle_visual_sum(const double *target, const double *rendering, int colours, int width, int height, int level,
                         int first, double peaks);

#endif
