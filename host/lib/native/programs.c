#include "native/programs.h"

#include <string.h>

bool gscl_native_general;

gscl_native_options gscl_native_options_of(const gscl_kernel_options *o) {
    return (gscl_native_options){o->blend, o->opacity, o->texture, o->shape, o->loss, o->weighted};
}

bool gscl_native_options_equal(const gscl_native_options *a, const gscl_native_options *b) {
    return memcmp(a, b, sizeof *a) == 0; /* nothing but int */
}

static bool serves(const gscl_native_program *program, gscl_program_kind kind, const gscl_kernel_options *options) {
    const gscl_native_options wanted = gscl_native_options_of(options);
    if (program->kind != kind || (program->is_specialised && gscl_native_general))
        return false;
    if (program->colours && (program->colours != options->colours || program->alpha_channel != options->alpha_channel))
        return false;
    return !program->is_specialised || gscl_native_options_equal(&program->options, &wanted);
}

const gscl_native_kernel *gscl_native_find(const gscl_native_processor *processor, gscl_program_kind kind,
                                           const gscl_kernel_options *options, const char *name) {
    size_t i = 0;
    while (i < processor->program_count && !serves(&processor->programs[i], kind, options))
        i++;
    if (i == processor->program_count)
        return NULL;
    const gscl_native_kernel *kernel = processor->programs[i].kernels;
    while (kernel->name && strcmp(kernel->name, name) != 0)
        kernel++;
    return kernel->name ? kernel : NULL;
}
