/* The stages that encodes and decodes are timed by: one enum, one table of names. */
#ifndef GSCL_LIB_STAGES_H
#define GSCL_LIB_STAGES_H

typedef enum gscl_stage_id {
    GSCL_STAGE_NONE, /* no stage is running */
    GSCL_STAGE_PREPARE,
    GSCL_STAGE_EFFECT_SEARCH,
    GSCL_STAGE_PYRAMID,
    GSCL_STAGE_FIT_SMALLER, /* levels beyond 1/8 */
    GSCL_STAGE_FIT_EIGHTH,
    GSCL_STAGE_FIT_QUARTER,
    GSCL_STAGE_FIT_HALF,
    GSCL_STAGE_FIT_FULL,
    GSCL_STAGE_FIT_CODEBOOKS,
    GSCL_STAGE_DENSITY,
    GSCL_STAGE_QUANTISE,
    GSCL_STAGE_RDO,
    GSCL_STAGE_REFIT,
    GSCL_STAGE_LEARN_WORDS,
    GSCL_STAGE_ENTROPY_CODING,
    GSCL_STAGE_WRITE,
    GSCL_STAGE_ENTROPY_DECODING,
    GSCL_STAGE_DEQUANTISE,
    GSCL_STAGE_DRAW,
    GSCL_STAGE_MEASURE, /* benchmarks and measurements of accuracy */
    GSCL_STAGE_TRACE,   /* drawing a point of the convergence trace; not part of an encode's time */
    GSCL_STAGE_COUNT
} gscl_stage_id;

/* The public name of a stage; "" for NONE. */
const char *gscl_stage_name(gscl_stage_id stage);

#endif
