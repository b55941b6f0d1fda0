#include "encode/profile.h"

#include "codebook/encode_codebook.h"
#include "scalar/encode_scalar.h"
#include "session/encode_trace.h"

gscl_result gscl_encode_profile(gscl_encoder *e, size_t bytes, size_t splats) {
    gscl_trace_restart(e);
    return e->settings.profile == GSCL_PROFILE_PAPER ? gscl_encode_codebook(e, bytes, splats)
                                                     : gscl_encode_scalar(e, bytes, splats);
}
