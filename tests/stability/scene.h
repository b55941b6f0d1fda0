/* A scene of the suite: the image to fit, and splats as float parameters that may lie outside the library's own
 * clamps.  Kernels and the double-precision oracle use the same floats. */
#ifndef STABILITY_SCENE_H
#define STABILITY_SCENE_H

#include <stdbool.h>
#include <stddef.h>

#include "cl/constants.h"

#define SCENE_SPLATS 10000 /* maximum */
#define SCENE_PIXELS 65536 /* maximum */
#define SCENE_CHANNELS 3
#define SCENE_STEPS 40 /* of Adam, in which the loss must fall */

typedef struct {
    char name[80];
    int blend;
    int width, height, level; /* size of the full image; level of the pyramid */
    bool isotropic;           /* all splats are isotropic: the gradient of their angle must be exactly 0 */
    int shape;                /* GSCL_SHAPE_...: of the kernels */
    size_t count;
    size_t stride; /* the gradient is compared for every `stride`th splat */
    float params[SCENE_SPLATS * GSCL_PARAMS];
    float target[SCENE_PIXELS * SCENE_CHANNELS]; /* of the level */
} scene;

/* A hard case: changes an ordinary scene (blend set, 40x33 pixels of noise, no splats). */
typedef struct {
    const char *name;
    void (*make)(scene *s);
} scene_case;

/* The cases of each subject; the last has a NULL name. */
extern const scene_case shape_cases[], blending_cases[], place_cases[], image_cases[];

/* An ordinary scene without splats. */
void scene_begin(scene *s, const char *name, int blend);
/* Adds a splat at a random position in the image, with axes of 0.7 to 15 pixels and random angle, opacity and colour. */
float *scene_add(scene *s);
void scene_set_axes(float *params, double s1, double s2);
/* Sets all angles to 0, and for GSCL_SHAPE_ISOTROPIC all second axes to the first. */
void scene_set_shape(scene *s, int shape);
/* Sets another size, with noise as the target. */
void scene_resize(scene *s, int width, int height);
int scene_level_width(const scene *s);
int scene_level_height(const scene *s);
/* A random number whose logarithm is uniform. */
double scene_log_uniform(double low, double high);
/* Returns `count`, or `few` when STABILITY_SMALL is set. */
size_t scene_scaled(size_t count, size_t few);

#endif
