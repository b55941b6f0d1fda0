/* The kernels that were compiled with the library, for each processor: the table that cl/native.py writes. */
#ifndef GSCL_LIB_NATIVE_PROGRAMS_H
#define GSCL_LIB_NATIVE_PROGRAMS_H

#include <stdbool.h>
#include <stddef.h>

#include "runtime/kernel_options.h"

#define GSCL_NATIVE_MAX_KERNELS 24 /* of a program */

/* The options that general programs read (cl/options.h), laid out as in cl/native.h. */
typedef struct gscl_native_options {
    int blend, opacity, texture, shape, loss, weighted;
} gscl_native_options;

/* Runs the work-items from `first` to before `end` of a kernel.  arguments[i]: the address of argument i. */
typedef void gscl_native_function(const void *const *arguments, size_t first, size_t end);

typedef struct gscl_native_kernel {
    const char *name; /* of the function in cl/; NULL behind the last kernel of a program */
    gscl_native_function *function;
    size_t argument_count;
} gscl_native_kernel;

typedef struct gscl_native_program {
    gscl_program_kind kind;
    int colours, alpha_channel; /* 0, 0: kernels that do not depend on channels */
    bool is_specialised;        /* serves the one set of options; else all */
    gscl_native_options options;
    gscl_native_kernel kernels[GSCL_NATIVE_MAX_KERNELS];
} gscl_native_program;

/* The programs for one kind of processor. */
typedef struct gscl_native_processor {
    const char *name; /* such as "x86_64_v3" */
    size_t program_count;
    const gscl_native_program *programs;
} gscl_native_processor;

/* All that this library has, those of more demands on the processor first. */
extern const gscl_native_processor gscl_native_processors[];
extern const size_t gscl_native_processor_count;

/* The kernel of the program that serves these options, the specialised one where there is one; NULL where there is none. */
const gscl_native_kernel *gscl_native_find(const gscl_native_processor *processor, gscl_program_kind kind,
                                           const gscl_kernel_options *options, const char *name);

/* For tests: whether gscl_native_find takes general programs alone, which compute the same as specialised ones. */
extern bool gscl_native_general;

gscl_native_options gscl_native_options_of(const gscl_kernel_options *options);
bool gscl_native_options_equal(const gscl_native_options *a, const gscl_native_options *b);

#endif
