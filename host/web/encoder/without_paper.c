/* In place of the room codebook: an encoder without the paper profile, which the module does not offer. */
#include "codebook/encode_codebook.h"

gscl_result gscl_encode_codebook(gscl_encoder *encoder, gscl_size_target target) {
    (void)target;
    return gscl_fail(encoder->context, GSCL_ERROR_INVALID_ARGUMENT, "this encoder has no paper profile");
}
