#include "pack/pack_target.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "format/container.h"
#include "image/metrics.h"
#include "pack/field_steps.h"
#include "pack/tunables.h"
#include "runtime/elementary.h"
#include "runtime/stage_clock.h"
#include "scalar/encode_scalar.h"
#include "scalar/tunables.h"
#include "session/encoder.h"

static const struct gscl_pack_tunables *const tunables = &gscl_pack_tunables;

/* In blend alpha a splat changes all others under it, which passes do not follow. */
static bool has_passes(const gscl_packing *p) {
    return p->settings.passes && p->settings.target != GSCL_TARGET_AUTO && p->header.blend != GSF_BLEND_ALPHA &&
           p->stored.count > 0;
}

bool gscl_pack_needs_reference(const gscl_packing *p) {
    return p->settings.target == GSCL_TARGET_PSNR || has_passes(p);
}

/* PSNR of packing->coded as its decoder draws it. */
static gscl_result measure_psnr(gscl_packing *p, double *psnr) {
    return gscl_coded_quality(p->context, &p->coded, p->reference, GSCL_TARGET_PSNR, psnr);
}

/* ---- Bytes ---- */

static size_t container_size(const gscl_packing *p) {
    return p->settings.bare ? 0 : gsf_container_size(p->blocks);
}

static gscl_result fail_budget(gscl_packing *p, double budget) {
    int set;
    size_t smallest;
    if (has_passes(p))
        return gscl_fail(p->context, GSCL_ERROR_BUDGET_TOO_SMALL, "a budget of %.0f bytes is too small for this field",
                         floor(budget));
    GSCL_TRY(gscl_pack_find_steps(p, 0, &set, &smallest));
    return gscl_fail(
        p->context, GSCL_ERROR_BUDGET_TOO_SMALL,
        "a budget of %.0f bytes is too small; the smallest file of this field without passes has %zu bytes",
        floor(budget), smallest + container_size(p));
}

/* The field in the finest steps with which it has at most this many bytes. */
static gscl_result quantise_within(gscl_packing *p, double bytes) {
    int set;
    size_t size;
    GSCL_TRY(gscl_pack_find_steps(p, bytes, &set, &size));
    if (set == gscl_pack_step_sets(p))
        return fail_budget(p, bytes + (double)container_size(p));
    const gsf_steps steps = gscl_pack_steps(p, set);
    return gscl_pack_quantise_measured(p, &steps, &size);
}

/* ---- Passes ---- */

static void set_effects(gscl_encoder *e, const gsf_header *header) {
    const struct {
        bool is_on;
        gscl_effect effect;
    } effects[] = {{header->has_chroma, GSCL_EFFECT_CHROMA},         {header->has_alpha, GSCL_EFFECT_ALPHA_CHANNEL},
                   {header->has_opacity, GSCL_EFFECT_OPACITY},       {header->has_rotation, GSCL_EFFECT_ROTATION},
                   {header->has_anisotropy, GSCL_EFFECT_ANISOTROPY}, {header->has_texture, GSCL_EFFECT_TEXTURE}};
    for (size_t i = 0; i < sizeof effects / sizeof *effects; i++)
        *(effects[i].is_on ? &e->effects.on : &e->effects.off) |= effects[i].effect;
}

/* An encoder whose source is the reference, and whose splats are those of the packing. */
static gscl_result begin_encoder(gscl_packing *p, gscl_encoder *e) {
    *e = (gscl_encoder){.context = p->context,
                        .loss_kind = GSCL_LOSS_KIND_L2,
                        .content = {.high_bit_depth = p->header.high_bit_depth},
                        .max_splats = p->stored.count,
                        .quality = NAN,
                        .header = p->header};
    gscl_encode_settings_default(&e->settings);
    e->settings.blend = p->field->blend;
    e->settings.loss = GSCL_LOSS_L2;
    e->settings.tune = GSCL_TUNE_PSNR;
    e->settings.target = GSCL_TARGET_BYTES;
    e->settings.effort = p->settings.refine > GSCL_DEFAULT_EFFORT ? p->settings.refine : GSCL_DEFAULT_EFFORT;
    e->settings.progress = p->settings.progress;
    e->settings.progress_opaque = p->settings.progress_opaque;
    set_effects(e, &p->header);
    gscl_progress_begin(&e->progress, &e->settings);
    gscl_stage(p->context, GSCL_STAGE_PREPARE);
    return gscl_source_create(&e->source, p->context, p->reference, &p->header);
}

static int refining_steps(const gscl_packing *p) {
    return p->settings.refine > 0 ? gscl_effort_presets[p->settings.refine].steps : 0;
}

/* packing->coded becomes a picture of at most this many bytes, whose codes passes have chosen.  They begin with steps in which
 * the field has somewhat more bytes. */
static gscl_result pass_within(gscl_packing *p, gscl_encoder *e, double bytes, double surplus) {
    int set;
    size_t size;
    GSCL_TRY(gscl_pack_find_steps(p, bytes * surplus, &set, &size));
    const gsf_steps steps = gscl_pack_steps(p, set < gscl_pack_step_sets(p) ? set : set - 1);
    GSCL_TRY(gscl_pack_quantise(p, &steps, &size));
    e->coded = p->coded;
    const gscl_result result = gscl_encode_given(e, (size_t)bytes, refining_steps(p));
    p->coded = e->coded;
    e->coded = (gscl_coded_image){0};
    gscl_forget_effects_without_splats(&p->coded.file.header); /* of a field that has nothing of the reference */
    return result;
}

/* A picture that was tried. */
typedef struct tried_file {
    uint8_t *bytes; /* of the picture; NULL: none was */
    size_t size;
    double psnr;
} tried_file;

/* Takes packing->coded, of this PSNR, in place of another. */
static gscl_result keep_file(gscl_packing *p, double psnr, tried_file *kept) {
    free(kept->bytes);
    *kept = (tried_file){.psnr = psnr};
    return gscl_coded_image_write(&p->coded, &kept->bytes, &kept->size);
}

static gscl_result keep_better(gscl_packing *p, tried_file *best) {
    double psnr;
    GSCL_TRY(measure_psnr(p, &psnr));
    return best->bytes && psnr <= best->psnr ? GSCL_OK : keep_file(p, psnr, best);
}

/* packing->coded becomes what this file holds. */
static gscl_result take_file(gscl_packing *p, const tried_file *best) {
    gscl_coded_image_free(&p->coded);
    p->report->position_error = p->report->axis_error = p->report->colour_error = NAN;
    return gscl_coded_image_read(&p->coded, best->bytes, best->size, true);
}

static gscl_result try_surpluses(gscl_packing *p, gscl_encoder *e, double bytes, tried_file *best) {
    const int count = (int)(sizeof tunables->surpluses / sizeof *tunables->surpluses);
    for (int i = 0; i < count; i++) {
        gscl_progress_stage(&e->progress, (double)i / count, (i + 1.0) / count);
        GSCL_TRY(pass_within(p, e, bytes, tunables->surpluses[i]));
        GSCL_TRY(keep_better(p, best));
    }
    return GSCL_OK;
}

static gscl_result choose_within(gscl_packing *p, double budget) {
    const double bytes = budget - (double)container_size(p);
    gscl_encoder e;
    tried_file best = {0};
    if (!has_passes(p))
        return quantise_within(p, bytes);
    gscl_result result = begin_encoder(p, &e);
    if (result == GSCL_OK)
        result = try_surpluses(p, &e, bytes, &best);
    gscl_source_free(&e.source);
    if (result == GSCL_OK)
        result = (double)best.size <= bytes ? take_file(p, &best) : fail_budget(p, budget);
    free(best.bytes);
    return result;
}

/* ---- PSNR ---- */

static gscl_result fail_target(gscl_packing *p, double best) {
    return gscl_fail(p->context, GSCL_ERROR_TARGET_UNREACHABLE, "%.2f dB cannot be reached; the best found is %.2f dB",
                     p->settings.target_value, best);
}

/* A field without passes. */
typedef struct plain_file {
    int set; /* of steps: the coarsest that reaches the PSNR, or the finest where none does */
    size_t size;
    double best_psnr; /* of all sets that were tried */
} plain_file;

static gscl_result find_steps_for_psnr(gscl_packing *p, double psnr, plain_file *plain) {
    int low = -1, high = gscl_pack_step_sets(p); /* reaches it; does not */
    double reached;
    plain->best_psnr = -INFINITY;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        const gsf_steps steps = gscl_pack_steps(p, middle);
        GSCL_TRY(gscl_pack_quantise(p, &steps, &plain->size));
        GSCL_TRY(measure_psnr(p, &reached));
        *(reached >= psnr ? &low : &high) = middle;
        plain->best_psnr = fmax(plain->best_psnr, reached);
    }
    plain->set = low < 0 ? 0 : low;
    return GSCL_OK;
}

/* packing->coded becomes the field in these steps. */
static gscl_result take_plain(gscl_packing *p, plain_file *plain) {
    const gsf_steps steps = gscl_pack_steps(p, plain->set);
    return gscl_pack_quantise_measured(p, &steps, &plain->size);
}

/* The search for the fewest bytes with which passes reach the PSNR. */
typedef struct size_search {
    double low, low_psnr;   /* bytes that are too few; 0: none were yet */
    double high, high_psnr; /* bytes that are enough: at first those without passes */
    tried_file best;        /* the file of `high`; none: it is the one without passes */
} size_search;

/* The next size: on the line of dB over the logarithm of bytes between the two. */
static double next_size(const size_search *s, double psnr) {
    const double dB_per_doubling = 3;
    if (s->low == 0)
        return s->high * gscl_exp2(fmin(psnr - s->high_psnr, -0.02) / dB_per_doubling);
    const double share = (psnr + tunables->psnr_excess / 2 - s->low_psnr) / (s->high_psnr - s->low_psnr);
    return s->low * gscl_pow(s->high / s->low, fmin(fmax(share, 0.2), 0.8));
}

static gscl_result take_trial(gscl_packing *p, size_search *s, double bytes, double psnr) {
    double reached;
    GSCL_TRY(measure_psnr(p, &reached));
    gscl_log(p->context, GSCL_LOG_INFO, "%.0f bytes with passes: %.3f dB", bytes, reached);
    if (reached < psnr) {
        s->low = bytes;
        s->low_psnr = reached;
        return GSCL_OK;
    }
    GSCL_TRY(keep_file(p, reached, &s->best));
    s->high = (double)s->best.size;
    s->high_psnr = reached;
    return GSCL_OK;
}

/* Files with passes of different sizes, from that of the file without passes on, which has `size` bytes. */
static gscl_result search_size(gscl_packing *p, gscl_encoder *e, double psnr, double size, size_search *s) {
    double bytes = tunables->first_share * size;
    s->high = size;
    s->high_psnr = psnr + tunables->psnr_excess; /* about */
    for (int trial = 0; trial < tunables->max_trials; trial++) {
        gscl_progress_stage(&e->progress, (double)trial / tunables->max_trials, (trial + 1.0) / tunables->max_trials);
        GSCL_TRY(pass_within(p, e, bytes, tunables->surpluses[0]));
        GSCL_TRY(take_trial(p, s, bytes, psnr));
        if (s->best.bytes && s->high_psnr < psnr + tunables->psnr_excess)
            break;
        bytes = next_size(s, psnr);
    }
    return GSCL_OK;
}

static gscl_result pass_for_psnr(gscl_packing *p, double psnr, plain_file *plain) {
    const bool is_reached = plain->best_psnr >= psnr;
    gscl_encoder e;
    size_search search = {0};
    gscl_result result = begin_encoder(p, &e);
    if (result == GSCL_OK)
        result = search_size(p, &e, psnr, (is_reached ? 1 : tunables->unreached_share) * (double)plain->size, &search);
    gscl_source_free(&e.source);
    if (result == GSCL_OK && search.best.bytes)
        result = take_file(p, &search.best);
    else if (result == GSCL_OK)
        result = is_reached ? take_plain(p, plain) : fail_target(p, fmax(plain->best_psnr, search.low_psnr));
    free(search.best.bytes);
    return result;
}

static gscl_result choose_for_psnr(gscl_packing *p, double psnr) {
    plain_file plain;
    GSCL_TRY(find_steps_for_psnr(p, psnr, &plain));
    GSCL_TRY(take_plain(p, &plain));
    if (has_passes(p))
        return pass_for_psnr(p, psnr, &plain);
    return plain.best_psnr < psnr ? fail_target(p, plain.best_psnr) : GSCL_OK;
}

/* ---- All targets ---- */

gscl_result gscl_pack_choose_codes(gscl_packing *p) {
    const gscl_pack_settings *s = &p->settings;
    const gsf_steps finest = gscl_pack_steps(p, 0);
    const double pixels = (double)p->header.width * p->header.height;
    size_t size;
    switch (s->target) {
    case GSCL_TARGET_BYTES:
        return choose_within(p, s->target_value);
    case GSCL_TARGET_BPP:
        return choose_within(p, s->target_value * pixels / 8);
    case GSCL_TARGET_PSNR:
        return choose_for_psnr(p, s->target_value);
    default:
        return gscl_pack_quantise_measured(p, &finest, &size);
    }
}
