/* The paper profile: Zhang et al., "2D Gaussian Splatting for Image Compression".
 *
 * A free fit under alpha blending with density control (P1-P4, P7), K-means codebooks learnt with the
 * straight-through estimator (P5), then rounds in which words are chosen by rate and distortion and learnt, and b-bit
 * quantisation (P8).  Entropy coding (P9) is the format's. */
#include "codebook/encode_codebook.h"

#include "codebook/codebook_fit.h"
#include "codebook/codebook_plan.h"
#include "codebook/codebook_rounds.h"
#include "codebook/codebook_state.h"
#include "codebook/tunables.h"

static gscl_result run_stages(gscl_codebook_state *s) {
    GSCL_TRY(gscl_codebook_fit_freely(s));
    GSCL_TRY(gscl_codebook_fit_straight_through(s));
    GSCL_TRY(gscl_codebook_run_rounds(s));
    return gscl_codebook_meet_budget(s);
}

gscl_result gscl_encode_codebook(gscl_encoder *encoder, gscl_size_target target) {
    gscl_codebook_state state = {.encoder = encoder,
                                 .plan = gscl_codebook_plan_make(encoder, target.bytes, target.splats),
                                 .lambda_scale = gscl_codebook_tunables.lambda_scale};
    const gscl_result result = run_stages(&state);
    gscl_codebook_rdo_free(&state.rdo);
    gscl_codebook_free(&state.codebook);
    gscl_fit_free(&state.fit);
    return result;
}
