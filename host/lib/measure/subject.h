/* A file's splats and the image that they represent, which the measurements of accuracy share. */
#ifndef GSCL_LIB_SUBJECT_H
#define GSCL_LIB_SUBJECT_H

#include <gscl/measure.h>

#include "decode/coded_image.h"
#include "decode/renderer.h"
#include "measure/reference.h"

typedef struct gscl_subject {
    gscl_context *context;
    gscl_accuracy_settings settings; /* resolved */
    gscl_coded_image coded;
    gscl_kernel_options options;
    uint32_t width, height;
    size_t count; /* splats */
    float background[4];
    float *params; /* count * GSCL_PARAMS */
    float *target; /* planes of the image */
} gscl_subject;

/* Checks all arguments of the caller and reads the file.  NULL settings are the default. */
gscl_result gscl_subject_open(gscl_subject *subject, gscl_context *context, const gscl_image *image,
                              const uint8_t *bytes, size_t size, const gscl_accuracy_settings *settings);
/* Accepts a subject that was zeroed and never opened. */
void gscl_subject_close(gscl_subject *subject);

/* The blend's public name. */
gscl_blend gscl_subject_blend(const gscl_subject *subject);

/* The public name of GSCL_EXPONENTIAL_... */
const char *gscl_exponential_name(int exponential);

typedef gscl_result gscl_subject_run(void *opaque, size_t which);
/* Runs `run` repeatedly for each `which` < count and writes the median times of its kernels, in seconds.  The runs take
 * turns, so that other load on the machine slows all of them down alike. */
gscl_result gscl_subject_time(const gscl_subject *subject, gscl_subject_run *run, void *opaque, size_t count,
                              double *seconds);

/* Samples of a rendering: width * height * channels. */
size_t gscl_subject_samples(const gscl_subject *subject);
/* Sets the errors of a rendering against an exact one, of samples clamped to 0..1 and in units of 1/255, and its PSNR
 * against the image. */
void gscl_subject_compare(const gscl_subject *subject, const double *rendering, const double *exact,
                          gscl_accuracy *accuracy);

#endif
