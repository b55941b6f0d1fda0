/* Rate-distortion optimisation of words and positions: the host side of cl/codebook_rdo.cl. */
#ifndef GSCL_LIB_CODEBOOK_RDO_H
#define GSCL_LIB_CODEBOOK_RDO_H

#include "cl/structs.h"
#include "codebook/codebook.h"

/* Arrays and buffers of the RDO passes.  They are made once for an encode, since the number of splats and words only
 * falls from pass to pass. */
typedef struct gscl_codebook_rdo {
    gscl_codebook *codebook;
    gscl_word_rdo_settings settings; /* of the current pass */
    float *shapes;                   /* shape words, rounded to values of the file */
    float *bits[GSCL_BOOKS];         /* of each word */
    int32_t (*cells)[2];             /* of the position grid, for each splat */
    int32_t (*boxes)[4];             /* first and last column, first and last row of pixels, for each splat */
    int *batch_of;                   /* the batch of each splat */
    int32_t *batch;                  /* the splats of one batch */
    int *next_batch;                 /* for each map cell: the first batch that no splat there is part of */
    int map_columns, map_rows;
    size_t *kept; /* the splats that the pass has kept */
    gscl_buffer device_bits[GSCL_BOOKS], device_cells, device_boxes, device_batch;
    gscl_buffer front, transmittance; /* of the splats in front of the current one: planes of channels, a plane */
} gscl_codebook_rdo;

/* Allocates everything for the codebook's splats.  `rdo` may hold anything before. */
gscl_result gscl_codebook_rdo_create(gscl_codebook_rdo *rdo, gscl_codebook *codebook);
/* Accepts an object that was zeroed and never created. */
void gscl_codebook_rdo_free(gscl_codebook_rdo *rdo);

/* A pass over all splats that chooses colour words and cells of the position grid by rate and distortion.  `lambda`:
 * squared error per bit; `keep_all`: no splat is dropped.  Splats must be in drawing order and projected. */
gscl_result gscl_codebook_rdo_run(gscl_codebook_rdo *rdo, double lambda, bool keep_all);

#endif
