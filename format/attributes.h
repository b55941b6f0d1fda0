/* Coding of all codes of a splat besides its class and position (FORMAT.md, "Attributes"). */
#ifndef GSCL_FORMAT_ATTRIBUTES_H
#define GSCL_FORMAT_ATTRIBUTES_H

#include "format/chroma.h"
#include "format/coder.h"
#include "format/conditional.h"
#include "format/model.h"
#include "format/types.h"

typedef struct gsf_attributes {
    gsf_header header;
    gsf_steps steps;
    unsigned typical_size;                   /* gsf_typical_size */
    uint16_t angles[GSF_MAX_SCALE_CODE + 1]; /* gsf_angle_count, by the aspect */
    uint32_t parts[GSF_MAX_SCALE_CODE + 1];  /* gsf_position_parts, by the aspect */
    uint32_t parts_x, parts_y;               /* of the current splat's cell, as in gsf_splat_grid */
    unsigned fineness;                       /* of the current splat's luma and chroma, gsf_colour_fineness */
    int luma_min, alpha_min;
    gsf_model luma, alpha, opacity, wave_direction;
    gsf_conditional aspect, direction, textured, amplitude, wave;
    gsf_chroma chroma;
} gsf_attributes;

/* The conditional model of the aspect. */
extern const gsf_conditional_shape gsf_aspect_shape;
/* Its row for a major code; `typical` is gsf_typical_size. */
uint32_t gsf_aspect_row(unsigned major, unsigned typical);

/* The conditional model of the direction, its row for an aspect, and its symbol for an angle code of `count`. */
extern const gsf_conditional_shape gsf_direction_shape;
uint32_t gsf_direction_row(unsigned aspect);
uint32_t gsf_direction_of(uint32_t code, uint32_t count);

void gsf_attributes_init(gsf_attributes *attributes, const gsf_header *header, const gsf_steps *steps);

/* Codes one splat.  Splats must come in stored order, with major axis and cell of the class in place.  Fields whose
 * effect is off are not changed. */
void gsf_code_attributes(gsf_coder *coder, gsf_attributes *attributes, gsf_splat *splat);

#endif
