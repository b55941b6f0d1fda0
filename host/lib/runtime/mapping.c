#include "runtime/mapping.h"

#include "cl/constants.h"
#include "runtime/tunables.h"

#define LEAST_RDO_GROUP 32 /* of cl/rdo_items.cl, where it is not 1 */

/* What the implementation changes of the context's mapping; 0: nothing. */
static const gscl_work_shape *mapping_shape(const gscl_context *context) {
    return context->gpu_mapping ? &context->shapes->gpu : &context->shapes->cpu;
}

bool gscl_mapping_auto(const gscl_context *context) {
    return !context->is_cpu || context->shapes->wide_groups;
}

/* Whether groups have as many work-items as on a GPU where a single one could do their work. */
static bool has_wide_groups(const gscl_context *context) {
    return context->gpu_mapping || context->shapes->wide_groups;
}

int gscl_mapping_lanes(const gscl_context *context) {
    const int lanes = mapping_shape(context)->lanes;
    return lanes ? lanes : context->gpu_mapping ? gscl_runtime_tunables.gpu_lanes : gscl_runtime_tunables.cpu_lanes;
}

int gscl_mapping_rows(const gscl_context *context) {
    const int rows = mapping_shape(context)->rows;
    return rows ? rows : context->gpu_mapping ? gscl_runtime_tunables.gpu_rows : gscl_runtime_tunables.cpu_rows;
}

int gscl_mapping_cached_rows(const gscl_context *context) {
    return context->gpu_mapping ? 0 : gscl_runtime_tunables.cpu_cached_rows;
}

/* Explicit vectors take longer to build.  Only a fit runs its kernels often enough to make up for it. */
int gscl_splat_lanes(const gscl_context *context, gscl_program_kind kind) {
    const int lanes = mapping_shape(context)->splat_lanes;
    const bool is_of_a_fit = kind == GSCL_PROGRAM_FIT || kind == GSCL_PROGRAM_GRADIENTS;
    if (!is_of_a_fit || context->gpu_mapping)
        return 1;
    return lanes ? lanes : gscl_runtime_tunables.cpu_splat_lanes;
}

size_t gscl_tile_group_size(const gscl_context *context) {
    return GSCL_TILE_ITEMS((size_t)gscl_mapping_lanes(context), (size_t)gscl_mapping_rows(context));
}

/* Half of the work-items, or a quarter and so on, where there may not be more than `largest`; 0: no limit. */
static size_t limit_group(size_t items, size_t largest) {
    while (items > 1 && largest && items > largest)
        items /= 2;
    return items;
}

size_t gscl_band_group_size(const gscl_context *context) {
    const size_t items = has_wide_groups(context) ? (size_t)gscl_runtime_tunables.gpu_band_items : 1;
    return limit_group(items, context->largest_group);
}

size_t gscl_bin_group_size(const gscl_context *context) {
    return has_wide_groups(context) ? (size_t)gscl_runtime_tunables.gpu_bin_items : 1;
}

size_t gscl_link_splats(const gscl_context *context) {
    const struct gscl_runtime_tunables *t = &gscl_runtime_tunables;
    return (size_t)(has_wide_groups(context) ? t->gpu_link_splats : t->cpu_link_splats);
}

int gscl_counted_links(const gscl_context *context) {
    const struct gscl_runtime_tunables *t = &gscl_runtime_tunables;
    return has_wide_groups(context) ? t->gpu_counted_links : t->cpu_counted_links;
}

size_t gscl_slot_group_size(const gscl_context *context) {
    return has_wide_groups(context) ? (size_t)gscl_runtime_tunables.gpu_slot_items : 1;
}

size_t gscl_rdo_group_size(const gscl_context *context) {
    const size_t items = has_wide_groups(context) ? (size_t)gscl_runtime_tunables.gpu_rdo_items : 1;
    return limit_group(limit_group(items, context->largest_group), context->largest_rdo_group);
}

bool gscl_rdo_group_halve(gscl_context *context) {
    const size_t items = gscl_rdo_group_size(context);
    if (items <= LEAST_RDO_GROUP)
        return false;
    context->largest_rdo_group = items / 2;
    return true;
}

size_t gscl_sum_group_size(const gscl_context *context) {
    return has_wide_groups(context) ? GSCL_SUM_ITEMS : 1;
}

size_t gscl_chunk_group_size(const gscl_context *context) {
    const struct gscl_runtime_tunables *t = &gscl_runtime_tunables;
    return (size_t)(context->gpu_mapping ? t->gpu_chunk_items : t->cpu_chunk_items);
}

int gscl_chunk_lanes(const gscl_context *context) {
    return context->gpu_mapping ? gscl_runtime_tunables.gpu_chunk_lanes : gscl_mapping_lanes(context);
}

size_t gscl_chunk_groups(const gscl_context *context, int width, int rows) {
    const int lanes = gscl_chunk_lanes(context);
    const size_t chunks = (size_t)((width + lanes - 1) / lanes) * (size_t)rows;
    const size_t group_size = gscl_chunk_group_size(context);
    return (chunks + group_size - 1) / group_size;
}

size_t gscl_mapping_largest_group(const gscl_context *context) {
    const size_t sizes[] = {GSCL_SPLATS_PER_GROUP,
                            GSCL_IMAGE_GROUP,
                            GSCL_BOOK_GROUP,
                            GSCL_BENCHMARK_GROUP,
                            gscl_tile_group_size(context),
                            gscl_band_group_size(context),
                            gscl_bin_group_size(context),
                            gscl_slot_group_size(context),
                            gscl_rdo_group_size(context),
                            gscl_sum_group_size(context),
                            gscl_chunk_group_size(context)};
    size_t largest = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        largest = sizes[i] > largest ? sizes[i] : largest;
    return largest;
}
