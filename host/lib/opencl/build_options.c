#include "opencl/build_options.h"

#include "cl/constants.h"
#include "opencl/opencl_device.h"
#include "runtime/elementary.h"
#include "runtime/mapping.h"
#include "runtime/text.h"

/* Appends the options that only the room `measure` sets.  Constants of the double kernels are doubles. */
static void append_measured_precision(gscl_text *text, const gscl_kernel_options *options) {
    const char *suffix = options->is_double ? "" : "f";
    const double support = options->support > 0 ? options->support : (double)GSCL_SUPPORT;
    if (options->support > 0 || options->is_double)
        gscl_text_append(text, " -DGSCL_SUPPORT=%.17e%s -DGSCL_WEIGHT_FLOOR=%.17e%s", support, suffix,
                         gscl_exp(-support), suffix);
    if (options->is_double)
        gscl_text_append(text, " -DDOUBLE -DGSCL_MAX_ALPHA=0.999");
    if (options->exponential)
        gscl_text_append(text, " -DEXPONENTIAL=%d", options->exponential);
    if (options->early_stop > 0)
        gscl_text_append(text, " -DEARLY_STOP=%.9ef", options->early_stop);
}

/* Which options change the kernels of a program. */
typedef struct program_traits {
    bool has_channels; /* pixel vectors, and the channels of an image */
    bool has_splats;   /* what splats may have */
    bool has_blend, has_weights, has_loss;
    bool has_precision; /* the options that only the room `measure` sets */
} program_traits;

static const program_traits traits_of_kinds[GSCL_PROGRAM_KINDS] = {
    [GSCL_PROGRAM_RENDER] = {.has_channels = true, .has_splats = true, .has_blend = true, .has_precision = true},
    [GSCL_PROGRAM_FIT] = {true, true, true, true, true, true},
    [GSCL_PROGRAM_GRADIENTS] = {true, true, true, true, true, true},
    [GSCL_PROGRAM_SCALAR_RDO] = {true, true, true, true, false, true},
    [GSCL_PROGRAM_CODEBOOK] = {true, true, true, true, true, true},
    [GSCL_PROGRAM_SSIM] = {.has_channels = true},
    [GSCL_PROGRAM_VISUAL] = {.has_channels = true},
    [GSCL_PROGRAM_BENCHMARK] = {.has_channels = true},
    [GSCL_PROGRAM_ACCURACY] = {.has_channels = true, .has_splats = true, .has_blend = true, .has_precision = true},
};

/* Appends how the context's mapping distributes the work of these kernels. */
static void append_mapping(gscl_text *text, const gscl_context *context, gscl_program_kind kind) {
    const program_traits *traits = &traits_of_kinds[kind];
    const bool has_chunks = kind == GSCL_PROGRAM_SSIM || kind == GSCL_PROGRAM_VISUAL;
    if (traits->has_channels)
        gscl_text_append(text, " -DLANES=%d -DROWS=%d",
                         has_chunks ? gscl_chunk_lanes(context) : gscl_mapping_lanes(context),
                         gscl_mapping_rows(context));
    if (traits->has_splats)
        gscl_text_append(text, " -DSPLAT_LANES=%d", gscl_splat_lanes(context, kind));
    if (kind == GSCL_PROGRAM_BIN)
        gscl_text_append(text, " -DBAND_ITEMS=%zu -DBIN_ITEMS=%zu -DLINK_SPLATS=%zu", gscl_band_group_size(context),
                         gscl_bin_group_size(context), gscl_link_splats(context));
    if (has_chunks)
        gscl_text_append(text, " -DCHUNK_ITEMS=%zu", gscl_chunk_group_size(context));
    if (kind == GSCL_PROGRAM_VISUAL || kind == GSCL_PROGRAM_IMAGE)
        gscl_text_append(text, " -DSUM_ITEMS=%zu", gscl_sum_group_size(context));
    if (traits->has_loss)
        gscl_text_append(text, " -DCACHED_ROWS=%d -DSLOT_ITEMS=%zu", gscl_mapping_cached_rows(context),
                         gscl_slot_group_size(context));
    if (kind == GSCL_PROGRAM_SCALAR_RDO || kind == GSCL_PROGRAM_CODEBOOK)
        gscl_text_append(text, " -DRDO_ITEMS=%zu", gscl_rdo_group_size(context));
    if (gscl_opencl(context)->quirks->software_fma)
        gscl_text_append(text, " -DSOFTWARE_FMA");
}

static void append_specialisation(gscl_text *text, const program_traits *traits, const gscl_kernel_options *options) {
    if (traits->has_channels)
        gscl_text_append(text, " -DCOLOURS=%d -DALPHA_CHANNEL=%d", options->colours, options->alpha_channel);
    if (traits->has_splats)
        gscl_text_append(text, " -DOPACITY=%d -DTEXTURE=%d -DSHAPE=%d", options->opacity, options->texture,
                         options->shape);
    if (traits->has_blend)
        gscl_text_append(text, " -DBLEND=%d", options->blend);
    if (traits->has_weights)
        gscl_text_append(text, " -DWEIGHTED=%d", options->weighted);
    if (traits->has_loss)
        gscl_text_append(text, " -DLOSS=%d", options->loss);
    if (traits->has_precision)
        append_measured_precision(text, options);
}

gscl_result gscl_build_options(gscl_context *context, gscl_program_kind kind, const gscl_kernel_options *options,
                               char bytes[GSCL_MAX_BUILD_OPTIONS]) {
    gscl_text text = gscl_text_begin(bytes, GSCL_MAX_BUILD_OPTIONS);
    gscl_text_append(&text, "-cl-std=CL1.2");
    append_mapping(&text, context, kind);
    append_specialisation(&text, &traits_of_kinds[kind], options);
    return text.overflow ? gscl_fail(context, GSCL_ERROR_KERNEL_BUILD,
                                     "the build options of a program take more than %d bytes: %s ...",
                                     GSCL_MAX_BUILD_OPTIONS - 1, bytes)
                         : GSCL_OK;
}
