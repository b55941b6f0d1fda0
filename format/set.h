/* Coding of splats as a set (FORMAT.md, "Set coding"): the number of each class, and their positions, without bits for
 * an order. */
#ifndef GSCL_FORMAT_SET_H
#define GSCL_FORMAT_SET_H

#include "format/coder.h"
#include "format/count_split.h"

/* The cells of the splats of one class.  Cell (i, j) has its centre at
 * ((2 i + 1) pitch_x, (2 j + 1) pitch_y), in a unit of length common to all classes. */
typedef struct gsf_grid {
    uint32_t cells_x, cells_y;
    uint32_t pitch_x, pitch_y;
} gsf_grid;

typedef struct gsf_rect {
    uint32_t x, y, width, height; /* cells */
} gsf_rect;

typedef struct gsf_split {
    bool along_x;    /* the halves lie side by side, else one above the other */
    uint32_t length; /* cells of the side that is cut */
    uint32_t first;  /* cells of that side in the first half */
    uint32_t at;     /* first cell column (row) of the second half */
} gsf_split;

/* Cuts a rectangle of more than one cell across its longer side. */
gsf_split gsf_split_rect(const gsf_grid *grid, gsf_rect rect);
gsf_rect gsf_half(gsf_rect rect, const gsf_split *split, bool second);

typedef struct gsf_point {
    uint32_t x, y; /* cell */
} gsf_point;

/* A splat of a class that is already coded.  Splats of the next classes are likely to be near it. */
typedef struct gsf_prior {
    uint32_t x, y; /* centre in the grids' common unit */
} gsf_prior;

#define GSF_MAX_PRIORS 4096u /* bounds the work */

#define GSF_MAX_NARROW 128u /* cells: a rectangle that is longer is wide */
#define GSF_NARROW_SPLITS (GSF_IS_SMALL ? 1 : GSF_MAX_NARROW + 1)

/* Splats that are coded class by class. */
typedef struct gsf_set {
    gsf_point *points;                          /* of all classes in turn */
    const uint32_t *counts;                     /* of each class */
    const gsf_grid *grids;                      /* of each class */
    gsf_prior *priors;                          /* memory for as many as there are points, at most GSF_MAX_PRIORS */
    gsf_single_split narrow[GSF_NARROW_SPLITS]; /* splits of one point, by the length of the side that is cut */
} gsf_set;

/* The sum of counts[0..n). */
uint32_t gsf_sum(const uint32_t *counts, uint32_t n);

/* Codes counts[0..classes), which add up to n > 0; 1 <= classes <= 1024. */
void gsf_code_class_counts(gsf_coder *coder, uint32_t *counts, uint32_t classes, uint32_t n);

/* Sets up the lists, which stay the caller's. */
void gsf_set_init(gsf_set *set, gsf_point *points, const uint32_t *counts, const gsf_grid *grids, gsf_prior *priors);
/* Codes the cells of the points of one class, which begin at points[first].  They are in the traversal order of the
 * splits.  The points and counts of the classes before must be in place, and the class's own count and grid. */
void gsf_code_class_points(gsf_coder *coder, const gsf_set *set, uint32_t class_no, uint32_t first);

#endif
