/* The pool of a search: the results of its starts, of which it combines parts. */
#ifndef GSCL_LIB_SEARCH_POOL_H
#define GSCL_LIB_SEARCH_POOL_H

#include "scalar/kept_codes.h"

#define GSCL_SEARCH_CELLS 16 /* cells into which each side of the image is cut */

/* A number for each cell, by row and column. */
typedef double gscl_search_cells[GSCL_SEARCH_CELLS][GSCL_SEARCH_CELLS];

typedef struct gscl_search_member {
    gscl_kept_codes codes;
    gscl_search_cells error;  /* squared, at the level of the search */
    gscl_search_cells weight; /* of a gain: lower where the cell has been taken */
} gscl_search_member;

/* Zeroed: empty. */
typedef struct gscl_search_pool {
    gscl_search_member *members;
    size_t count, capacity;
    gscl_kept_codes
        within;   /* of the lowest error within the budget in all rounds of a search; its count is 0 while there is
                               none */
    float *error; /* scratch, of each pixel of the level */
    size_t pixels;
} gscl_search_pool;

/* A rectangle of cells: from the first to before the last. */
typedef struct gscl_search_part {
    int x0, x1, y0, y1;
    double gain; /* sum over its cells */
} gscl_search_part;

/* Accepts a zeroed pool. */
void gscl_search_pool_free(gscl_search_pool *pool);
/* Copies state->coded, which has splats and this error, into a new member. */
gscl_result gscl_search_pool_add(gscl_search_pool *pool, gscl_scalar_state *state, double error);
/* Replaces the splats of state->coded in one rectangle by those of a member: where the errors under both differ most.
 * *is_combined: there is such a rectangle. */
gscl_result gscl_search_pool_combine(gscl_search_pool *pool, gscl_scalar_state *state, bool *is_combined);
/* The rectangle of the largest sum; with a gain of 0 and without cells where none is positive. */
gscl_search_part gscl_search_best_part(gscl_search_cells gain);

#endif
