#include "cl/constants.h"
#include "fit/fit.h"
#include "fit/tunables.h"
#include "runtime/queue.h"

#define PIXELS_OF_GROUP 1024 /* at least, of those that a work-group adds up */
#define MAX_GROUPS 1024      /* whose sums the last work-group adds up */

gscl_result gscl_fit_loss(gscl_fit *f, double *loss) {
    gscl_lists_state state;
    GSCL_TRY(gscl_fit_sum_loss(f));
    GSCL_TRY(gscl_fit_begin_readings(f));
    GSCL_TRY(gscl_finish(f->context));
    GSCL_TRY(gscl_fit_end_readings(f, &state));
    *loss = f->known_loss;
    return GSCL_OK;
}

/* Writes the squared error of each pixel of the rendering against the level's target. */
static gscl_result launch_error(gscl_fit *f) {
    gscl_kernel *kernel;
    const size_t pixels = gscl_fit_level_pixels(f);
    const int32_t channels = f->renderer.channels, weighted = f->renderer.options.weighted, count = (int32_t)pixels;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->error, pixels * sizeof(float)));
    GSCL_TRY(gscl_image_kernel(f->context, "squared_error", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_groups(pixels, GSCL_IMAGE_GROUP), GSCL_IMAGE_GROUP,
                       GSCL_ARG_BUFFER(f->renderer.image), GSCL_ARG_BUFFER(*gscl_fit_weighted_target(f)),
                       GSCL_ARG(channels), GSCL_ARG(weighted), GSCL_ARG(count), GSCL_ARG_BUFFER(f->error));
}

gscl_result gscl_fit_begin_error(gscl_fit *f) {
    GSCL_TRY(gscl_fit_render(f));
    return launch_error(f);
}

/* All that the host needs to know is read at once.  If a list was too short, the next rendering has room. */
gscl_result gscl_fit_error(gscl_fit *f, float *error) {
    gscl_lists_state state;
    GSCL_TRY(gscl_fit_set_rows(f, 1));
    do {
        GSCL_TRY(gscl_fit_bin(f, false));
        GSCL_TRY(gscl_renderer_draw(&f->renderer));
        GSCL_TRY(launch_error(f));
        GSCL_TRY(gscl_fit_begin_readings(f));
        GSCL_TRY(gscl_buffer_read(f->context, &f->error, 0, error, gscl_fit_level_pixels(f) * sizeof *error));
        GSCL_TRY(gscl_fit_end_readings(f, &state));
    } while (state == GSCL_LISTS_CUT);
    return GSCL_OK;
}

/* A sum of squared errors. */
typedef struct error_sum {
    const gscl_buffer *planes, *target; /* of the size of `level` */
    int level;
    int32_t weighted;         /* GSCL_WEIGHTED_... */
    const gscl_buffer *added; /* a float that is added twice, or NULL */
} error_sum;

/* How a sum over pixels is shared by work-groups. */
typedef struct sum_parts {
    int32_t pixels, share; /* of all groups, and of each */
    int32_t groups;
} sum_parts;

static sum_parts parts_of(size_t pixels) {
    const size_t few = gscl_groups(pixels, PIXELS_OF_GROUP), most = few < MAX_GROUPS ? few : MAX_GROUPS;
    const size_t share = gscl_groups(pixels, most);
    return (sum_parts){(int32_t)pixels, (int32_t)share, (int32_t)gscl_groups(pixels, share)};
}

/* Adds the sums of the groups, and twice *added unless it is NULL, into *to. */
static gscl_result launch_sum_groups(gscl_fit *f, sum_parts parts, const gscl_buffer *added, gscl_buffer *to) {
    const float factor = added ? 2.0f : 0.0f;
    const gscl_buffer *other = added ? added : &f->error_sums;
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, to, sizeof(float)));
    GSCL_TRY(gscl_image_kernel(f->context, "sum_groups", &kernel));
    return GSCL_LAUNCH(f->context, kernel, 1, gscl_sum_group_size(f->context), GSCL_ARG_BUFFER(f->error_sums),
                       GSCL_ARG(parts.groups), GSCL_ARG(factor), GSCL_ARG_BUFFER(*other), GSCL_ARG_BUFFER(*to));
}

gscl_result gscl_fit_sum_error(gscl_fit *f) {
    const sum_parts parts = parts_of(gscl_fit_level_pixels(f));
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->error_sums, MAX_GROUPS * sizeof(float)));
    GSCL_TRY(gscl_image_kernel(f->context, "sum_plane", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, (size_t)parts.groups, gscl_sum_group_size(f->context),
                         GSCL_ARG_BUFFER(f->error), GSCL_ARG(parts.pixels), GSCL_ARG(parts.share),
                         GSCL_ARG_BUFFER(f->error_sums)));
    return launch_sum_groups(f, parts, NULL, &f->density_total);
}

/* Sums squared errors into f->distortion. */
static gscl_result launch_sum(gscl_fit *f, const error_sum *s) {
    const sum_parts parts = parts_of(gscl_pyramid_pixels(&f->pyramid, s->level));
    const int32_t channels = f->renderer.channels;
    gscl_kernel *kernel;
    GSCL_TRY(gscl_buffer_reserve(f->context, &f->error_sums, MAX_GROUPS * sizeof(float)));
    GSCL_TRY(gscl_image_kernel(f->context, "sum_squared_error", &kernel));
    GSCL_TRY(GSCL_LAUNCH(f->context, kernel, (size_t)parts.groups, gscl_sum_group_size(f->context),
                         GSCL_ARG_BUFFER(*s->planes), GSCL_ARG_BUFFER(*s->target), GSCL_ARG(channels),
                         GSCL_ARG(s->weighted), GSCL_ARG(parts.pixels), GSCL_ARG(parts.share),
                         GSCL_ARG_BUFFER(f->error_sums)));
    return launch_sum_groups(f, parts, s->added, &f->distortion);
}

static gscl_result read_sum(gscl_fit *f, double *sum) {
    float value = 0;
    GSCL_TRY(gscl_buffer_read(f->context, &f->distortion, 0, &value, sizeof value));
    *sum = value;
    return GSCL_OK;
}

gscl_result gscl_fit_rendering_error(gscl_fit *f, double *sum) {
    const gscl_buffer *image = &f->renderer.image;
    gscl_lists_state state;
    GSCL_TRY(gscl_fit_set_rows(f, 1));
    do {
        GSCL_TRY(gscl_fit_bin(f, false));
        GSCL_TRY(gscl_renderer_draw(&f->renderer));
        GSCL_TRY(gscl_fit_renew_model_at(f, image, gscl_fit_tunables.curvature_of_steps));
        GSCL_TRY(gscl_fit_begin_readings(f));
        GSCL_TRY(gscl_fit_distortion(f, image, sum));
        GSCL_TRY(gscl_fit_end_readings(f, &state));
    } while (state == GSCL_LISTS_CUT);
    return GSCL_OK;
}

gscl_result gscl_fit_begin_distortion(gscl_fit *f, const gscl_buffer *planes) {
    const bool has_model = f->model_level == f->level;
    const error_sum s = {.planes = planes,
                         .target = has_model ? &f->pyramid.levels[f->level] : gscl_fit_weighted_target(f),
                         .level = f->level,
                         .weighted = has_model ? GSCL_WEIGHTED_NOT : f->renderer.options.weighted,
                         .added = has_model ? &f->visual.loss : NULL};
    return launch_sum(f, &s);
}

gscl_result gscl_fit_distortion(gscl_fit *f, const gscl_buffer *planes, double *sum) {
    GSCL_TRY(gscl_fit_begin_distortion(f, planes));
    return read_sum(f, sum);
}

/* Against the planes of a level alone. */
static gscl_result launch_squared_error(gscl_fit *f, const gscl_buffer *planes, int level) {
    const error_sum s = {
        .planes = planes, .target = &f->pyramid.levels[level], .level = level, .weighted = GSCL_WEIGHTED_NOT};
    return launch_sum(f, &s);
}

static gscl_result squared_error_at(gscl_fit *f, const gscl_buffer *planes, int level, double *sum) {
    GSCL_TRY(launch_squared_error(f, planes, level));
    return read_sum(f, sum);
}

gscl_result gscl_fit_begin_squared_error(gscl_fit *f, const gscl_buffer *planes) {
    float *to = &f->reading->squared_error;
    GSCL_TRY(launch_squared_error(f, planes, f->level));
    return gscl_buffer_read_async(f->context, &f->distortion, to, sizeof *to);
}

gscl_result gscl_fit_squared_error(gscl_fit *f, const gscl_buffer *planes, double *sum) {
    return squared_error_at(f, planes, f->level, sum);
}

gscl_result gscl_fit_mse_against_source(gscl_fit *f, const gscl_buffer *planes, double *mse) {
    const int level = f->pyramid.first_level;
    double sum;
    GSCL_TRY(squared_error_at(f, planes, level, &sum));
    *mse = sum / ((double)gscl_pyramid_pixels(&f->pyramid, level) * f->renderer.channels);
    return GSCL_OK;
}
