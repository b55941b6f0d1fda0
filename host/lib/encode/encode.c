/* gscl_encode: the stages of an encode from top to bottom, and the loop around them where the target is a quality. */
#include <gscl/gscl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "codebook/encode_codebook.h"
#include "decode/packet_split.h"
#include "encode/effect_search.h"
#include "encode/prepare.h"
#include "encode/quality_search.h"
#include "encode/settings.h"
#include "encode/tunables.h"
#include "runtime/launch.h"
#include "runtime/struct_size.h"
#include "runtime/timing.h"
#include "scalar/encode_scalar.h"
#include "scalar/tunables.h"
#include "session/encode_trace.h"
#include "session/encoder.h"

/* A file in memory. */
typedef struct encoded_file {
    uint8_t *bytes;
    size_t size;
} encoded_file;

/* Fits splats for the target with the profile of the settings: encoder->coded. */
static gscl_result encode_once(gscl_encoder *e, gscl_size_target target) {
    gscl_encoder_restart(e); /* a fit does not depend on those before */
    gscl_trace_restart(e);
    return e->settings.profile == GSCL_PROFILE_PAPER ? gscl_encode_codebook(e, target) : gscl_encode_scalar(e, target);
}

/* Drops the splats where they are few and the background alone has a higher PSNR. */
static gscl_result prefer_background(gscl_encoder *e, const gscl_image *image) {
    gsf_header *header = &e->coded.file.header;
    const uint32_t count = header->splat_count;
    double with, without;
    if (count == 0 || count > (uint32_t)gscl_encode_tunables.few_splats)
        return GSCL_OK;
    GSCL_TRY(gscl_encoder_quality(e, image, GSCL_TARGET_PSNR, &with));
    header->splat_count = 0; /* the background is the mean colour */
    GSCL_TRY(gscl_encoder_quality(e, image, GSCL_TARGET_PSNR, &without));
    if (with >= without)
        header->splat_count = count;
    return GSCL_OK;
}

/* Encodes at the size that the search wants: a probe at effort 0. */
static gscl_result encode_at(gscl_encoder *e, const gscl_quality_search *search) {
    const int effort = e->settings.effort;
    const double probes_share = gscl_encode_tunables.probes_share, max_trials = gscl_encode_tunables.max_trials;
    const double unit =
        search->is_probe ? probes_share / search->tunables->max_small_probes : (1 - probes_share) / max_trials;
    const double from = search->is_probe ? unit * search->probes : probes_share + unit * search->trials;
    gscl_progress_stage(&e->progress, from, from + unit);
    e->settings.effort = search->is_probe ? 0 : effort;
    e->trials += !search->is_probe;
    const gscl_result result = encode_once(e, (gscl_size_target){.bytes = (size_t)search->bytes});
    e->settings.effort = effort;
    return result;
}

/* Whether a file is better than those that were kept before it: it reaches the target or, as long as none does, has the highest
 * quality of all trials, which is of use where any quality is accepted. */
static bool is_best(const gscl_encoder *e, const gscl_quality_search *search, bool reached, double quality) {
    const bool is_highest = search->high.bytes == 0 && quality >= search->best_quality;
    return reached || (e->accepts_less && is_highest);
}

/* Takes the file encoder->coded of search->bytes into the search, and into *best where it is better. */
static void take_trial(gscl_encoder *e, gscl_quality_search *search, double quality, encoded_file *file,
                       encoded_file *best) {
    const double bytes = search->bytes;
    const bool is_probe = search->is_probe, reached = gscl_quality_search_add(search, quality, (double)file->size);
    gscl_log(e->context, GSCL_LOG_INFO, "%s %d: %.0f bytes, quality %.3f", is_probe ? "probe" : "trial",
             is_probe ? search->probes : search->trials, bytes, quality);
    if (is_probe || !is_best(e, search, reached, quality))
        return;
    free(best->bytes);
    *best = *file;
    *file = (encoded_file){0};
    e->quality = quality;
}

/* One file of the search.  `best`: the smallest one that reaches the target. */
static gscl_result try_size(gscl_encoder *e, const gscl_image *image, gscl_quality_search *search, encoded_file *best) {
    encoded_file file;
    double quality;
    GSCL_TRY(encode_at(e, search));
    GSCL_TRY(gscl_coded_image_write(&e->coded, &file.bytes, &file.size));
    const gscl_result result =
        gscl_file_quality(e->context, file.bytes, file.size, true, image, e->settings.target, &quality);
    if (result == GSCL_OK)
        take_trial(e, search, quality, &file, best);
    free(file.bytes);
    return result;
}

static gscl_result fail_target(gscl_encoder *e, double best_quality) {
    return gscl_fail(e->context, GSCL_ERROR_TARGET_UNREACHABLE,
                     e->settings.target == GSCL_TARGET_PSNR
                         ? "%.2f dB cannot be reached; the best found is %.2f dB"
                         : "a SSIMULACRA 2 of %.2f cannot be reached; the best found is %.2f",
                     e->settings.target_value, best_quality);
}

/* encoder->coded becomes what this file holds. */
static gscl_result take_file(gscl_encoder *e, const encoded_file *file) {
    gscl_coded_image_free(&e->coded);
    GSCL_TRY(gscl_coded_image_read(&e->coded, file->bytes, file->size, true));
    e->coded.packets = e->packets.count;
    return GSCL_OK;
}

/* Encodes at different sizes: encoder->coded is the smallest that reaches the quality of the settings. */
static gscl_result encode_to_quality(gscl_encoder *e, const gscl_image *image) {
    const gscl_encode_settings *s = &e->settings;
    const gscl_quality_tunables *measure =
        s->target == GSCL_TARGET_PSNR ? &gscl_encode_tunables.psnr : &gscl_encode_tunables.ssimulacra2;
    gscl_quality_search search =
        gscl_quality_search_begin(measure, s->target_value, (double)image->width * image->height,
                                  s->effort >= gscl_encode_tunables.min_probing_effort);
    encoded_file best = {0};
    gscl_result result = GSCL_OK;
    while (result == GSCL_OK && !search.done)
        result = try_size(e, image, &search, &best);
    if (result == GSCL_OK && !best.bytes)
        result = fail_target(e, search.best_quality);
    if (result == GSCL_OK)
        result = take_file(e, &best);
    free(best.bytes);
    return result;
}

/* Encodes as the largest file that is searched, for PSNR and without a trace: encoder->coded is the result where its PSNR is
 * higher, and again that of `file`, which has the other tune, where it is not. */
static gscl_result try_searched_file(gscl_encoder *e, const gscl_image *image, double psnr, const encoded_file *file) {
    gscl_encode_trace *trace = e->trace;
    const gscl_tune tune = e->settings.tune;
    double searched_psnr;
    e->trace = NULL;
    gscl_progress_stage(&e->progress, 1, 1);
    e->settings.tune = GSCL_TUNE_PSNR;
    gscl_result result = encode_once(e, (gscl_size_target){.bytes = (size_t)gscl_scalar_tunables.max_search_bytes - 1});
    e->trace = trace;
    e->trials = 2;
    if (result == GSCL_OK)
        result = gscl_encoder_quality(e, image, GSCL_TARGET_PSNR, &searched_psnr);
    if (result != GSCL_OK || searched_psnr > psnr)
        return result;
    e->settings.tune = tune;
    return take_file(e, file);
}

/* A smooth image that is nearly exact may be better with fewer bytes: small files are searched. */
static gscl_result prefer_searched_file(gscl_encoder *e, const gscl_image *image) {
    encoded_file file;
    double psnr;
    if (!e->may_search_smooth)
        return GSCL_OK;
    GSCL_TRY(gscl_encoder_quality(e, image, GSCL_TARGET_PSNR, &psnr));
    if (psnr < gscl_encode_tunables.min_smooth_psnr)
        return GSCL_OK;
    GSCL_TRY(gscl_coded_image_write(&e->coded, &file.bytes, &file.size));
    const gscl_result result = try_searched_file(e, image, psnr, &file);
    free(file.bytes);
    return result;
}

/* The background alone, which is all there is to encode: a target that is a quality is reached or not. */
static gscl_result keep_background(gscl_encoder *e, const gscl_image *image) {
    if (!gscl_target_is_quality(e->settings.target))
        return GSCL_OK;
    GSCL_TRY(gscl_encoder_quality(e, image, e->settings.target, &e->quality));
    return e->accepts_less || e->quality >= e->settings.target_value ? GSCL_OK : fail_target(e, e->quality);
}

/* Encodes for the target of the settings: encoder->coded. */
static gscl_result encode_to_target(gscl_encoder *e, const gscl_image *image) {
    if (gscl_encode_is_background_only(e))
        return keep_background(e, image); /* as it was prepared */
    if (gscl_target_is_quality(e->settings.target))
        return encode_to_quality(e, image);
    e->may_search_smooth = gscl_encode_may_search_smooth(e, image);
    GSCL_TRY(encode_once(e, e->target));
    GSCL_TRY(prefer_searched_file(e, image));
    return e->settings.target == GSCL_TARGET_SPLATS ? GSCL_OK : prefer_background(e, image);
}

/* Writes encoder->coded as a new file. */
static gscl_result write_file(gscl_encoder *e, encoded_file *file) {
    gscl_forget_effects_without_splats(&e->coded.file.header);
    e->coded.file.bare = e->settings.bare;
    e->coded.file.blocks = e->settings.bare ? NULL : e->blocks;
    gscl_stage(e->context, GSCL_STAGE_WRITE);
    const gscl_result result = e->packets.count > 0
                                   ? gscl_packets_write(&e->coded.file, &e->packets, &file->bytes, &file->size)
                                   : gscl_coded_image_write(&e->coded, &file->bytes, &file->size);
    gscl_stage(e->context, GSCL_STAGE_NONE);
    return result == GSCL_OK
               ? GSCL_OK
               : gscl_fail(e->context, result, "the coded image could not be written: %s", gscl_result_text(result));
}

/* Completes the report, if the caller takes one. */
static gscl_result complete_report(gscl_encoder *e, const gscl_image *image, const encoded_file *file) {
    gscl_encode_trace *trace = e->trace;
    if (!trace)
        return GSCL_OK;
    gscl_encode_report *r = trace->report;
    r->splats = e->coded.file.header.splat_count;
    r->bytes = e->packets.count > 0 ? gscl_packets_bytes(file->bytes, file->size) : file->size;
    r->trials = e->trials ? e->trials : 1;
    r->blend = e->settings.blend;
    r->tune = e->settings.tune;
    r->effect_count = e->effects.decision_count;
    memcpy(r->effects, e->effects.decisions, sizeof r->effects);
    gscl_encode_trace_end(trace, e->context); /* measuring is no part of the encode */
    r->ssimulacra2 = e->settings.target == GSCL_TARGET_SSIMULACRA2 ? e->quality : NAN;
    return gscl_file_quality(e->context, file->bytes, file->size, e->settings.bare, image, GSCL_TARGET_PSNR, &r->psnr);
}

/* The encode from top to bottom.  Each stage leaves its result in the state (session/encoder.h). */
static gscl_result run_stages(gscl_encoder *e, const gscl_image *image, encoded_file *file) {
    gscl_stage(e->context, GSCL_STAGE_PREPARE);
    GSCL_TRY(gscl_encode_prepare(e, image));
    GSCL_TRY(gscl_encode_resolve_target(e));
    gscl_encode_resolve_tune(e);
    GSCL_TRY(gscl_encode_decide_effects(e, image));
    GSCL_TRY(encode_to_target(e, image));
    GSCL_TRY(write_file(e, file));
    GSCL_TRY(complete_report(e, image, file));
    return gscl_progress_end(e->context, &e->progress);
}

static int loss_kind(gscl_loss loss) {
    return loss == GSCL_LOSS_L1        ? GSCL_LOSS_KIND_L1
           : loss == GSCL_LOSS_L1_SSIM ? GSCL_LOSS_KIND_EXTERNAL
                                       : GSCL_LOSS_KIND_L2;
}

/* Sets what stays constant during the encode, and the services. */
static void encoder_begin(gscl_encoder *e, gscl_encode_trace *trace, gscl_encode_report *report) {
    gscl_encode_settings_resolve(&e->settings);
    for (const gscl_block *block = e->settings.blocks; block; block = block->next)
        e->blocks[block->type] = (gsf_bytes){block->data, block->size};
    e->loss_kind = loss_kind(e->settings.loss);
    gscl_progress_begin(&e->progress, &e->settings);
    if (!report)
        return;
    gscl_encode_trace_begin(trace, e->context, report, e->settings.trace);
    e->trace = trace;
}

static void encoder_end(gscl_encoder *e) {
    gscl_source_free(&e->source);
    gscl_coded_image_free(&e->coded);
    gscl_prefetch_end(e->context);
    gscl_stage(e->context, GSCL_STAGE_NONE);
    if (e->trace)
        gscl_encode_trace_end(e->trace, e->context);
}

static gscl_result encode(gscl_context *context, const gscl_image *image, const gscl_encode_settings *settings,
                          uint8_t **bytes, size_t *size, gscl_encode_report *report) {
    if (!bytes || !size)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "there is no place for the bytes, or none for their number");
    GSCL_TRY(gscl_require_encoder(context, "encoding"));
    gscl_encoder e = {.context = context, .quality = NAN};
    gscl_encode_settings_default(&e.settings);
    GSCL_TRY(GSCL_STRUCT_READ(context, gscl_encode_settings, trace, settings, &e.settings));
    if (report)
        GSCL_TRY(GSCL_STRUCT_CHECK(context, gscl_encode_report, trace_count, report));
    GSCL_TRY(gscl_encode_settings_check(context, &e.settings));
    gscl_encode_trace trace = {0};
    gscl_encode_report measured;
    encoded_file file = {0};
    encoder_begin(&e, &trace, report ? &measured : NULL);
    const gscl_result result = run_stages(&e, image, &file);
    encoder_end(&e);
    if (result != GSCL_OK) {
        free(file.bytes);
        return result;
    }
    *bytes = file.bytes;
    *size = file.size;
    if (report)
        gscl_struct_write(report, &measured);
    return GSCL_OK;
}

gscl_result gscl_encode(gscl_context *context, const gscl_image *image, const gscl_encode_settings *settings,
                        uint8_t **bytes, size_t *size, gscl_encode_report *report) {
    if (!context)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_call_begin(context, "gscl_encode");
    return gscl_call_end(context, encode(context, image, settings, bytes, size, report));
}
