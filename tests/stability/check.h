/* What every scene must stand: forward and backward against the oracle, descent, a file that decodes, the same bits twice;
 * in both mappings. */
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

/* The CPU and the GPU mapping. */
gscl_context *stability_context(int mapping);
extern const char *const stability_mappings[2], *const stability_blends[3];
int stability_open(void **state);
int stability_close(void **state);

/* All of it as one test (of splats that kernels do not turn only scene_agrees); writes what it measured into the file that
 * STABILITY_REPORT names. */
void check_scene(const scene *s);
/* Forward, backward and finite alone; tells in `message` what is wrong, else returns true. */
bool scene_agrees(const scene *s, scene_errors errors[2], char *message, size_t room);
/* Descent from the scene, with a file of it before and after. */
bool scene_encodes(const scene *s, char *message, size_t room);
/* A file of the scene as it is. */
bool scene_file_decodes(const scene *s, char *message, size_t room);

#endif
