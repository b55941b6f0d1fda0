/* The quirks of OpenCL implementations: whose, of which version, what fails, and why. */
#include "opencl/quirks.h"

#include <stddef.h>
#include <string.h>

static const gscl_quirks quirks[] = {
    /* PoCL 3.1 reads a megabyte of declarations before each program, even if its cache has the kernels: 0.2 s for each of
     * the seven programs of an encode.  cl/builtins.h declares what the kernels use; each still takes 8 to 20 ms.  PoCL
     * builds one program at a time, but runs kernels meanwhile.
     * Any PoCL builds slow generic kernels for CL_PROGRAM_BINARIES, and has a cache. */
    {.platform = "Portable Computing Language",
     .version = "PoCL 3.",
     .own_builtins = true,
     .own_cache = true,
     .builds_aside = true},
    {.platform = "Portable Computing Language", .own_cache = true},

    /* NVIDIA's driver has a cache. */
    {.platform = "NVIDIA CUDA", .own_cache = true},

    /* Mesa 22.3.6, rusticl on llvmpipe.  libclc for Mesa computes fma() with integers: with it the kernels of an encode of
     * 192x128 pixels compile for 80 to 120 s instead of 7, and run for 42 s instead of 8.  llvmpipe runs 8 work-items side
     * by side, one in each lane of the processor's vectors, and splits explicit vectors into as many instructions as they
     * have elements, so that they bring nothing: an encode takes 12 s with vectors of 4 pixels, 8 without.  It ends all
     * loops of a work-item after 65,535 iterations in all, without a word: a single work-item must not go over the pixels
     * of a large splat.  Each launch translates its kernel anew, for up to 50 ms, with the machine code taken from Mesa's
     * own cache on disk; where that cache is off (MESA_SHADER_CACHE_DISABLE) each launch takes as long as the first.  It
     * says of kernels that require groups of 256, and run in them, that they run in groups of at most 32. */
    {.platform = "rusticl",
     .software_fma = true,
     .understates_groups = true,
     .shapes = {.wide_groups = true,
                .cpu = {.lanes = 1, .rows = 4, .splat_lanes = 1},
                .gpu = {.lanes = 1, .rows = 4, .splat_lanes = 1}}},

    /* Intel's CPU runtime 2026.22 compiles step_splats with vectors of 16 splats for longer than all other kernels of a fit
     * together, and it has no cache: an encode of one picture would not make up for it. */
    {.platform = "Intel(R) OpenCL", .shapes = {.cpu = {.splat_lanes = 1}}},

    {.platform = NULL},
};

/* What holds for all kernels and all implementations, because of one of them:
 *   - Mesa 22.3 (rusticl) reads 0 where a kernel indexes an array inside a struct argument at run time, or dereferences
 *     NULL at its launch: such an array is copied to private variables first (colour_descend in cl/rdo_colour.cl,
 *     visual_shares in cl/visual.cl).
 *   - Oclgrind 21.10 does not know llvm.experimental.noalias.scope.decl, which inlining makes of `restrict` parameters
 *     and of returned structs: ALWAYS_INLINE functions have none, and it runs with -cl-opt-disable.
 *   - Oclgrind 21.10 evaluates clamp, min and max of a vector and a scalar wrongly: bounds are vectors (cl/splat_lanes.cl).
 *   - PoCL 3.1 hangs or fails on barriers in loops whose number of iterations differs between work-items, and on returns
 *     before a barrier: both are uniform (fit_tiles in cl/fit.cl).
 *   - Intel's runtime 2026 has no device in a process that has loaded an older libtbb before, as OpenImageIO of Debian 12
 *     does: gscl encode finds it for PNG and JPEG, which need no OpenImageIO.
 *   - PoCL 3.1 does not report failed allocations: sizes are checked first (buffer_create in runtime/buffer.c). */

static bool text_contains(const char *text, const char *part) {
    return !part || strstr(text, part) != NULL;
}

const gscl_quirks *gscl_quirks_find(const char *platform_name, const char *platform_version) {
    const gscl_quirks *found = quirks;
    while (found->platform &&
           !(text_contains(platform_name, found->platform) && text_contains(platform_version, found->version)))
        found++;
    return found;
}
