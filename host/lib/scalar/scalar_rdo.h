/* Choosing codes by rate and distortion (cl/scalar_rdo.cl): the largest single gain of the default profile. */
#ifndef GSCL_LIB_SCALAR_RDO_H
#define GSCL_LIB_SCALAR_RDO_H

#include "cl/structs.h"
#include "decode/coded_image.h"
#include "fit/fit.h"
#include "scalar/rdo_groups.h"

/* The arrays and buffers of the passes.  They grow on demand and serve all passes of an encode.  Zeroed: empty. */
typedef struct gscl_scalar_rdo {
    size_t capacity; /* splats that fit in `codes` and `params` */
    gscl_codes *codes;
    float *params;
    gscl_rdo_tables *tables;
    gscl_rdo_groups groups;
    gscl_buffer device_codes, device_tables, device_tasks;
    gscl_buffer weights; /* sums of weights of the rendering, which is the renderer's image */
} gscl_scalar_rdo;

/* Accepts a zeroed object. */
void gscl_scalar_rdo_free(gscl_scalar_rdo *rdo, gscl_context *context);

typedef struct gscl_scalar_rdo_settings {
    double lambda_scale; /* price of a bit: lambda = lambda_scale * error / (2 * bits of the file) */
    bool keep_all;       /* no splat is dropped */
    bool scan_textures;  /* with has_texture: all waves are tried, else only those near a splat's own */
    /* What an elongated splat costs besides, in units of the squared error under it that it does not remove, from 0 at
     * an aspect ratio of 4 to all of it at 16.  A thin splat that leaves most of that error is seen as a needle. */
    double elongation_price;
    /* The smallest part of the squared error under a splat that its wave must explain, 0..1.  A wave that explains less
     * is seen as a grating that is not in the image. */
    double min_explained;
} gscl_scalar_rdo_settings;

/* Releases the plane of the passes, which the next one makes again. */
void gscl_scalar_rdo_release_plane(gscl_scalar_rdo *rdo);

/* The settings of encodes at this lambda_scale: splats may be dropped, artefacts have their price. */
gscl_scalar_rdo_settings gscl_scalar_rdo_default_settings(double lambda_scale);

/* Makes one pass over all splats of `coded` (scalar coding, blend normalized or sum): each splat's codes change, or the
 * splat is dropped, where that lowers squared error + lambda * bits.  Works at the fit's current level; the fit's
 * splats are overwritten. */
gscl_result gscl_scalar_rdo_pass(gscl_scalar_rdo *rdo, gscl_fit *fit, gscl_coded_image *coded,
                                 const gscl_scalar_rdo_settings *settings);

#endif
