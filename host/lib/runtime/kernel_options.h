/* The kinds of programs, and the options that their kernels are specialised for. */
#ifndef GSCL_LIB_KERNEL_OPTIONS_H
#define GSCL_LIB_KERNEL_OPTIONS_H

/* Options that kernels are specialised for: code for features that an image lacks is not compiled.  Each field becomes
 * a macro of the programs that it changes (build_options.c). */
typedef struct gscl_kernel_options {
    int blend;         /* GSCL_NORMALIZED, GSCL_ALPHA, GSCL_SUM */
    int colours;       /* colour channels, 1 or 3 */
    int alpha_channel; /* 0 or 1: a channel of transparency follows the colours */
    int opacity;       /* 0 or 1: splats have an opacity; else all are opaque */
    int texture;       /* 0 or 1: splats may have a wave */
    int shape;         /* GSCL_SHAPE_... */
    /* For FIT and CODEBOOK only. */
    int loss; /* GSCL_LOSS_KIND_... */
    /* For FIT, CODEBOOK and SCALAR_RDO only. */
    int weighted; /* GSCL_WEIGHTED_...: a plane behind the target weights squared errors; loss L2 only */
    /* For measurements of precision (room `measure`); 0 everywhere else. */
    double support;    /* cut-off of a Gaussian, in units of q; 0: GSCL_SUPPORT */
    int exponential;   /* GSCL_EXPONENTIAL_...; 0: the polynomial */
    double early_stop; /* blend `alpha`: transmittance below which nothing behind is drawn; 0: never */
    int is_double;     /* 0 or 1: double precision; ACCURACY only */
} gscl_kernel_options;

/* Groups of kernels that are built together. */
typedef enum gscl_program_kind {
    GSCL_PROGRAM_RENDER,     /* project, raster_forward, and raster_samples, the end of a decode */
    GSCL_PROGRAM_BIN,        /* begin_lists, bin: the lists of tiles, and their links */
    GSCL_PROGRAM_FIT,        /* fit_tiles, step_splats */
    GSCL_PROGRAM_GRADIENTS,  /* gather_gradients, adam_step: the parts of step_splats */
    GSCL_PROGRAM_SCALAR_RDO, /* rdo_begin, rdo_visit */
    GSCL_PROGRAM_CODEBOOK,   /* fitting through codebooks, and choosing their words */
    GSCL_PROGRAM_SSIM,       /* the SSIM loss */
    GSCL_PROGRAM_VISUAL,     /* the visual loss */
    GSCL_PROGRAM_IMAGE,      /* pyramid, losses over whole images, and where splats are added */
    GSCL_PROGRAM_BENCHMARK,  /* multiply_add and copy: the device's peak rates */
    GSCL_PROGRAM_ACCURACY,   /* project_double and raster_forward in double precision */
    GSCL_PROGRAM_KINDS
} gscl_program_kind;

#endif
