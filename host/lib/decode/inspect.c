/* Public functions that inspect files without a device. */
#include <gscl/gscl.h>
#include <stdlib.h>
#include <string.h>

#include "decode/blend.h"
#include "decode/coded_image.h"
#include "decode/format_result.h"
#include "decode/frame.h"
#include "format/packet.h"
#include "runtime/struct_size.h"

static const struct {
    gscl_effect effect;
    const char *name;
} effects[] = {
    {GSCL_EFFECT_CHROMA, "chroma"},         {GSCL_EFFECT_ALPHA_CHANNEL, "alpha-channel"},
    {GSCL_EFFECT_OPACITY, "opacity"},       {GSCL_EFFECT_ROTATION, "rotation"},
    {GSCL_EFFECT_ANISOTROPY, "anisotropy"}, {GSCL_EFFECT_CODEBOOKS, "codebooks"},
    {GSCL_EFFECT_TEXTURE, "texture"},
};

const char *gscl_effect_name(gscl_effect effect) {
    for (size_t i = 0; i < sizeof effects / sizeof effects[0]; i++)
        if (effects[i].effect == effect)
            return effects[i].name;
    return NULL;
}

const char *gscl_effect_reason_name(gscl_effect_reason reason) {
    static const char *const names[] = {"requested", "content", "profile", "trial", "passes"};
    return (size_t)reason < sizeof names / sizeof names[0] ? names[reason] : NULL;
}

static const char *const stream_names[GSF_STREAM_COUNT] = {
    [GSF_STREAM_CONTAINER] = "container",
    [GSF_STREAM_BLOCKS] = "blocks",
    [GSF_STREAM_HEADER] = "header",
    [GSF_STREAM_SIDE] = "side",
    [GSF_STREAM_CODEBOOK] = "codebook",
    [GSF_STREAM_POSITION] = "position",
    [GSF_STREAM_SCALE] = "scale",
    [GSF_STREAM_ANGLE] = "angle",
    [GSF_STREAM_LUMA] = "luma",
    [GSF_STREAM_CHROMA] = "chroma",
    [GSF_STREAM_ALPHA] = "alpha",
    [GSF_STREAM_OPACITY] = "opacity",
    [GSF_STREAM_TEXTURE] = "texture",
    [GSF_STREAM_SHAPE_INDEX] = "shape-index",
    [GSF_STREAM_COLOUR_INDEX] = "colour-index",
};

static void describe_header(const gsf_header *header, size_t size, uint32_t packets, gscl_info *info) {
    *info = (gscl_info){.struct_size = sizeof *info};
    info->format_version = GSF_VERSION;
    info->width = header->width;
    info->height = header->height;
    info->channels = gscl_coded_image_channels(header);
    info->sample = header->high_bit_depth ? GSCL_SAMPLE_U16 : GSCL_SAMPLE_U8;
    info->profile = header->coding == GSF_CODING_CODEBOOK ? GSCL_PROFILE_PAPER : GSCL_PROFILE_DEFAULT;
    info->blend = gscl_blend_from_format(header->blend);
    info->splats = header->splat_count;
    info->layers = header->enhancement_layers + 1u;
    info->packets = packets;
    info->bytes = size;
    info->pixels = (uint64_t)header->width * header->height;
    info->work = header->splat_count * info->pixels;
    info->effects =
        (header->has_chroma ? GSCL_EFFECT_CHROMA : 0u) | (header->has_alpha ? GSCL_EFFECT_ALPHA_CHANNEL : 0u) |
        (header->has_opacity ? GSCL_EFFECT_OPACITY : 0u) | (header->has_rotation ? GSCL_EFFECT_ROTATION : 0u) |
        (header->has_anisotropy ? GSCL_EFFECT_ANISOTROPY : 0u) | (header->has_texture ? GSCL_EFFECT_TEXTURE : 0u) |
        (header->coding == GSF_CODING_CODEBOOK ? GSCL_EFFECT_CODEBOOKS : 0u);
}

/* Lists the streams in use.  The side information also takes the bits of the coder's rounding and last bytes, so
 * that all bits add up to the file. */
static void list_streams(const uint64_t *stream_bits256, size_t size, gscl_info *info) {
    double total = 0;
    size_t side = SIZE_MAX;
    for (int i = 0; i < GSF_STREAM_COUNT; i++) {
        if (stream_bits256[i] == 0 && i != GSF_STREAM_SIDE)
            continue;
        if (i == GSF_STREAM_SIDE)
            side = info->stream_count;
        double bits = stream_bits256[i] / 256.0;
        info->streams[info->stream_count++] = (gscl_stream_bits){stream_names[i], bits};
        total += bits;
    }
    if (side != SIZE_MAX)
        info->streams[side].bits += 8.0 * (double)size - total;
}

void gscl_read_settings_init(gscl_read_settings *settings, size_t struct_size) {
    const gscl_read_settings defaults = {.bare = false};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}

/* The settings of the caller, or the defaults. */
static gscl_result read_settings(const gscl_read_settings *settings, gscl_read_settings *own) {
    gscl_read_settings_default(own);
    return gscl_struct_read(NULL, "gscl_read_settings", settings, sizeof *own, own, sizeof *own);
}

gscl_result gscl_certain_splats(const uint8_t *bytes, size_t size, const gscl_read_settings *settings,
                                uint32_t *certain, uint32_t *total) {
    if (!bytes || !certain || !total)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_read_settings s;
    GSCL_TRY(read_settings(settings, &s));
    gscl_coded_image coded;
    GSCL_TRY(gscl_coded_image_read_prefix(&coded, bytes, size, s.bare, total));
    *certain = coded.file.header.splat_count;
    gscl_coded_image_free(&coded);
    return GSCL_OK;
}

gscl_result gscl_probe(const uint8_t *bytes, size_t size, const gscl_read_settings *settings, gscl_info *info) {
    if (!bytes || !info)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_read_settings s;
    GSCL_TRY(read_settings(settings, &s));
    GSCL_TRY(GSCL_STRUCT_CHECK(NULL, gscl_info, pixels, info));
    gsf_header header;
    GSCL_TRY(gscl_result_of_format(gsf_read_header(bytes, size, s.bare, &header)));
    gscl_info own;
    describe_header(&header, size, 0, &own);
    gscl_struct_write(info, &own);
    return GSCL_OK;
}

gscl_result gscl_inspect(const uint8_t *bytes, size_t size, const gscl_read_settings *settings, gscl_info *info) {
    if (!bytes || !info)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_read_settings s;
    GSCL_TRY(read_settings(settings, &s));
    GSCL_TRY(GSCL_STRUCT_CHECK(NULL, gscl_info, pixels, info));
    gscl_coded_image coded;
    gscl_info own;
    uint64_t stream_bits256[GSF_STREAM_COUNT];
    GSCL_TRY(gscl_coded_image_read_counted(&coded, bytes, size, s.bare, stream_bits256));
    describe_header(&coded.file.header, size, coded.file.packets_read, &own);
    if (coded.file.header.coding == GSF_CODING_CODEBOOK && coded.file.header.splat_count > 0) {
        own.shape_words = coded.file.codebooks.shape_count;
        own.colour_words = coded.file.codebooks.colour_count;
    }
    list_streams(stream_bits256, size, &own);
    const gscl_frame whole = {.full_width = own.width,
                              .full_height = own.height,
                              .width = own.width,
                              .height = own.height,
                              .scale_x = 1,
                              .scale_y = 1};
    own.work = gscl_frame_work(&coded.file, &whole);
    gscl_struct_write(info, &own);
    gscl_coded_image_free(&coded);
    return GSCL_OK;
}

gscl_result gscl_find_block(const void *file, size_t size, gscl_block_type type, const void **data, size_t *data_size) {
    if (!file || !data || !data_size || (unsigned)type >= GSF_BLOCK_COUNT)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gsf_container container;
    if (gsf_is_packet_list(file, size)) {
        *data = NULL;
        *data_size = 0;
        return GSCL_OK;
    }
    GSCL_TRY(gscl_result_of_format(gsf_open_container(file, size, &container)));
    if (!container.is_intact)
        return GSCL_ERROR_DAMAGED;
    *data = container.blocks[type].data;
    *data_size = container.blocks[type].size;
    return GSCL_OK;
}
