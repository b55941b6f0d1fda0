/* The first stages of an encode: from the caller's image and settings to planes, a header and a size. */
#ifndef GSCL_LIB_PREPARE_H
#define GSCL_LIB_PREPARE_H

#include "session/encoder.h"

/* Examines the image and makes encoder->content, effects (as the settings say), header, source and max_splats. */
gscl_result gscl_encode_prepare(gscl_encoder *encoder, const gscl_image *image);

/* Sets encoder->target.  Refuses a budget below the smallest file of this image. */
gscl_result gscl_encode_resolve_target(gscl_encoder *encoder);

/* Replaces the tune AUTO of the settings by what it means for this image and target. */
void gscl_encode_resolve_tune(gscl_encoder *encoder);

/* Whether a file for this target that turns out to be nearly exact is compared with a smaller one that is searched. */
bool gscl_encode_may_search_smooth(const gscl_encoder *encoder, const gscl_image *image);
/* Whether the background alone is the result: the image is flat, or the target is no splats. */
bool gscl_encode_is_background_only(const gscl_encoder *encoder);

#endif
