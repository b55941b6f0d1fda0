#include "runtime/stages.h"

const char *gscl_stage_name(gscl_stage_id stage) {
    static const char *const names[GSCL_STAGE_COUNT] = {
        [GSCL_STAGE_NONE] = "",
        [GSCL_STAGE_PREPARE] = "prepare",
        [GSCL_STAGE_EFFECT_SEARCH] = "effect search",
        [GSCL_STAGE_PYRAMID] = "pyramid",
        [GSCL_STAGE_FIT_SMALLER] = "fit, smaller",
        [GSCL_STAGE_FIT_EIGHTH] = "fit, 1/8 size",
        [GSCL_STAGE_FIT_QUARTER] = "fit, 1/4 size",
        [GSCL_STAGE_FIT_HALF] = "fit, 1/2 size",
        [GSCL_STAGE_FIT_FULL] = "fit, full size",
        [GSCL_STAGE_FIT_CODEBOOKS] = "fit, straight-through",
        [GSCL_STAGE_DENSITY] = "density control",
        [GSCL_STAGE_QUANTISE] = "quantise",
        [GSCL_STAGE_RDO] = "rate-distortion passes",
        [GSCL_STAGE_REFIT] = "refit",
        [GSCL_STAGE_LEARN_WORDS] = "learn words",
        [GSCL_STAGE_ENTROPY_CODING] = "entropy coding",
        [GSCL_STAGE_WRITE] = "write",
        [GSCL_STAGE_ENTROPY_DECODING] = "entropy decoding",
        [GSCL_STAGE_DEQUANTISE] = "dequantise",
        [GSCL_STAGE_DRAW] = "draw",
        [GSCL_STAGE_MEASURE] = "measure",
        [GSCL_STAGE_TRACE] = "convergence trace",
    };
    return names[stage];
}
