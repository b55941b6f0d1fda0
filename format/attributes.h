/* Coding of all codes of a splat besides its class and position (FORMAT.md, "Attributes"). */
#ifndef GSCL_FORMAT_ATTRIBUTES_H
#define GSCL_FORMAT_ATTRIBUTES_H

#include "format/chroma.h"
#include "format/coder.h"
#include "format/conditional.h"
#include "format/model.h"
#include "format/types.h"

#define GSF_MAX_LUMA_CODES 573 /* -286..286, with fineness 1 */
#define GSF_MAX_OPACITIES 16

/* Not copied after gsf_attributes_init: the models point to the frequencies. */
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
    uint16_t luma_freq[GSF_MAX_LUMA_CODES], alpha_freq[GSF_MAX_LUMA_CODES];
    uint16_t opacity_freq[GSF_MAX_OPACITIES], direction_freq[GSF_DIRECTIONS];
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
