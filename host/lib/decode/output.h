/* The image that a decode returns, and how it comes of what renderers draw.
 *
 * Renderers draw grey or RGB, with alpha or without, and repeat grey and add an alpha of 1 themselves.  What is left is
 * done on the host: drawing over a background and grey of colours, from floats so that samples are rounded once, and
 * the order of blue, green and red. */
#ifndef GSCL_LIB_OUTPUT_H
#define GSCL_LIB_OUTPUT_H

#include <gscl/gscl.h>

#include "decode/frame.h"

typedef struct gscl_output {
    gscl_image image;    /* what is returned; the caller of gscl_output_of sets its stride and pixels */
    gscl_image drawn;    /* what is drawn for it, without stride and pixels */
    bool is_mixed;       /* whether returned samples are computed of several drawn ones */
    float background[3]; /* colours like those that are drawn, for alpha that is not returned */
} gscl_output;

/* Whether the settings that choose samples, layout and background are in their ranges. */
bool gscl_output_is_possible(const gscl_decode_settings *s);

gscl_output gscl_output_of(const gscl_frame *f, const gscl_decode_settings *s, const gsf_header *header);

/* Where to draw some rows of the image: into these rows themselves, or packed into `scratch`, of drawn rows, which may
 * begin where they begin.  A mixed output needs it; others may do without, where scratch is NULL. */
gscl_image gscl_output_target(const gscl_output *o, const gscl_image *rows, void *scratch);
/* Completes rows of the image from what was drawn into their target. */
void gscl_output_finish(const gscl_output *o, const gscl_image *target, const gscl_image *rows);

#endif
