#include "runtime/mapping.h"

#include "cl/constants.h"
#include "runtime/tunables.h"

int gscl_mapping_lanes(const gscl_context *context) {
    return context->gpu_mapping ? gscl_runtime_tunables.gpu_lanes : gscl_runtime_tunables.cpu_lanes;
}

int gscl_mapping_rows(const gscl_context *context) {
    return context->gpu_mapping ? gscl_runtime_tunables.gpu_rows : gscl_runtime_tunables.cpu_rows;
}

int gscl_mapping_cached_rows(const gscl_context *context) {
    return context->gpu_mapping ? 0 : gscl_runtime_tunables.cpu_cached_rows;
}

/* Explicit vectors take longer to build.  Only a fit runs its kernels often enough to make up for it. */
int gscl_splat_lanes(const gscl_context *context, gscl_program_kind kind) {
    return kind == GSCL_PROGRAM_FIT && !context->gpu_mapping ? gscl_runtime_tunables.cpu_splat_lanes : 1;
}

size_t gscl_tile_group_size(const gscl_context *context) {
    return (size_t)(GSCL_TILE / gscl_mapping_lanes(context)) * (size_t)(GSCL_TILE / gscl_mapping_rows(context));
}

size_t gscl_chunk_groups(const gscl_context *context, int width, int rows, size_t group_size) {
    const int lanes = gscl_mapping_lanes(context);
    const size_t chunks = (size_t)((width + lanes - 1) / lanes) * (size_t)rows;
    return (chunks + group_size - 1) / group_size;
}
