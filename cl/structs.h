/* Structs that the C host and the OpenCL C kernels share: kernel arguments and elements of buffers.  All fields are
 * four bytes wide, so that both compilers lay them out alike. */
#ifndef GSCL_CL_STRUCTS_H
#define GSCL_CL_STRUCTS_H

#ifdef __OPENCL_VERSION__
typedef int int32_t;
#else
#include <stdint.h>

#include "cl/constants.h"
#endif

/* The part of the plane that is drawn.  A point p of the full-size image appears at p * inv_scale * (1, row_scale) - (x, y). */
typedef struct gscl_view {
    float inv_scale; /* 1: full size; 1/2, 1/4, ...: levels of the pyramid */
    float row_scale; /* 1: every row of the level is drawn; 1/2: every second one */
    float blur;      /* variance in full-size pixels that the level's box filter adds to a splat */
    float x, y;      /* origin, drawn pixels */
    int32_t tiles_x, tiles_y;
} gscl_view;

/* An image on the device: planes of width * height floats one after another, drawn by tiles. */
typedef struct gscl_image_shape {
    int32_t width, height; /* pixels */
    int32_t tiles_x, tiles_y;
} gscl_image_shape;

/* Adding a small plane to one that is 2^shift times as large. */
typedef struct gscl_enlargement {
    int32_t from_width, from_height, width, height; /* pixels */
    int32_t shift;
    float share; /* factor on the values of the small plane */
} gscl_enlargement;

/* Binning splats into the lists of tiles (cl/bin.cl). */
typedef struct gscl_bin_settings {
    int32_t splats;
    int32_t band_rows; /* rows of tiles that share a list of splats */
    int32_t tiles_x, tiles_y;
    int32_t row_capacity; /* entries that each row of tiles owns */
} gscl_bin_settings;

/* Samples of an image in memory. */
typedef struct gscl_sample_layout {
    int32_t channels;      /* 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA */
    int32_t sample;        /* GSCL_SAMPLE_KIND_... */
    int32_t premultiplied; /* 0 or 1 */
} gscl_sample_layout;

/* Bounds of the parameters while fitting, and one step's factor on the learning rates. */
typedef struct gscl_limits {
    float rate;
    float width, height;    /* pixels: centres stay inside the full-size image */
    float log_min, log_max; /* of an axis; gscl_fit_control has the present upper bound */
    float log_aspect;       /* largest |ln s1 - ln s2| */
    float colour_min, colour_max;
} gscl_limits;

/* One step of the fit over the tiles of a level (cl/fit.cl). */
typedef struct gscl_fit_settings {
    gscl_image_shape shape;      /* of the rows that are drawn */
    int32_t row_step, first_row; /* of the level, which the drawn rows are */
    int32_t level_height;        /* pixels */
    float derivative_scale;      /* of the loss: makes the levels of the pyramid and the choices of rows agree */
    int32_t step;                /* since the last reset of skipped tiles */
} gscl_fit_settings;

/* What the device follows of a fit, so that the host need not wait for it (cl/sums.cl). */
typedef struct gscl_fit_control {
    float loss;           /* mean per sample, when it was last summed */
    float skip_threshold; /* loss per pixel below which a tile is skipped; 0: none is */
    float log_max;        /* present bound of an axis, at most gscl_limits.log_max */
    float low_splats;     /* share of the splats that are hardly higher than a row of the level */
} gscl_fit_control;

/* How the control follows the lists of the tiles and the loss. */
typedef struct gscl_control_settings {
    float max_entries; /* of all lists, above which log_max is reduced */
    float reduction;   /* of log_max */
    float log_min;     /* its lower bound */
    int32_t losses;    /* of tiles or of parts, which are summed; 0: loss and threshold stay */
    float loss_scale;  /* 1 / samples of a step */
    float threshold_per_loss;
    int32_t splats;
    float low_height;  /* half the height of an outline, drawn rows; lower splats count as low */
    int32_t low_parts; /* parts whose low splats are counted already; 0: none are */
} gscl_control_settings;

/* The links of a splat to its entries, which lie one after another (cl/links.cl): one for each tile of its box, row by
 * row.  That of the tile (x, y) is link origin + y * stride + x. */
typedef struct gscl_link_grid {
    int32_t first, count; /* 0 links where no more fit in the buffer */
    int32_t origin, stride;
} gscl_link_grid;

/* The fitted splats, as gradients are summed for them (cl/update.cl). */
typedef struct gscl_gather_settings {
    int32_t splats;
    gscl_view view;
} gscl_gather_settings;

/* One step of Adam (cl/update.cl). */
typedef struct gscl_adam_settings {
    int32_t splats;
    int32_t fixed;  /* the first splats, which keep their parameters */
    gscl_view view; /* of the projection that follows */
    gscl_limits limits;
} gscl_adam_settings;

/* Placing splats on a level of the pyramid (cl/placement.cl). */
typedef struct gscl_placement_settings {
    int32_t width, height, channels; /* of the level: pixels */
    float scale;                     /* full-size pixels of a pixel */
    int32_t strip;                   /* height of a strip of the walk, pixels */
    int32_t columns;                 /* of all strips */
    float density_scale;             /* factor on the densities; their box sums become means */
    int32_t has_background;          /* 0 or 1: a flat background needs no first splats away from edges */
    float tolerance;                 /* between colours of the background */
    int32_t first, count;            /* the place of the first new splat, and their number */
    /* Sigma of a splat, full-size pixels: that of a distance of 1 between samples, times this distance within bounds. */
    float axis, least_distance, most_distance;
    float opacity;                          /* logit */
    int32_t is_rotated;                     /* 0 or 1: splats have an angle */
    float min_axis, edge_stretch, min_edge; /* gscl_fit_tunables */
    int32_t max_edge_radius;
} gscl_placement_settings;

/* The planes of an image in cl/ssim.cl. */
typedef struct gscl_ssim_shape {
    int32_t width, height, channels;
    int32_t stride; /* floats from row to row of a padded plane */
} gscl_ssim_shape;

/* A scale of the visual loss (cl/visual.cl). */
typedef struct gscl_visual_scale {
    int32_t width, height; /* pixels */
    int32_t stride;        /* floats from row to row of a padded plane */
    int32_t before;        /* floats of plain planes of larger scales, one plane of each */
    int32_t padded_before; /* of padded planes, likewise */
} gscl_visual_scale;

/* All scales with terms, the largest first; those behind them have no pixels. */
typedef struct gscl_visual_scales {
    gscl_visual_scale scale[GSCL_VISUAL_TERM_SCALES];
    int32_t count;
} gscl_visual_scales;

/* Weights at one scale: of the mean and the 4-norm of structure, artefacts and lost detail, and of the 6-norm of
 * the error. */
typedef struct gscl_visual_weights {
    float weight[GSCL_VISUAL_SUMS];
} gscl_visual_weights;

/* Those of all scales with terms. */
typedef struct gscl_visual_scale_weights {
    gscl_visual_weights scale[GSCL_VISUAL_TERM_SCALES];
} gscl_visual_scale_weights;

/* ---- Rate-distortion optimisation of scalar codes ---- */

/* A splat's codes. */
typedef struct gscl_codes {
    int32_t code[GSCL_CODE_COUNT]; /* by GSCL_CODE_... */
} gscl_codes;

/* Meaning and cost of one code of the major axis. */
typedef struct gscl_major_entry {
    float step;               /* side of a cell of positions, pixels */
    int32_t cells_x, cells_y; /* of positions */
    float bits;               /* of the code and of a cell */
} gscl_major_entry;

/* Meaning and cost of one code of the aspect ratio. */
typedef struct gscl_aspect_entry {
    int32_t angles; /* number of angle codes */
    int32_t parts;  /* of a cell of positions, across the major axis */
    float bits;     /* of an angle and of a part */
} gscl_aspect_entry;

/* Meanings and costs of all codes. */
typedef struct gscl_rdo_tables {
    gscl_major_entry majors[GSCL_MAX_SCALE + 1];
    gscl_aspect_entry aspects[GSCL_MAX_SCALE + 1];
    float
        shape_bits[GSCL_MAX_SCALE + 1]
                  [GSCL_MAX_SCALE + 1]; /* of an aspect code and of parts of colour levels, by the major code and it */
    /* Of a direction, less those of an angle that is as likely as all others: by half the aspect code, and by the bin. */
    float direction_bits[GSCL_DIRECTION_ROWS][GSCL_DIRECTIONS];
    float bits[GSCL_BITS_COUNT];              /* by GSCL_BITS_... */
    int32_t fineness[2 * GSCL_MAX_SCALE + 1]; /* of luma and chroma, by the sum of the codes of the two axes */
} gscl_rdo_tables;

/* A splat that is changed in a pass. */
typedef struct gscl_rdo_task {
    int32_t splat;
    int32_t x0, x1, y0, y1; /* pixels that its outline may touch after the pass; no other of its group touches them */
} gscl_rdo_task;

/* Steps of the codes and the price of a bit. */
typedef struct gscl_rdo_settings {
    float lambda;     /* squared error per bit; as a kernel's argument, in units of the picture's error */
    float scale_step; /* of ln sigma */
    float luma_step, chroma_step, alpha_step; /* of a level */
    float amplitude_step;                     /* of a texture */
    float opacity_levels;
    int32_t visits;         /* of a splat, each of which may change its place or shape once */
    float move_slack;       /* bits: a move is evaluated if it is predicted to cost at most so much more than none */
    float elongation_price; /* see gscl_scalar_rdo_settings */
    float min_explained;    /* likewise */
    int32_t scan;           /* 1: all waves are tried for each splat; 0: only those near its own */
    int32_t min[4], max[4]; /* levels of luma, co, cg, alpha */
} gscl_rdo_settings;

/* The settings of a pass, and the tasks of one group. */
typedef struct gscl_rdo_pass {
    gscl_rdo_settings settings;
    gscl_view view;
    int32_t width, height;  /* of the level, pixels */
    int32_t start;          /* of the tasks of the group */
    float bits_per_splat;   /* bits that each splat costs besides its codes */
    float cost_of_dropping; /* 0 (no change of error, no bits), or more than any other where none may be dropped */
} gscl_rdo_pass;

/* ---- Codebooks ---- */

/* A step of Adam for the words of a codebook, or for the positions of the splats that use them. */
typedef struct gscl_word_step_settings {
    int32_t book;  /* GSCL_BOOK_... */
    int32_t words; /* of this book */
    int32_t splats;
    int32_t age;         /* steps since the optimiser's restart, this one included */
    float shape_rate;    /* learning rate of ln s1, ln s2 and theta of a word */
    float position_rate; /* learning rate of a position, in geometric means of the splat's axes */
} gscl_word_step_settings;

/* Rate-distortion optimisation of colour words and positions. */
typedef struct gscl_word_rdo_settings {
    gscl_view view;
    gscl_image_shape image;
    float lambda;           /* squared error per bit */
    float position_bits;    /* bits of a position, less the bits that the order of all splats saves */
    float cost_of_dropping; /* 0, or more than any other cost where no splat may be dropped */
    float cell_x, cell_y;   /* of the position grid, pixels */
    int32_t last_x, last_y; /* largest cells */
    int32_t colours;        /* words of the colour codebook */
} gscl_word_rdo_settings;

#endif
