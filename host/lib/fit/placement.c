#include "fit/placement.h"

#include <math.h>

#include "cl/constants.h"
#include "fit/random.h"
#include "fit/tunables.h"

gscl_placement_settings gscl_placement_begin(const gscl_fit *f, size_t count) {
    const struct gscl_fit_tunables *t = &gscl_fit_tunables;
    const int32_t width = (int32_t)gscl_fit_level_width(f), height = (int32_t)gscl_fit_level_height(f);
    const int32_t strip = (int32_t)sqrt((double)width * height / (double)count) + 1;
    return (gscl_placement_settings){.width = width,
                                     .height = height,
                                     .channels = f->renderer.channels,
                                     .scale = ldexpf(1.0f, f->level),
                                     .strip = strip,
                                     .columns = width * ((height + strip - 1) / strip),
                                     .first = f->renderer.count,
                                     .count = (int32_t)count,
                                     .is_rotated = f->renderer.options.shape == GSCL_SHAPE_ROTATED,
                                     .min_axis = t->min_axis,
                                     .edge_stretch = t->edge_stretch,
                                     .min_edge = t->min_edge,
                                     .max_edge_radius = t->max_edge_radius};
}

/* Sums the density over the columns of the walk, each with those before it. */
static gscl_result add_up_columns(gscl_fit *f, gscl_placement_settings settings) {
    const size_t columns = (size_t)settings.columns, groups = gscl_groups(columns, GSCL_COLUMNS_OF_GROUP);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->column_weights, columns * sizeof(uint64_t)));
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->group_weights, groups * sizeof(uint64_t)));
    GSCL_TRY(gscl_image_kernel(f->context, "weigh_columns", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, groups, gscl_sum_group_size(f->context), GSCL_ARG_BUFFER(f->error),
                         GSCL_ARG(settings), GSCL_ARG_BUFFER(f->density_total), GSCL_ARG_BUFFER(f->column_weights),
                         GSCL_ARG_BUFFER(f->group_weights)));
    GSCL_TRY(gscl_image_kernel(f->context, "add_columns", &kernel));
    return GSCL_LAUNCH(f->context, kernel, groups, gscl_sum_group_size(f->context), GSCL_ARG(settings),
                       GSCL_ARG_BUFFER(f->group_weights), GSCL_ARG_BUFFER(f->column_weights));
}

gscl_result gscl_placement_append(gscl_fit *f, gscl_placement_settings settings, uint64_t *random) {
    const size_t count = (size_t)settings.count;
    const uint64_t seed = *random;
    gscl_kernel *kernel;
    gscl_random_skip(random, GSCL_PLACEMENT_DRAWS * (uint64_t)count);
    GSCL_TRY(add_up_columns(f, settings));
    GSCL_TRY(gscl_fit_begin_append(f, count));
    GSCL_TRY(gscl_image_kernel(f->context, "place_splats", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, count, gscl_sum_group_size(f->context),
                         GSCL_ARG_BUFFER(f->pyramid.levels[f->level]), GSCL_ARG_BUFFER(f->error), GSCL_ARG(settings),
                         GSCL_ARG_BUFFER(f->density_total), GSCL_ARG_BUFFER(f->column_weights), GSCL_ARG(seed),
                         GSCL_ARG_BUFFER(f->renderer.params)));
    return gscl_fit_end_append(f, count);
}
