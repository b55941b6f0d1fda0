/* A fit that starts from the scene, and files of its splats. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"
#include "decodes.h"
#include "fit/fit.h"
#include "decode/coded_image.h"
#include "decode/quantise.h"

/* ---- The file ---- */

static gscl_coded_image coded_image_of(const scene *s, const float *params, const float background[4]) {
    gscl_coded_image p = {0};
    p.file.header = (gsf_header){.blend = (gsf_blend)s->blend,
                                 .layout = GSF_RGB,
                                 .has_chroma = true,
                                 .has_opacity = true,
                                 .has_rotation = true,
                                 .has_anisotropy = true,
                                 .width = (uint32_t)s->width,
                                 .height = (uint32_t)s->height,
                                 .splat_count = (uint32_t)s->count};
    p.file.steps = (gsf_steps){.scale = 6, .position = 8, .angle = 4, .luma = 8, .chroma = 4, .opacity = 3};
    assert_int_equal(gscl_coded_image_reserve(&p, s->count), GSCL_OK);
    for (int k = 0; k < SCENE_CHANNELS; k++)
        p.file.background[k] = gscl_quantise_background(&p.file.header, background[k]);
    for (size_t i = 0; i < s->count; i++)
        gscl_quantise(&p.file, params + i * GSCL_PARAMS, &p.file.splats[i]);
    return p;
}

static bool file_decodes(const scene *s, const float *params, const float background[4], char *message,
                         size_t capacity) {
    gscl_context *const *decoders;
    const int decoder_count = stability_decoders(&decoders);
    uint8_t *bytes[2] = {NULL, NULL};
    size_t sizes[2] = {0, 0};
    bool good = true;
    for (int i = 0; i < 2 && good; i++) {
        gscl_coded_image p = coded_image_of(s, params, background);
        good = gscl_coded_image_write(&p, &bytes[i], &sizes[i]) == GSCL_OK;
        gscl_coded_image_free(&p);
    }
    if (!good)
        snprintf(message, capacity, "the splats cannot be written");
    else if (sizes[0] != sizes[1] || memcmp(bytes[0], bytes[1], sizes[0])) {
        snprintf(message, capacity, "a second file has other bytes");
        good = false;
    }
    good = good && decodes_alike(decoders, decoder_count, bytes[0], sizes[0], message, capacity);
    gscl_free(bytes[0]);
    gscl_free(bytes[1]);
    return good;
}

bool scene_file_decodes(const scene *s, char *message, size_t capacity) {
    static const float grey[4] = {0.5f, 0.5f, 0.5f, 0.5f};
    return file_decodes(s, s->params, grey, message, capacity);
}

/* ---- Descent ---- */

/* `params` holds the scene's parameters and receives the fitted ones.  A first step moves the splats within the
 * library's limits, as in any fit.  Descent starts from there, with moments reset. */
static gscl_result descend(gscl_fit *fit, const scene *s, float *params, double *before, double *after) {
    GSCL_TRY(gscl_fit_append(fit, params, s->count));
    GSCL_TRY(gscl_fit_step(fit, 0.1f, 1));
    GSCL_TRY(gscl_fit_read(fit, params));
    GSCL_TRY(gscl_fit_replace(fit, params, s->count, fit->background));
    GSCL_TRY(gscl_fit_step(fit, 1.0f, 1));
    GSCL_TRY(gscl_fit_loss(fit, before));
    for (size_t i = scene_scaled(SCENE_STEPS, 2); i > 0; i--)
        GSCL_TRY(gscl_fit_step(fit, 1.0f, 1));
    GSCL_TRY(gscl_fit_differentiate(fit));
    GSCL_TRY(gscl_fit_loss(fit, after));
    return gscl_fit_read(fit, params);
}

static bool all_finite(const float *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

static bool descends(const scene *s, int mapping, float *params, float background[4], char *message, size_t capacity) {
    const gscl_kernel_options options = {.blend = s->blend, .colours = SCENE_CHANNELS, .opacity = 1};
    gscl_context *context = stability_context(mapping);
    gscl_fit fit;
    double before = NAN, after = NAN;
    gscl_result result =
        gscl_fit_create(&fit, context, &options, (uint32_t)s->width, (uint32_t)s->height, s->level, s->target);
    if (result == GSCL_OK)
        result = descend(&fit, s, params, &before, &after);
    memcpy(background, fit.background, sizeof fit.background);
    gscl_fit_free(&fit);
    if (result != GSCL_OK)
        snprintf(message, capacity, "%s", gscl_context_message(context));
    else if (!all_finite(params, s->count * GSCL_PARAMS))
        snprintf(message, capacity, "a fitted parameter is not finite");
    else if (!(after < before || after < 1e-6))
        snprintf(message, capacity, "the loss does not fall: %g, then %g", before, after);
    else
        return true;
    return false;
}

bool scene_encodes(const scene *s, char *message, size_t capacity) {
    const size_t bytes = s->count * GSCL_PARAMS * sizeof(float);
    float *params = malloc(bytes + 1), background[4];
    bool good = true;
    assert_non_null(params);
    for (int m = 0; m < stability_mapping_count() && good; m++) {
        char what[200] = "";
        memcpy(params, s->params, bytes);
        good = descends(s, m, params, background, what, sizeof what);
        if (!good)
            snprintf(message, capacity, "%s mapping: %s", stability_mapping_name(m), what);
    }
    good = good && file_decodes(s, params, background, message, capacity) &&
           (scene_scaled(2, 1) == 1 || file_decodes(s, s->params, background, message, capacity));
    free(params);
    return good;
}
