/* gscl_pack: the stages, from the field to the file. */
#include <gscl/gscl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "decode/format_result.h"
#include "host/system/clock.h"
#include "image/metrics.h"
#include "pack/check_field.h"
#include "pack/field_rendering.h"
#include "pack/field_steps.h"
#include "pack/pack_state.h"
#include "pack/pack_target.h"
#include "pack/stored_splats.h"
#include "runtime/elementary.h"
#include "runtime/launch.h"
#include "runtime/struct_size.h"
#include "runtime/timing.h"

/* A file in memory. */
typedef struct packed_file {
    uint8_t *bytes;
    size_t size;
} packed_file;

static gscl_result psnr_of(gscl_packing *p, const gscl_image *a, const gscl_image *b, double *psnr) {
    gscl_comparison comparison;
    const gscl_result result = gscl_compare_samples(a, b, &comparison);
    if (result == GSCL_OK)
        *psnr = comparison.psnr;
    return result == GSCL_ERROR_OUT_OF_MEMORY ? gscl_fail_memory(p->context) : result;
}

/* ---- Drawing ---- */

static gscl_result draw_field(gscl_packing *p) {
    gscl_splat_list given;
    GSCL_TRY(gscl_pack_given_splats(p, &given));
    const gscl_result result = gscl_pack_render(p, &given, &p->rendering);
    free(given.params);
    return result;
}

static gscl_result check_changes(gscl_packing *p) {
    const double most = -20 * gscl_log10(fmax(p->settings.tolerance, 1e-10));
    gscl_image changed = {0};
    gscl_result result = gscl_pack_render(p, &p->stored, &changed);
    if (result == GSCL_OK)
        result = psnr_of(p, &p->rendering, &changed, &p->report->changed_psnr);
    free(changed.pixels);
    GSCL_TRY(result);
    if (p->report->changed_psnr >= most)
        return GSCL_OK;
    if (isnan(p->report->changed_psnr))
        return gscl_fail(p->context, GSCL_ERROR_FIELD, "splat %zu: %s", p->worst.number, p->worst.what);
    return gscl_fail(
        p->context, GSCL_ERROR_FIELD,
        "splat %zu: %s; with the nearest for this and %llu others the picture has %.1f dB, the tolerance %.1f",
        p->worst.number, p->worst.what, (unsigned long long)(p->report->changed - 1), p->report->changed_psnr, most);
}

/* Draws the field where somebody needs its picture, and compares the stored splats with it. */
static gscl_result draw(gscl_packing *p, bool has_report) {
    const bool is_reference = !p->settings.reference && (has_report || gscl_pack_needs_reference(p));
    p->reference = p->settings.reference ? p->settings.reference : &p->rendering;
    if (is_reference || p->report->changed > 0 || (has_report && p->settings.reference))
        GSCL_TRY(draw_field(p));
    if (p->report->changed > 0)
        GSCL_TRY(check_changes(p));
    if (has_report && p->settings.reference)
        return psnr_of(p, p->reference, &p->rendering, &p->report->field_psnr);
    return GSCL_OK;
}

/* Splats of the blend alpha have the order of a file, which a field of one has. */
static gscl_result take_order(gscl_packing *p) {
    const gsf_steps finest = gscl_pack_steps(p, 0);
    return p->header.blend == GSF_BLEND_ALPHA && !p->has_steps && !p->layers ? gscl_pack_take_order(p, &finest)
                                                                             : GSCL_OK;
}

/* ---- The file ---- */

static gscl_result write_file(gscl_packing *p, packed_file *file) {
    p->coded.file.bare = p->settings.bare;
    p->coded.file.blocks = p->settings.bare ? NULL : p->blocks;
    gscl_stage(p->context, GSCL_STAGE_WRITE);
    const gscl_result result = gscl_coded_image_write(&p->coded, &file->bytes, &file->size);
    if (result == GSCL_OK || result == GSCL_ERROR_OUT_OF_MEMORY)
        return result == GSCL_OK ? GSCL_OK : gscl_fail_memory(p->context);
    return gscl_fail(p->context, GSCL_ERROR_FIELD,
                     "the splats together cover more pixels than the format allows, 256 times those of the image");
}

/* What only makes the file is freed, so that a decode besides takes no more memory. */
static gscl_result complete_report(gscl_packing *p, const packed_file *file) {
    p->report->bytes = file->size;
    p->report->splats = p->coded.file.header.splat_count;
    free(p->stored.params);
    p->stored.params = NULL;
    gscl_coded_image_free(&p->coded);
    return gscl_file_quality(p->context, file->bytes, file->size, p->settings.bare, p->reference, GSCL_TARGET_PSNR,
                             &p->report->psnr);
}

/* Steps of a file count as long as nobody has changed its splats. */
static void describe(gscl_packing *p) {
    p->has_steps = p->field->has_steps;
    gscl_pack_describe(p);
    if (!p->has_steps || gscl_pack_has_codes(p))
        return;
    p->has_steps = false;
    gscl_pack_describe(p);
}

static gscl_result run_stages(gscl_packing *p, bool has_report, packed_file *file) {
    gscl_stage(p->context, GSCL_STAGE_PREPARE);
    GSCL_TRY(gscl_field_check(p));
    GSCL_TRY(gscl_pack_settings_check(p));
    for (const gscl_block *block = p->settings.blocks; block; block = block->next)
        p->blocks[block->type] = (gsf_bytes){block->data, block->size};
    describe(p);
    GSCL_TRY(gscl_pack_store_splats(p));
    GSCL_TRY(take_order(p));
    GSCL_TRY(draw(p, has_report));
    GSCL_TRY(gscl_pack_choose_codes(p));
    GSCL_TRY(write_file(p, file));
    return has_report ? complete_report(p, file) : GSCL_OK;
}

static void free_packing(gscl_packing *p) {
    free(p->stored.params);
    free(p->layers);
    free(p->rendering.pixels);
    gscl_coded_image_free(&p->coded);
    gscl_prefetch_end(p->context);
    gscl_stage(p->context, GSCL_STAGE_NONE);
}

static gscl_result pack(gscl_context *context, const gscl_field *field, const gscl_pack_settings *settings,
                        uint8_t **bytes, size_t *size, gscl_pack_report *report) {
    const double start = gscl_now();
    if (!field || !bytes || !size)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "there is no field, no place for the bytes, or none for their number");
    GSCL_TRY(gscl_require_encoder(context, "packing"));
    gscl_pack_report own = {.struct_size = sizeof own,
                            .changed_psnr = INFINITY,
                            .field_psnr = INFINITY,
                            .position_error = NAN,
                            .axis_error = NAN,
                            .colour_error = NAN};
    gscl_packing p = {.context = context, .field = field, .report = &own};
    gscl_pack_settings_default(&p.settings);
    GSCL_TRY(gscl_struct_check(context, "gscl_field", field, sizeof *field, sizeof *field));
    GSCL_TRY(
        gscl_struct_read(context, "gscl_pack_settings", settings, sizeof p.settings, &p.settings, sizeof p.settings));
    if (report)
        GSCL_TRY(gscl_struct_check(context, "gscl_pack_report", report, sizeof own, sizeof own));
    packed_file file = {0};
    const gscl_result result = run_stages(&p, report != NULL, &file);
    free_packing(&p);
    if (result != GSCL_OK) {
        free(file.bytes);
        return result;
    }
    *bytes = file.bytes;
    *size = file.size;
    own.seconds = gscl_now() - start;
    if (report)
        gscl_struct_write(report, &own);
    return GSCL_OK;
}

gscl_result gscl_pack(gscl_context *context, const gscl_field *field, const gscl_pack_settings *settings,
                      uint8_t **bytes, size_t *size, gscl_pack_report *report) {
    if (!context)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_call_begin(context, "gscl_pack");
    return gscl_call_end(context, pack(context, field, settings, bytes, size, report));
}
