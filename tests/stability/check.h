/* The checks of every scene, in each mapping that the device has (both_mappings.h): forward and backward results against the oracle, descent, a file that
 * decodes, and identical bits in a second run. */
#ifndef STABILITY_CHECK_H
#define STABILITY_CHECK_H

#include <gscl/gscl.h>

#include "scene.h"

/* The largest errors of a scene in one mapping.  Forward: of a sample, in 1/255.  Backward: |g - g'| n over the largest
 * |g'| n of the scene, where g' is the oracle's gradient and n the parameter's natural step (fit_oracle.h). */
typedef struct {
    double forward, forward_bound;
    double backward, backward_bound;
    double share; /* of its own bound, the largest of any sample or gradient */
} scene_errors;

#define STABILITY_MAPPINGS 2 /* at most */

/* The contexts of mappings, and what reports call them. */
int stability_mapping_count(void);
gscl_context *stability_context(int mapping);
const char *stability_mapping_name(int mapping);
/* All contexts that decode; their number. */
int stability_decoders(gscl_context *const **decoders);
extern const char *const stability_blends[3];
int stability_open(void **state);
int stability_close(void **state);

/* All checks as one test; for axis-aligned and isotropic kernels only scene_agrees.  Writes the measured values into
 * the file that STABILITY_REPORT names. */
void check_scene(const scene *s);
/* Checks forward and backward results.  Returns false with the fault in `message`, or true. */
bool scene_agrees(const scene *s, scene_errors errors[STABILITY_MAPPINGS], char *message, size_t capacity);
/* Checks descent from the scene, and a file of its splats before and after. */
bool scene_encodes(const scene *s, char *message, size_t capacity);
/* Checks a file of the scene without fitting. */
bool scene_file_decodes(const scene *s, char *message, size_t capacity);

#endif
