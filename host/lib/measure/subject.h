/* What the measurements of exactness share: a file's splats beside the image that they show. */
#ifndef GSCL_LIB_SUBJECT_H
#define GSCL_LIB_SUBJECT_H

#include <gscl/measure.h>

#include "decode/coded_image.h"
#include "measure/reference.h"
#include "decode/renderer.h"

typedef struct gscl_subject {
    gscl_context *context;
    gscl_accuracy_settings settings; /* resolved */
    gscl_coded_image picture;
    gscl_kernel_options options;
    uint32_t width, height;
    size_t count; /* splats */
    float background[4];
    float *params; /* count * GSCL_PARAMS */
    float *target; /* planes of the image */
} gscl_subject;

/* Checks everything that the caller gave; NULL settings stand for the default. */
gscl_result gscl_subject_open(gscl_subject *subject, gscl_context *context, const gscl_image *image,
                              const uint8_t *bytes, size_t size, const gscl_accuracy_settings *settings);
/* Accepts a subject that was zeroed and never opened. */
void gscl_subject_close(gscl_subject *subject);

/* The blend's public name. */
gscl_blend gscl_subject_blend(const gscl_subject *subject);

/* What the public structs call GSCL_EXPONENTIAL_... */
const char *gscl_exponential_name(int exponential);

/* Makes `count` things, 0..count - 1, again and again, and gives the median of what the kernels of each took, in
 * seconds. They take turns, so that whatever else the machine does slows all of them down. */
typedef gscl_result gscl_subject_run(void *opaque, size_t which);
gscl_result gscl_subject_time(const gscl_subject *subject, gscl_subject_run *run, void *opaque, size_t count,
                              double *seconds);

/* Samples of a drawing: width * height * channels. */
size_t gscl_subject_samples(const gscl_subject *subject);
/* Errors of samples clamped to 0..1 against exact ones, in units of 1/255. */
void gscl_subject_compare(const gscl_subject *subject, const double *drawn, const double *exact,
                          gscl_accuracy *accuracy);

#endif
