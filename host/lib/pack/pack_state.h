/* The state of one call of gscl_pack.  Each stage of pack.c takes it and leaves its result in it. */
#ifndef GSCL_LIB_PACK_STATE_H
#define GSCL_LIB_PACK_STATE_H

#include "decode/coded_image.h"
#include "session/encoder.h"

/* Splats as parameters (GSCL_PARAMS floats each). */
typedef struct gscl_splat_list {
    float *params;
    size_t count;
} gscl_splat_list;

/* The splat that had to be changed most. */
typedef struct gscl_changed_splat {
    size_t number; /* in the field */
    double change; /* relative to what the format has */
    char what[96]; /* "sigma2 is 0.1 pixels; the format has 0.5 to 32768" */
} gscl_changed_splat;

typedef struct gscl_packing {
    /* Constant during the call. */
    gscl_context *context;
    const gscl_field *field;
    gscl_pack_settings settings;
    gscl_pack_report *report;          /* of the library's own size */
    gsf_bytes blocks[GSF_BLOCK_COUNT]; /* of the settings */

    /* Stage "prepare": the header, the background and the splats as the format can store them. */
    bool has_steps;        /* the field has steps, whose codes its splats are */
    double largest_weight; /* of the field, in the blend NORMALIZED; else 1 */
    gsf_header header;
    float background[4]; /* of the coded channels */
    gscl_splat_list stored;
    double log_longest_axis; /* of the stored splats, ln of pixels */
    double work;             /* what drawing them takes, evaluations of a splat at a pixel */
    uint32_t *layers;        /* of the stored splats; NULL: all are in the first one */
    gscl_changed_splat worst;

    /* Stage "draw". */
    gscl_image rendering; /* of the field, F32 with premultiplied colours; without pixels where nobody needs it */
    const gscl_image *reference; /* the caller's, or `rendering` */

    /* Stage "choose codes". */
    gscl_coded_image coded; /* the result */
} gscl_packing;

#endif
