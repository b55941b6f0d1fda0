#include <gscl/gscl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/blend.h"
#include "session/effects.h"
#include "encode/effect_search.h"
#include "encode/profile.h"
#include "encode/psnr_search.h"
#include "session/encoder.h"
#include "image/flat_background.h"
#include "image/metrics.h"
#include "decode/quantise.h"
#include "session/encode_trace.h"
#include "runtime/struct_size.h"
#include "runtime/timing.h"

#define AUTO_BPP 0.125   /* GSCL_TARGET_AUTO: this many bits per pixel, */
#define AUTO_BYTES 256.0 /* but at least so many bytes */
#define FEW_SPLATS 2     /* so few may be worse than none */

void gscl_encode_settings_init(gscl_encode_settings *settings, size_t struct_size) {
    const gscl_encode_settings defaults = {.effort = GSCL_DEFAULT_EFFORT, .seed = 1};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}

static gscl_result check_settings(gscl_context *context, const gscl_encode_settings *s) {
    if (s->profile > GSCL_PROFILE_PAPER || s->blend > GSCL_BLEND_SUM || s->loss > GSCL_LOSS_L2 ||
        s->tune > GSCL_TUNE_SSIM || s->target > GSCL_TARGET_SPLATS)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "a setting is not one of its choices");
    if (s->effort < 0 || s->effort > GSCL_MAX_EFFORT)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "effort %d is not in 0..%d", s->effort, GSCL_MAX_EFFORT);
    if (!(s->target_value >= 0) || !isfinite(s->target_value))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the target %g is not a positive number",
                         s->target_value);
    if (s->target == GSCL_TARGET_SPLATS && s->target_value > GSCL_MAX_SPLATS)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "%.0f splats are more than %d", s->target_value,
                         GSCL_MAX_SPLATS);
    if (s->codebook_size != 0 && s->profile != GSCL_PROFILE_PAPER)
        return gscl_fail(context, GSCL_ERROR_CONFLICT, "a codebook size needs the paper profile");
    if (s->codebook_size == 1 || s->codebook_size > GSF_MAX_CODEBOOK)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "%u code words are not in 2..%d", s->codebook_size,
                         GSF_MAX_CODEBOOK);
    if (s->step_factor != 0 && s->profile == GSCL_PROFILE_PAPER)
        return gscl_fail(context, GSCL_ERROR_CONFLICT, "quantiser steps are the default profile's");
    if (s->step_factor != 0 && !(s->step_factor >= 0.25 && s->step_factor <= 4))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "%g times the quantiser's steps are not in 0.25..4",
                         s->step_factor);
    if (s->profile == GSCL_PROFILE_PAPER && s->blend != GSCL_BLEND_AUTO && s->blend != GSCL_BLEND_ALPHA)
        return gscl_fail(context, GSCL_ERROR_CONFLICT,
                         "the paper profile blends by alpha; choose another profile for other blends");
    bool squared = s->loss == GSCL_LOSS_AUTO || s->loss == GSCL_LOSS_L2;
    if (s->tune == GSCL_TUNE_SSIM && (s->profile == GSCL_PROFILE_PAPER || !squared))
        return gscl_fail(context, GSCL_ERROR_CONFLICT,
                         "tuning for SSIM weighs squared errors; it needs the default profile and the loss L2");
    return GSCL_OK;
}

static void resolve_auto(gscl_encode_settings *s) {
    bool paper = s->profile == GSCL_PROFILE_PAPER;
    if (s->blend == GSCL_BLEND_AUTO)
        s->blend = paper ? GSCL_BLEND_ALPHA : GSCL_BLEND_NORMALIZED;
    if (s->loss == GSCL_LOSS_AUTO)
        s->loss = paper ? GSCL_LOSS_L1_SSIM : GSCL_LOSS_L2;
}

/* The header says what the image is and which effects it calls for, as far as that is known before the fit. */
static void fill_header(gscl_encoder *e) {
    static const gsf_layout layouts[] = {GSF_GREY, GSF_GREY, GSF_GREY_ALPHA, GSF_RGB, GSF_RGBA};
    bool paper = e->settings.profile == GSCL_PROFILE_PAPER;
    e->coded.file.header = (gsf_header){.version = GSF_VERSION,
                                        .blend = gscl_blend_to_format(e->settings.blend),
                                        .coding = paper ? GSF_CODING_CODEBOOK : GSF_CODING_SCALAR,
                                        .layout = layouts[e->image->channels],
                                        .high_bit_depth = e->content.high_bit_depth,
                                        .width = e->image->width,
                                        .height = e->image->height};
    gscl_effects_begin(e);
}

/* The picture without splats: one colour. */
static void encode_flat(gscl_encoder *e) {
    gscl_pixel p = gscl_image_pixel(e->image, 0, 0);
    gsf_coded_image *file = &e->coded.file;
    int colours = file->header.has_chroma ? 3 : 1;
    file->header.splat_count = 0;
    for (int k = 0; k < colours; k++)
        file->background[k] = gscl_quantise_background(&file->header, p.colour[k]);
    if (file->header.has_alpha)
        file->background[colours] = gscl_quantise_background(&file->header, p.alpha);
}

/* The smallest file that this image can have: no splats. */
static gscl_result check_budget(gscl_encoder *e, double budget) {
    size_t smallest;
    encode_flat(e);
    GSCL_TRY(gscl_encoder_size(e, &smallest));
    if (budget < (double)smallest)
        return gscl_fail(e->context, GSCL_ERROR_BUDGET_TOO_SMALL,
                         "a budget of %.0f bytes is too small; the smallest file of this image has %zu bytes",
                         floor(budget), smallest);
    return GSCL_OK;
}

/* Leaves out a few splats that show less than their weight spoils. */
static gscl_result prefer_flat(gscl_encoder *e) {
    gsf_header *header = &e->coded.file.header;
    const uint32_t count = header->splat_count;
    double with, without;
    if (count == 0 || count > FEW_SPLATS)
        return GSCL_OK;
    GSCL_TRY(gscl_encoder_psnr(e, &with));
    header->splat_count = 0; /* the background is the mean colour */
    GSCL_TRY(gscl_encoder_psnr(e, &without));
    if (with >= without)
        header->splat_count = count;
    return GSCL_OK;
}

static gscl_result encode_to_bytes(gscl_encoder *e) {
    const gscl_encode_settings *s = &e->settings;
    double pixels = (double)e->image->width * e->image->height;
    double budget = s->target == GSCL_TARGET_AUTO    ? fmax(AUTO_BPP * pixels / 8, AUTO_BYTES)
                    : s->target == GSCL_TARGET_BYTES ? s->target_value
                                                     : s->target_value * pixels / 8;
    GSCL_TRY(check_budget(e, budget));
    if (e->content.flat)
        return GSCL_OK;
    size_t bytes = (size_t)fmin(budget, 1e12);
    GSCL_TRY(gscl_effects_try(e, bytes, 0));
    GSCL_TRY(gscl_encode_profile(e, bytes, 0));
    return prefer_flat(e);
}

static gscl_result encode_target(gscl_encoder *e) {
    switch (e->settings.target) {
    case GSCL_TARGET_AUTO:
    case GSCL_TARGET_BPP:
    case GSCL_TARGET_BYTES:
        return encode_to_bytes(e);
    case GSCL_TARGET_SPLATS:
        encode_flat(e);
        if (e->content.flat || e->settings.target_value < 1)
            return GSCL_OK;
        GSCL_TRY(gscl_effects_try(e, 0, (size_t)e->settings.target_value));
        return gscl_encode_profile(e, 0, (size_t)e->settings.target_value);
    case GSCL_TARGET_PSNR:
        break;
    }
    encode_flat(e);
    if (e->content.flat)
        return GSCL_OK;
    GSCL_TRY(gscl_effects_try(e, (size_t)(AUTO_BPP / 8 * e->image->width * e->image->height), 0));
    return gscl_encode_to_psnr(e);
}

static gscl_result finish(gscl_encoder *e, uint8_t **bytes, size_t *size, gscl_encode_trace *trace) {
    gscl_encode_report *report = trace->report;
    gsf_header *header = &e->coded.file.header;
    if (header->splat_count == 0)
        header->has_opacity = header->has_rotation = header->has_anisotropy = header->has_texture = false;
    gscl_stage(e->context, GSCL_STAGE_WRITE);
    gscl_result result = gscl_coded_image_write(&e->coded, bytes, size);
    gscl_stage(e->context, GSCL_STAGE_NONE);
    if (result != GSCL_OK)
        return gscl_fail(e->context, result, "the picture could not be written: %s", gscl_result_text(result));
    if (!report)
        return GSCL_OK;
    report->splats = e->coded.file.header.splat_count;
    report->bytes = *size;
    report->trials = e->trials ? e->trials : 1;
    report->blend = e->settings.blend;
    report->effect_count = e->decision_count;
    memcpy(report->effects, e->decisions, sizeof e->decisions);
    gscl_encode_trace_end(trace, e->context); /* what follows is no part of the encode */
    return gscl_file_psnr(e->context, *bytes, *size, e->image, &report->psnr);
}

gscl_result gscl_encode(gscl_context *context, const gscl_image *image, const gscl_encode_settings *settings,
                        uint8_t **bytes, size_t *size, gscl_encode_report *report) {
    if (!context || !bytes || !size)
        return GSCL_ERROR_INVALID_ARGUMENT;
    context->message[0] = 0;
    gscl_encoder e = {.context = context, .image = image};
    gscl_encode_settings_default(&e.settings);
    GSCL_TRY(GSCL_STRUCT_READ(context, gscl_encode_settings, trace, settings, &e.settings));
    if (report)
        GSCL_TRY(GSCL_STRUCT_CHECK(context, gscl_encode_report, trace_count, report));
    GSCL_TRY(check_settings(context, &e.settings));
    gscl_encode_trace trace = {0};
    gscl_encode_report measured;
    if (report)
        gscl_encode_trace_begin(&trace, context, &measured, e.settings.trace);
    if (report)
        e.trace = &trace;
    gscl_stage(context, GSCL_STAGE_PREPARE);
    gscl_result result = gscl_image_examine(context, image, &e.content);
    if (result == GSCL_OK) {
        resolve_auto(&e.settings);
        gscl_progress_begin(&e.progress, &e.settings);
        e.random = e.settings.seed;
        result = gscl_effects_check(&e);
    }
    if (result == GSCL_OK) {
        fill_header(&e);
        result = e.content.flat ? GSCL_OK : gscl_encoder_make_planes(&e);
    }
    if (result == GSCL_OK)
        result = encode_target(&e);
    uint8_t *written = NULL;
    size_t written_size = 0;
    if (result == GSCL_OK)
        result = finish(&e, &written, &written_size, &trace);
    if (result == GSCL_OK) {
        *bytes = written;
        *size = written_size;
        if (report)
            gscl_struct_write(report, &measured);
    } else {
        free(written);
    }
    free(e.source.planes);
    gscl_coded_image_free(&e.coded);
    gscl_stage(context, GSCL_STAGE_NONE);
    gscl_encode_trace_end(&trace, context);
    return result;
}
