/* gscl_read_field: the splats of a file, and what is needed to draw them. */
#include <gscl/gscl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/blend.h"
#include "decode/coded_image.h"
#include "runtime/elementary.h"
#include "runtime/struct_size.h"

/* Colours of the coded channels as R, G, B and alpha. */
static void spread_colour(const gsf_header *header, const float *coded, float colour[4]) {
    for (int k = 0; k < 3; k++)
        colour[k] = coded[header->has_chroma ? k : 0];
    colour[3] = header->has_alpha ? coded[header->has_chroma ? 3 : 1] : 1.0f;
}

static gscl_splat drawn_splat(const gscl_coded_image *coded, size_t i, const float *params) {
    const gsf_header *header = &coded->file.header;
    gscl_splat s = {.x = params[GSCL_X],
                    .y = params[GSCL_Y],
                    .sigma1 = (float)gscl_exp(params[GSCL_LOG_S1]),
                    .sigma2 = (float)gscl_exp(params[GSCL_LOG_S2]),
                    .theta = params[GSCL_THETA],
                    .opacity = header->has_opacity ? 1.0f / (1.0f + (float)gscl_exp(-params[GSCL_OPACITY])) : 1.0f};
    spread_colour(header, params + GSCL_COLOUR, s.colour);
    if (header->coding == GSF_CODING_SCALAR)
        s.layer = coded->file.splats[i].layer;
    if (!header->has_texture || params[GSCL_WAVE_AMPLITUDE] == 0.0f)
        return s;
    s.wave_x = params[GSCL_WAVE_X];
    s.wave_y = params[GSCL_WAVE_Y];
    s.wave_phase = params[GSCL_WAVE_PHASE];
    s.wave_amplitude = params[GSCL_WAVE_AMPLITUDE];
    return s;
}

static gscl_steps steps_of(const gsf_steps *s) {
    return (gscl_steps){s->scale, s->position, s->angle, s->luma, s->chroma, s->alpha, s->opacity, s->pivot};
}

/* All but the splats. */
static void describe(const gsf_coded_image *file, const float *background, gscl_field *field) {
    const gsf_header *header = &file->header;
    *field = (gscl_field){.struct_size = sizeof *field,
                          .width = header->width,
                          .height = header->height,
                          .channels = gscl_coded_image_channels(header),
                          .sample = header->high_bit_depth ? GSCL_SAMPLE_U16 : GSCL_SAMPLE_U8,
                          .blend = gscl_blend_from_format(header->blend),
                          .has_mean_background = file->has_mean_background && header->splat_count > 0,
                          .has_steps = header->coding == GSF_CODING_SCALAR && header->splat_count > 0,
                          .count = header->splat_count};
    if (field->has_steps)
        field->steps = steps_of(&file->steps);
    spread_colour(header, background, field->background);
}

static gscl_result list_splats(const gscl_coded_image *coded, gscl_field *field) {
    const size_t count = coded->file.header.splat_count;
    float background[4], *params = malloc((count + 1) * GSCL_PARAMS * sizeof *params);
    gscl_splat *splats = malloc((count + 1) * sizeof *splats);
    if (!params || !splats) {
        free(params);
        free(splats);
        return GSCL_ERROR_OUT_OF_MEMORY;
    }
    gscl_coded_image_params(coded, params, background);
    describe(&coded->file, background, field);
    for (size_t i = 0; i < count; i++)
        splats[i] = drawn_splat(coded, i, params + i * GSCL_PARAMS);
    field->splats = splats;
    free(params);
    return GSCL_OK;
}

gscl_result gscl_read_field(const uint8_t *bytes, size_t size, const gscl_read_settings *settings, gscl_field *field) {
    if (!bytes || !field)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_read_settings s;
    gscl_read_settings_default(&s);
    GSCL_TRY(gscl_struct_read(NULL, "gscl_read_settings", settings, sizeof s, &s, sizeof s));
    GSCL_TRY(gscl_struct_check(NULL, "gscl_field", field, sizeof *field, sizeof *field));
    gscl_coded_image coded;
    GSCL_TRY(gscl_coded_image_read(&coded, bytes, size, s.bare));
    gscl_field own;
    const gscl_result result = list_splats(&coded, &own);
    gscl_coded_image_free(&coded);
    if (result == GSCL_OK)
        gscl_struct_write(field, &own);
    return result;
}

/* The eigenvalues of a symmetric matrix, without cancellation in the smaller one. */
bool gscl_splat_set_covariance(gscl_splat *splat, double xx, double xy, double yy) {
    const double mean = xx / 2 + yy / 2, distance = gscl_hypot(xx / 2 - yy / 2, xy), larger = mean + distance;
    const double smaller = (xx / larger) * yy - (xy / larger) * xy; /* the determinant by the larger one */
    if (!splat || !(larger > 0 && larger < INFINITY && smaller > 0))
        return false;
    splat->sigma1 = (float)sqrt(larger);
    splat->sigma2 = (float)sqrt(smaller);
    const double theta = gscl_atan2(xy, xx / 2 - yy / 2) / 2;
    splat->theta = (float)(theta < 0 ? theta + 3.14159265358979323846 : theta);
    return true;
}
