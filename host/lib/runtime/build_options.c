#include "runtime/build_options.h"

#include <math.h>

#include "cl/constants.h"
#include "runtime/mapping.h"
#include "runtime/quirks.h"
#include "runtime/text.h"

/* Appends the options that only the room `measure` sets.  Constants of the double kernels are doubles. */
static void append_measured_precision(gscl_text *text, const gscl_kernel_options *options) {
    const char *suffix = options->is_double ? "" : "f";
    const double support = options->support > 0 ? options->support : (double)GSCL_SUPPORT;
    if (options->support > 0 || options->is_double)
        gscl_text_append(text, " -DGSCL_SUPPORT=%.17e%s -DGSCL_WEIGHT_FLOOR=%.17e%s", support, suffix, exp(-support),
                         suffix);
    if (options->is_double)
        gscl_text_append(text, " -DDOUBLE -DGSCL_MAX_ALPHA=0.999");
    if (options->exponential)
        gscl_text_append(text, " -DEXPONENTIAL=%d", options->exponential);
    if (options->early_stop > 0)
        gscl_text_append(text, " -DEARLY_STOP=%.9ef", options->early_stop);
}

static void append_specialisation(gscl_text *text, const gscl_context *context, gscl_program_kind kind,
                                  const gscl_kernel_options *options) {
    const bool fits = kind == GSCL_PROGRAM_FIT || kind == GSCL_PROGRAM_CODEBOOK;
    gscl_text_append(text, " -DLANES=%d -DROWS=%d -DSPLAT_LANES=%d", gscl_mapping_lanes(context),
                     gscl_mapping_rows(context), gscl_splat_lanes(context, kind));
    gscl_text_append(text, " -DBLEND=%d -DCOLOURS=%d -DALPHA_CHANNEL=%d -DOPACITY=%d -DTEXTURE=%d -DSHAPE=%d",
                     options->blend, options->colours, options->alpha_channel, options->opacity, options->texture,
                     options->shape);
    if (fits || kind == GSCL_PROGRAM_SCALAR_RDO)
        gscl_text_append(text, " -DWEIGHTED=%d", options->weighted);
    if (fits)
        gscl_text_append(text, " -DLOSS=%d -DCACHED_ROWS=%d", options->loss, gscl_mapping_cached_rows(context));
    if (context->quirks->one_blend)
        gscl_text_append(text, " -DONE_BLEND");
    append_measured_precision(text, options);
}

gscl_result gscl_build_options(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                               char bytes[GSCL_MAX_BUILD_OPTIONS]) {
    gscl_text text = gscl_text_begin(bytes, GSCL_MAX_BUILD_OPTIONS);
    gscl_text_append(&text, "-cl-std=CL1.2");
    if (kind != GSCL_PROGRAM_IMAGE)
        append_specialisation(&text, context, kind, options);
    return text.overflow ? gscl_fail(context, GSCL_ERROR_KERNEL_BUILD,
                                     "the build options of a program take more than %d bytes: %s ...",
                                     GSCL_MAX_BUILD_OPTIONS - 1, bytes)
                         : GSCL_OK;
}
