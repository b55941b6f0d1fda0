#include "encode/settings.h"

#include "format/format.h"

static gscl_result check_packets(gscl_context *context, const gscl_encode_settings *s) {
    if (s->packet_size != 0 && (s->packet_size < GSCL_MIN_PACKET_SIZE || s->packet_size > GSCL_MAX_PACKET_SIZE))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "packets of %u bytes are not in %d..%d", s->packet_size,
                         GSCL_MIN_PACKET_SIZE, GSCL_MAX_PACKET_SIZE);
    if (s->packet_count > GSCL_MAX_PACKETS)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "%u packets are more than %d", s->packet_count,
                         GSCL_MAX_PACKETS);
    if (s->packet_identity > 255 || s->packet_identity == GSF_NO_IDENTITY)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the identity %u is not in 1..255 without %u",
                         s->packet_identity, GSF_NO_IDENTITY);
    if (!(s->packet_loss >= 0 && s->packet_loss <= 0.9))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the loss of packets %g is not in 0..0.9",
                         s->packet_loss);
    return GSCL_OK;
}

/* The values of a target. */
typedef struct target_range {
    const char *unit;
    double least, most;
} target_range;

static gscl_result check_target(gscl_context *context, const gscl_encode_settings *s) {
    static const target_range ranges[] = {[GSCL_TARGET_AUTO] = {"", 0, 0},
                                          [GSCL_TARGET_BPP] = {" bits per pixel", 0, GSCL_MAX_TARGET_BPP},
                                          [GSCL_TARGET_BYTES] = {" bytes", 0, GSCL_MAX_TARGET_BYTES},
                                          [GSCL_TARGET_PSNR] = {" dB", 0, GSCL_MAX_TARGET_PSNR},
                                          [GSCL_TARGET_SPLATS] = {" splats", 0, GSCL_MAX_SPLATS},
                                          [GSCL_TARGET_SSIMULACRA2] = {" of SSIMULACRA 2", GSCL_MIN_SSIMULACRA2, 100},
                                          [GSCL_TARGET_QUALITY] = {" of quality", 0, 100},
                                          [GSCL_TARGET_RATE] = {" bits per pixel", 0, GSCL_MAX_TARGET_BPP}};
    const target_range *range = &ranges[s->target];
    if (s->target_value >= range->least && s->target_value <= range->most)
        return GSCL_OK;
    if (s->target == GSCL_TARGET_AUTO)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "the target value %.10g has no target; choose one, or 0 for GSCL_TARGET_AUTO",
                         s->target_value);
    return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "the target %.10g%s is not in %.0f..%.0f", s->target_value,
                     range->unit, range->least, range->most);
}

static gscl_result check_ranges(gscl_context *context, const gscl_encode_settings *s) {
    if (s->profile > GSCL_PROFILE_PAPER || s->blend > GSCL_BLEND_SUM || s->loss > GSCL_LOSS_L2 ||
        s->tune > GSCL_TUNE_VISUAL || (unsigned)s->target > GSCL_TARGET_RATE)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "a setting is not one of its choices");
    if (s->effort < 0 || s->effort > GSCL_MAX_EFFORT)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "effort %d is not in 0..%d", s->effort, GSCL_MAX_EFFORT);
    GSCL_TRY(check_target(context, s));
    if (s->codebook_size == 1 || s->codebook_size > GSF_MAX_CODEBOOK)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "%u code words are not in 2..%d", s->codebook_size,
                         GSF_MAX_CODEBOOK);
    if (s->step_factor != 0 && !(s->step_factor >= 0.25 && s->step_factor <= 4))
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "%g times the quantiser's steps are not in 0.25..4",
                         s->step_factor);
    return check_packets(context, s);
}

gscl_result gscl_blocks_check(gscl_context *context, const gscl_block *block) {
    unsigned seen = 0;
    for (; block; block = block->next) {
        if ((unsigned)block->type >= GSF_BLOCK_COUNT)
            return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "unknown type %d of a block", (int)block->type);
        if (seen >> block->type & 1)
            return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "two blocks of type %d; a file has at most one",
                             (int)block->type);
        seen |= 1u << block->type;
        if (!block->data || block->size == 0 || block->size > GSCL_MAX_BLOCK_SIZE)
            return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "a block of %zu bytes; it must have 1 to %d",
                             block->size, GSCL_MAX_BLOCK_SIZE);
        if (block->type == GSCL_BLOCK_COLOUR_SPACE && block->size != GSF_COLOUR_SPACE_SIZE)
            return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "a colour space of %zu bytes; it must have %u",
                             block->size, GSF_COLOUR_SPACE_SIZE);
    }
    return GSCL_OK;
}

static const char *contradiction_of_packets(const gscl_encode_settings *s) {
    if (s->packet_size == 0)
        return s->packet_count != 0 || s->packet_identity != 0 || s->packet_loss != 0
                   ? "number, identity and loss of packets need their size"
                   : NULL;
    if (s->profile == GSCL_PROFILE_PAPER)
        return "packets are the default profile's";
    if (s->bare || s->progressive || s->blocks)
        return "packets are not bare, and have no layers and no blocks (profile, metadata)";
    if (s->packet_count != 0 && s->target != GSCL_TARGET_AUTO)
        return "a number of packets is a target by itself";
    if (s->target != GSCL_TARGET_AUTO && s->target != GSCL_TARGET_BYTES && s->target != GSCL_TARGET_BPP &&
        s->target != GSCL_TARGET_RATE)
        return "packets need a target in bytes, or their number";
    return NULL;
}

static const char *contradiction(const gscl_encode_settings *s) {
    const bool paper = s->profile == GSCL_PROFILE_PAPER;
    const bool squared = s->loss == GSCL_LOSS_AUTO || s->loss == GSCL_LOSS_L2;
    if (s->codebook_size != 0 && !paper)
        return "a codebook size needs the paper profile";
    if (s->step_factor != 0 && paper)
        return "quantiser steps are the default profile's";
    if (paper && s->blend != GSCL_BLEND_AUTO && s->blend != GSCL_BLEND_ALPHA)
        return "the paper profile blends by alpha; choose another profile for other blends";
    if (s->progressive && paper)
        return "layers are the default profile's";
    if (s->bare && s->blocks)
        return "a bare file cannot have blocks (profile, metadata)";
    if ((s->tune == GSCL_TUNE_SSIM || s->tune == GSCL_TUNE_VISUAL) && (paper || !squared))
        return "tuning for SSIM or for what people see weights squared errors; it needs the default profile and the "
               "loss L2";
    return NULL;
}

gscl_result gscl_encode_settings_check(gscl_context *context, const gscl_encode_settings *s) {
    GSCL_TRY(check_ranges(context, s));
    GSCL_TRY(gscl_blocks_check(context, s->blocks));
    const char *why = contradiction(s);
    why = why ? why : contradiction_of_packets(s);
    return why ? gscl_fail(context, GSCL_ERROR_CONFLICT, "%s", why) : GSCL_OK;
}

void gscl_encode_settings_resolve(gscl_encode_settings *s) {
    const bool paper = s->profile == GSCL_PROFILE_PAPER;
    if (s->blend == GSCL_BLEND_AUTO)
        s->blend = paper ? GSCL_BLEND_ALPHA : GSCL_BLEND_NORMALIZED;
    if (s->loss == GSCL_LOSS_AUTO)
        s->loss = paper ? GSCL_LOSS_L1_SSIM : GSCL_LOSS_L2;
}
