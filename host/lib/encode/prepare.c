#include "encode/prepare.h"

#include <math.h>

#include "decode/blend.h"
#include "decode/coded_size.h"
#include "decode/quantise.h"
#include "encode/repairs.h"
#include "encode/tunables.h"
#include "format/repair.h"
#include "image/ssimulacra2.h"
#include "runtime/launch.h"
#include "scalar/tunables.h"
#include "session/effects.h"

/* The header of the image, still without effects (gscl_effects_set_header). */
static gsf_header describe_image(const gscl_encoder *e, const gscl_image *image) {
    static const gsf_layout layouts[] = {GSF_GREY, GSF_GREY, GSF_GREY_ALPHA, GSF_RGB, GSF_RGBA};
    const bool paper = e->settings.profile == GSCL_PROFILE_PAPER;
    return (gsf_header){.blend = gscl_blend_to_format(e->settings.blend),
                        .coding = paper ? GSF_CODING_CODEBOOK : GSF_CODING_SCALAR,
                        .layout = layouts[image->channels],
                        .high_bit_depth = e->content.high_bit_depth,
                        .width = image->width,
                        .height = image->height};
}

/* The coded image without splats has one colour, that of the first pixel. */
static void set_background_only(gscl_encoder *e, const gscl_image *image) {
    gsf_coded_image *file = &e->coded.file;
    gscl_pixels first;
    gscl_image_read(image, 0, 0, 1, &first);
    file->bare = true;
    const int colours = e->header.has_chroma ? 3 : 1;
    file->header = e->header;
    for (int k = 0; k < colours; k++)
        file->background[k] = gscl_quantise_background(&file->header, first.colour[k][0]);
    if (file->header.has_alpha)
        file->background[colours] = gscl_quantise_background(&file->header, first.alpha[0]);
}

/* The programs that are the same for all images. */
static void prefetch_programs(gscl_context *context) {
    const gscl_program_request requests[] = {{.kind = GSCL_PROGRAM_IMAGE}, {.kind = GSCL_PROGRAM_BIN}};
    gscl_prefetch(context, requests, sizeof requests / sizeof *requests);
}

gscl_result gscl_encode_prepare(gscl_encoder *e, const gscl_image *image) {
    GSCL_TRY(gscl_image_examine(e->context, image, &e->content));
    GSCL_TRY(gscl_effects_check(e->context, &e->settings, image));
    e->effects = gscl_effects_of_settings(&e->settings, &e->content);
    e->header = describe_image(e, image);
    gscl_effects_set_channels(&e->effects, &e->header);
    set_background_only(e, image);
    const size_t pixels = (size_t)image->width * image->height;
    /* Of so few pixels more than two splats for each are of no use; they only move the others away from their best. */
    const size_t useful_splats = pixels < 6 ? 2 * pixels : pixels / 2 + 8;
    e->max_splats = useful_splats > GSCL_MAX_SPLATS ? GSCL_MAX_SPLATS : useful_splats;
    if (e->content.flat)
        return GSCL_OK;
    prefetch_programs(e->context);
    return gscl_source_create(&e->source, e->context, image, &e->header);
}

/* Bytes of the file around its picture, and those of them that are blocks. */
static size_t container_size(const gscl_encoder *e, size_t *blocks) {
    *blocks = 0;
    if (e->settings.bare || e->settings.packet_size > 0)
        return 0;
    const size_t all = gsf_container_size(e->blocks);
    *blocks = all - gsf_container_size(NULL);
    return all;
}

/* Bytes beyond those that the picture can use: with more of them an encode would be the same. */
static double useful_bytes(const gscl_encoder *e) {
    const struct gscl_encode_tunables *t = &gscl_encode_tunables;
    return t->max_bytes + (double)e->max_splats * t->max_splat_bits / 8;
}

/* The smallest picture has no splats. */
static gscl_result set_budget(gscl_encoder *e, double budget) {
    size_t picture, blocks;
    const size_t container = container_size(e, &blocks);
    GSCL_TRY(gscl_coded_image_size(&e->coded, &picture));
    if (budget < (double)(container + picture) && blocks > 0)
        return gscl_fail(
            e->context, GSCL_ERROR_BUDGET_TOO_SMALL,
            "a budget of %.0f bytes is too small: blocks (profile, metadata) take %zu bytes, and the smallest "
            "file with them has %zu bytes",
            floor(budget), blocks, container + picture);
    if (budget < (double)(container + picture))
        return gscl_fail(e->context, GSCL_ERROR_BUDGET_TOO_SMALL,
                         "a budget of %.0f bytes is too small; the smallest file of this image has %zu bytes",
                         floor(budget), container + picture);
    e->target.bytes = (size_t)fmin(budget - (double)container, useful_bytes(e));
    return GSCL_OK;
}

/* Smaller images have no SSIMULACRA 2. */
static bool has_ssimulacra2(const gsf_header *header) {
    return header->width >= GSCL_SSIMULACRA2_MIN_SIDE && header->height >= GSCL_SSIMULACRA2_MIN_SIDE;
}

/* Replaces the target QUALITY by the measure that it stands for. */
static void resolve_quality(gscl_encoder *e) {
    gscl_encode_settings *s = &e->settings;
    const double quality = s->target_value;
    if (s->target != GSCL_TARGET_QUALITY)
        return;
    e->accepts_less = true;
    if (has_ssimulacra2(&e->header)) {
        s->target = GSCL_TARGET_SSIMULACRA2;
        s->target_value = gscl_quality_score(quality);
    } else {
        s->target = GSCL_TARGET_PSNR;
        s->target_value = 20 + quality / 4;
    }
}

static gscl_result check_measurable(const gscl_encoder *e) {
    const uint32_t width = e->header.width, height = e->header.height;
    if (has_ssimulacra2(&e->header))
        return GSCL_OK;
    return gscl_fail(e->context, GSCL_ERROR_TARGET_UNREACHABLE,
                     "SSIMULACRA 2 cannot be measured of %ux%u pixels, only from %dx%d on; choose another target",
                     width, height, GSCL_SSIMULACRA2_MIN_SIDE, GSCL_SSIMULACRA2_MIN_SIDE);
}

/* Resolves how many packets there are; *budget, in bytes of all of them, becomes that of what they are divided from. */
static gscl_result set_packets(gscl_encoder *e, double *budget) {
    const gscl_encode_settings *s = &e->settings;
    if (s->packet_size == 0)
        return GSCL_OK;
    const double all = s->packet_count > 0 ? s->packet_count : ceil(fmax(*budget, 1) / s->packet_size);
    if (all > GSCL_MAX_PACKETS)
        return gscl_fail(e->context, GSCL_ERROR_CONFLICT, "%.0f bytes are more than %d packets of %u", floor(*budget),
                         GSCL_MAX_PACKETS, s->packet_size);
    const double size = s->packet_count > 0 ? s->packet_size : floor(*budget / all);
    const uint32_t repairs = gscl_choose_repairs((uint32_t)all, s->packet_loss);
    const size_t longer = GSF_REPAIR_FRAME - 1; /* bytes by which a repair packet is longer than others */
    const size_t limit = (size_t)size - (repairs > 0 ? longer : 0);
    const double slack = all > 1 ? gscl_encode_tunables.packet_slack : 0;
    e->packets = (gscl_packet_target){(uint32_t)all - repairs, repairs, limit, (uint8_t)s->packet_identity};
    e->coded.packets = e->packets.count;
    *budget = e->packets.count * ((double)limit - slack);
    return GSCL_OK;
}

gscl_result gscl_encode_resolve_target(gscl_encoder *e) {
    const struct gscl_encode_tunables *t = &gscl_encode_tunables;
    resolve_quality(e);
    const double pixels = (double)e->header.width * e->header.height, value = e->settings.target_value;
    double budget = 0;
    size_t blocks;
    if (e->settings.target == GSCL_TARGET_SSIMULACRA2)
        GSCL_TRY(check_measurable(e));
    switch (e->settings.target) {
    case GSCL_TARGET_SPLATS:
        e->target.splats = (size_t)value;
        return GSCL_OK;
    case GSCL_TARGET_QUALITY:
    case GSCL_TARGET_SSIMULACRA2:
    case GSCL_TARGET_PSNR:
        e->target.bytes = (size_t)(t->auto_bpp / 8 * e->header.width * e->header.height);
        return GSCL_OK;
    case GSCL_TARGET_AUTO:
    case GSCL_TARGET_RATE:
        container_size(e, &blocks);
        budget = fmax((e->settings.target == GSCL_TARGET_RATE ? value : t->auto_bpp) * pixels / 8, t->auto_bytes) +
                 (double)blocks;
        break;
    case GSCL_TARGET_BYTES:
        budget = value;
        break;
    case GSCL_TARGET_BPP:
        budget = value * pixels / 8;
        break;
    }
    GSCL_TRY(set_packets(e, &budget));
    return set_budget(e, budget);
}

/* Whether the visual loss is worth it: its weights exist, and what it takes in time and memory shows. */
static bool is_visual(const gscl_encoder *e) {
    const gscl_encode_settings *s = &e->settings;
    const bool has_weights = s->profile == GSCL_PROFILE_DEFAULT && s->loss == GSCL_LOSS_L2;
    const bool is_large = (uint64_t)e->header.width * e->header.height > GSCL_MAX_VISUAL_PIXELS;
    const bool has_bytes = s->target != GSCL_TARGET_SPLATS && !gscl_target_is_quality(s->target);
    const bool is_tiny = has_bytes && e->target.bytes < (size_t)gscl_encode_tunables.min_visual_bytes;
    return has_weights && !is_large && !is_tiny && !e->header.has_alpha && s->target != GSCL_TARGET_PSNR;
}

void gscl_encode_resolve_tune(gscl_encoder *e) {
    if (e->settings.tune == GSCL_TUNE_AUTO)
        e->settings.tune = is_visual(e) ? GSCL_TUNE_VISUAL : GSCL_TUNE_PSNR;
}

bool gscl_encode_may_search_smooth(const gscl_encoder *e, const gscl_image *image) {
    const gscl_encode_settings *s = &e->settings;
    return s->profile == GSCL_PROFILE_DEFAULT && s->loss == GSCL_LOSS_L2 && !s->progressive &&
           gscl_effort_presets[s->effort].searches > 0 &&
           e->target.bytes >= (size_t)gscl_scalar_tunables.max_search_bytes &&
           (double)image->width * image->height <= gscl_encode_tunables.max_smooth_pixels;
}

bool gscl_encode_is_background_only(const gscl_encoder *e) {
    return e->content.flat || (e->settings.target == GSCL_TARGET_SPLATS && e->target.splats == 0);
}
