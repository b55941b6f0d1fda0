/* Coding of all codes of a splat besides its class and position (FORMAT.md, "Attributes"). */
#ifndef GSCL_FORMAT_ATTRIBUTES_H
#define GSCL_FORMAT_ATTRIBUTES_H

#include "format/chroma.h"
#include "format/coder.h"
#include "format/model.h"
#include "format/types.h"

typedef struct gsf_attributes {
    gsf_header header;
    gsf_steps steps;
    int luma_min, alpha_min;
    gsf_model aspect, direction, luma, alpha, opacity;
    gsf_model textured, amplitude, wave, wave_direction;
    gsf_chroma chroma;
} gsf_attributes;

void gsf_attributes_init(gsf_attributes *attributes, const gsf_header *header, const gsf_steps *steps);

/* Codes one splat.  Splats must come in stored order, with minor, x and y in place.  Fields whose effect is off are not
 * changed. */
void gsf_code_attributes(gsf_coder *coder, gsf_attributes *attributes, gsf_splat *splat);

#endif
