/* Programs are built when first needed, one for each combination of source files and build options,
 * and kept in the context. */
#ifndef GSCL_LIB_KERNELS_H
#define GSCL_LIB_KERNELS_H

#include "runtime/context.h"

/* What kernels are specialised for: nothing that a picture does not have is compiled in. */
typedef struct gscl_kernel_options {
    int blend;         /* GSCL_NORMALIZED, GSCL_ALPHA, GSCL_SUM */
    int colours;       /* 1 or 3 */
    int alpha_channel; /* 0 or 1 */
    int opacity;       /* 0 or 1 */
    int texture;       /* 0 or 1 */
    int shape;         /* GSCL_SHAPE_... */
    int loss;          /* GSCL_LOSS_KIND_...; fit programs only */
    int weighted;      /* 0 or 1: squared errors count as much as a plane behind the target says; L2 only */
    /* For measuring what exactness costs (accuracy.c); 0 everywhere else. */
    double support;    /* cut-off, in units of q; 0: GSCL_SUPPORT */
    int exponential;   /* GSCL_EXPONENTIAL_... */
    double early_stop; /* transmittance below which `alpha` draws nothing behind */
    int is_double;     /* ACCURACY programs only */
} gscl_kernel_options;

/* Groups of kernels that are built together. */
typedef enum gscl_program_kind {
    /* These three draw: project, bin_bands, bin, raster_forward.  And: */
    GSCL_PROGRAM_RENDER,     /* raster_samples, which decoding ends with */
    GSCL_PROGRAM_FIT,        /* fit_tiles, sum_loss, gather_gradients, adam_step */
    GSCL_PROGRAM_SCALAR_RDO, /* rdo_begin, rdo_remove, rdo_evaluate, rdo_commit */
    GSCL_PROGRAM_CODEBOOK,   /* codebooks while fitting, and choosing their words */
    GSCL_PROGRAM_SSIM,       /* the SSIM loss */
    GSCL_PROGRAM_IMAGE,      /* pyramid and losses over images; no options */
    GSCL_PROGRAM_BENCHMARK,  /* what the device can do at best */
    GSCL_PROGRAM_ACCURACY,   /* project_exactly, raster_forward: in double precision */
    GSCL_PROGRAM_KINDS
} gscl_program_kind;

/* Gives a kernel of the program in *kernel; the context owns it.  One context, one thread: arguments may
 * be set on it until the next launch. */
gscl_result gscl_kernel(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                        const char *name, cl_kernel *kernel);

/* Pixels of a row that a work-item of this context's mapping handles at once. */
int gscl_mapping_lanes(const gscl_context *context);
/* Splats that a work-item of `project`, `gather_gradients` or `adam_step` handles at once (cl/splat_lanes.cl). */
int gscl_splat_lanes(const gscl_context *context, gscl_program_kind kind);
#define GSCL_MAX_SPLAT_LANES 16
/* Work-items of a group that draws one tile in this context's mapping. */
size_t gscl_tile_group_size(const gscl_context *context);

/* Groups of `group_size` work-items in which each takes one pixel vector of `rows` rows of `width` pixels. */
size_t gscl_chunk_groups(const gscl_context *context, int width, int rows, size_t group_size);

/* Frees all programs of a context. */
void gscl_programs_free(gscl_context *context);

#endif
