/* Prints the OpenCL programs that the library can ask for, each in a line of fields that tabs separate:
 *
 *     MAPPING SET KIND USE FILES OPTIONS
 *
 * MAPPING: cpu, gpu, or rusticl, the GPU mapping as the quirks of Mesa's rusticl change it (opencl/quirks.c).
 * SET: `encode` for programs of an encode with the default settings and of a decode of its file, `extreme` for those
 * with most and with least of what options add, `other` for those that differ from an ordinary encode, or from the
 * paper profile, by one option.
 * USE: what asks for the program, in words; the first of several uses.
 * FILES: the names of its files in cl/, with a space between.
 * OPTIONS: those of the compiler. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "opencl/build_options.h"
#include "opencl/kernel_sources.h"
#include "opencl/opencl_device.h"

#define MAX_PROGRAMS 256

/* Programs of one mapping that were printed. */
typedef struct program_list {
    gscl_context context;
    const char *mapping;
    size_t count;
    struct {
        gscl_program_kind kind;
        char options[GSCL_MAX_BUILD_OPTIONS];
    } programs[MAX_PROGRAMS];
} program_list;

static const char *const kind_names[GSCL_PROGRAM_KINDS] = {
    [GSCL_PROGRAM_RENDER] = "render",       [GSCL_PROGRAM_BIN] = "bin",           [GSCL_PROGRAM_FIT] = "fit",
    [GSCL_PROGRAM_GRADIENTS] = "gradients", [GSCL_PROGRAM_SCALAR_RDO] = "rdo",    [GSCL_PROGRAM_CODEBOOK] = "codebook",
    [GSCL_PROGRAM_SSIM] = "ssim",           [GSCL_PROGRAM_VISUAL] = "visual",     [GSCL_PROGRAM_IMAGE] = "image",
    [GSCL_PROGRAM_BENCHMARK] = "benchmark", [GSCL_PROGRAM_ACCURACY] = "accuracy",
};

/* What an encode with the default settings asks for: the visual loss weights luma, too. */
static const gscl_kernel_options encode = {.blend = GSCL_NORMALIZED,
                                           .colours = 3,
                                           .shape = GSCL_SHAPE_ROTATED,
                                           .weighted = GSCL_WEIGHTED_LUMA};
/* What the paper profile asks for: its loss is L1 with SSIM. */
static const gscl_kernel_options paper = {.blend = GSCL_ALPHA,
                                          .colours = 3,
                                          .opacity = 1,
                                          .shape = GSCL_SHAPE_ROTATED,
                                          .loss = GSCL_LOSS_KIND_EXTERNAL};

static bool is_measured(const gscl_kernel_options *o) {
    return o->support > 0 || o->exponential || o->early_stop > 0 || o->is_double;
}

/* Whether measuring asks for a program with options that only the room `measure` sets: measure/accuracy.c and
 * measure/accuracy_gradient.c. */
static bool is_measurable(gscl_program_kind kind, const gscl_kernel_options *o) {
    if (kind == GSCL_PROGRAM_ACCURACY)
        return o->is_double && o->shape == GSCL_SHAPE_ROTATED; /* project_double makes no other splats */
    if (kind == GSCL_PROGRAM_RENDER)
        return !o->is_double && (o->early_stop == 0 || o->blend == GSCL_ALPHA);
    if (kind == GSCL_PROGRAM_FIT || kind == GSCL_PROGRAM_GRADIENTS)
        return !o->is_double && o->support == 0 && o->early_stop == 0 && o->loss == GSCL_LOSS_KIND_L2 &&
               o->weighted == GSCL_WEIGHTED_NOT;
    return false;
}

/* Whether anything asks for a program of this kind with these options. */
static bool is_asked_for(gscl_program_kind kind, const gscl_kernel_options *o) {
    if (o->weighted != GSCL_WEIGHTED_NOT && o->loss != GSCL_LOSS_KIND_L2)
        return false; /* encode/settings.c */
    if (kind == GSCL_PROGRAM_ACCURACY || is_measured(o))
        return is_measurable(kind, o);
    if (kind == GSCL_PROGRAM_SCALAR_RDO)
        return o->blend != GSCL_ALPHA; /* scalar/scalar_state.c: has_choice */
    if (kind == GSCL_PROGRAM_BENCHMARK)
        return o->colours == 1 && !o->alpha_channel; /* measure/benchmark.c */
    if (kind == GSCL_PROGRAM_CODEBOOK)
        return o->blend == GSCL_ALPHA && !o->texture &&
               o->weighted == GSCL_WEIGHTED_NOT; /* encode/settings.c, format/header.c */
    return true;
}

/* Whether the program is new to the list, to which it is then added. */
static bool add(program_list *list, gscl_program_kind kind, const char *options) {
    for (size_t i = 0; i < list->count; i++)
        if (list->programs[i].kind == kind && strcmp(list->programs[i].options, options) == 0)
            return false;
    if (list->count == MAX_PROGRAMS) {
        fprintf(stderr, "list_programs: more than %d programs\n", MAX_PROGRAMS);
        exit(1);
    }
    list->programs[list->count].kind = kind;
    snprintf(list->programs[list->count++].options, GSCL_MAX_BUILD_OPTIONS, "%s", options);
    return true;
}

/* Prints a program that is asked for and new to the list. */
static void print_program(program_list *list, const char *set, gscl_program_kind kind, const char *use,
                          const gscl_kernel_options *kernel_options) {
    char options[GSCL_MAX_BUILD_OPTIONS];
    if (!is_asked_for(kind, kernel_options))
        return;
    if (gscl_build_options(&list->context, kind, kernel_options, options) != GSCL_OK) {
        fprintf(stderr, "list_programs: %s\n", list->context.message);
        exit(1);
    }
    if (!add(list, kind, options))
        return;
    printf("%s\t%s\t%s\t%s\t", list->mapping, set, kind_names[kind], use);
    for (const char *const *file = gscl_program_files[kind]; *file; file++)
        printf("%s%s", *file, file[1] ? " " : "\t");
    printf("%s\n", options);
}

/* Prints the programs of all kinds that are asked for with these options. */
static void print_programs(program_list *list, const char *set, const char *use, gscl_kernel_options options) {
    for (int kind = 0; kind < GSCL_PROGRAM_KINDS; kind++)
        print_program(list, set, (gscl_program_kind)kind, use, &options);
}

/* Splats have no waves until a pass adds them. */
static void print_encode(program_list *list) {
    static const gscl_program_kind kinds[] = {GSCL_PROGRAM_RENDER,     GSCL_PROGRAM_BIN,    GSCL_PROGRAM_FIT,
                                              GSCL_PROGRAM_SCALAR_RDO, GSCL_PROGRAM_VISUAL, GSCL_PROGRAM_IMAGE};
    gscl_kernel_options textured = encode;
    textured.texture = 1;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        print_program(list, "encode", kinds[i], "encode", &encode);
        print_program(list, "encode", kinds[i], "encode, waves", &textured);
    }
}

static void print_extremes(program_list *list) {
    gscl_kernel_options most = encode, blended = paper, least = encode, precise = paper;
    most.alpha_channel = most.opacity = most.texture = 1;
    blended.alpha_channel = 1;
    least.colours = 1;
    least.shape = GSCL_SHAPE_ISOTROPIC;
    least.weighted = GSCL_WEIGHTED_NOT;
    precise.alpha_channel = precise.texture = precise.is_double = 1;
    print_programs(list, "extreme", "all options", most);
    print_programs(list, "extreme", "paper, RGBA", blended);
    print_programs(list, "extreme", "grey circles", least);
    print_programs(list, "extreme", "double, all options", precise);
}

/* Prints the programs with each other value of each option, one at a time. */
static void print_variants(program_list *list, const char *name, gscl_kernel_options base) {
    gscl_kernel_options variant;
    char use[80];
/* `least` to `most`: the values of the field of gscl_kernel_options.  Other losses than L2 go without weights. */
#define PRINT_VALUES(field, least, most)                                          \
    for (int value = (least); value <= (most); value++) {                         \
        variant = base;                                                           \
        variant.field = value;                                                    \
        if (variant.loss != GSCL_LOSS_KIND_L2)                                    \
            variant.weighted = GSCL_WEIGHTED_NOT;                                 \
        snprintf(use, sizeof use, "%s, " #field " %d", name, value);              \
        print_programs(list, "other", value == base.field ? name : use, variant); \
    }
    PRINT_VALUES(blend, GSCL_NORMALIZED, GSCL_SUM)
    PRINT_VALUES(colours, 3, 3)
    PRINT_VALUES(colours, 1, 1)
    PRINT_VALUES(alpha_channel, 0, 1)
    PRINT_VALUES(opacity, 0, 1)
    PRINT_VALUES(texture, 0, 1)
    PRINT_VALUES(shape, GSCL_SHAPE_ROTATED, GSCL_SHAPE_ISOTROPIC)
    PRINT_VALUES(loss, GSCL_LOSS_KIND_L2, GSCL_LOSS_KIND_EXTERNAL)
    PRINT_VALUES(weighted, GSCL_WEIGHTED_NOT, GSCL_WEIGHTED_LUMA)
#undef PRINT_VALUES
}

/* Prints the programs of measuring images of these options. */
static void print_measured(program_list *list, const char *name, gscl_kernel_options base) {
    gscl_kernel_options variant;
    char use[80];
    base.loss = GSCL_LOSS_KIND_L2;
    base.weighted = GSCL_WEIGHTED_NOT;
#define PRINT_VALUE(field, value)                                              \
    do {                                                                       \
        variant = base;                                                        \
        variant.field = (value);                                               \
        snprintf(use, sizeof use, "%s, " #field " %g", name, (double)(value)); \
        print_programs(list, "other", use, variant);                           \
    } while (0)
    PRINT_VALUE(exponential, GSCL_EXPONENTIAL_POLYNOMIAL);
    PRINT_VALUE(exponential, GSCL_EXPONENTIAL_EXACT);
    PRINT_VALUE(exponential, GSCL_EXPONENTIAL_NATIVE);
    PRINT_VALUE(support, 12.5); /* 5 sigma */
    PRINT_VALUE(early_stop, 1 / 255.0);
    PRINT_VALUE(is_double, 1);
#undef PRINT_VALUE
}

static void print_mapping(const char *mapping, bool is_gpu, const char *platform) {
    static program_list list;
    const gscl_quirks *quirks = gscl_quirks_find(platform, "");
    gscl_opencl_device device = {.quirks = quirks};
    list = (program_list){
        .mapping = mapping,
        .context = {.device = &device, .is_cpu = !is_gpu, .gpu_mapping = is_gpu, .shapes = &quirks->shapes}};
    print_encode(&list);
    print_extremes(&list);
    print_variants(&list, "encode", encode);
    print_variants(&list, "paper", paper);
    print_measured(&list, "encode", encode);
    print_measured(&list, "paper", paper);
}

int main(void) {
    print_mapping("gpu", true, "");
    print_mapping("cpu", false, "");
    print_mapping("rusticl", true, "rusticl");
    return 0;
}
