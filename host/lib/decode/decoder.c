/* gscl_decoder: a picture that comes piece by piece, and lists of packets. */
#include <gscl/gscl.h>
#include <stdlib.h>
#include <string.h>

#include "decode/coded_image.h"
#include "decode/format_result.h"
#include "decode/output.h"
#include "format/packet.h"
#include "format/repair.h"
#include "runtime/struct_size.h"

/* ---- Lists of packets ---- */

bool gscl_next_packet(const uint8_t *list, size_t size, size_t *position, const uint8_t **packet, size_t *packet_size) {
    gsf_bytes next;
    if (!list || !position || !packet || !packet_size || !gsf_is_packet_list(list, size) ||
        !gsf_next_packet(list, size, position, &next))
        return false;
    *packet = next.data;
    *packet_size = next.size;
    return true;
}

gscl_result gscl_append_packet(uint8_t **list, size_t *size, const uint8_t *packet, size_t packet_size) {
    if (!list || !size || !packet || packet_size == 0 || packet_size > GSF_MAX_PACKET_SIZE ||
        (*list && !gsf_is_packet_list(*list, *size)))
        return GSCL_ERROR_INVALID_ARGUMENT;
    const size_t before = *list ? *size : GSF_PACKET_LIST_START, field = gsf_packet_size_field(packet_size);
    uint8_t *grown = realloc(*list, before + field + packet_size);
    if (!grown)
        return GSCL_ERROR_OUT_OF_MEMORY;
    gsf_put_packet_list_start(grown);
    gsf_put_packet_size(grown + before, packet_size);
    memcpy(grown + before + field, packet, packet_size);
    *list = grown;
    *size = before + field + packet_size;
    return GSCL_OK;
}

gscl_result gscl_packet_probe(const uint8_t *packet, size_t size, gscl_packet_info *info) {
    gsf_header header;
    uint8_t identity;
    uint32_t number;
    if (!packet || !info)
        return GSCL_ERROR_INVALID_ARGUMENT;
    GSCL_TRY(GSCL_STRUCT_CHECK(NULL, gscl_packet_info, repair, info));
    if (gsf_open_repair((gsf_bytes){packet, size}, &identity, &number)) {
        const gscl_packet_info own = {.identity = identity, .number = number, .repair = true};
        gscl_struct_write(info, &own);
        return GSCL_OK;
    }
    GSCL_TRY(gscl_result_of_format(gsf_read_packet_header((gsf_bytes){packet, size}, &identity, &header)));
    const gscl_packet_info own = {.identity = identity,
                                  .number = header.packet,
                                  .count = header.packets,
                                  .width = header.width,
                                  .height = header.height,
                                  .splats = header.splat_count};
    gscl_struct_write(info, &own);
    return GSCL_OK;
}

/* ---- Pictures that come piece by piece ---- */

struct gscl_decoder {
    gscl_decode_settings settings;
    uint8_t *bytes; /* the file so far, or a list of the packets that have come; NULL before the first */
    size_t size;
    bool is_list;
    uint32_t width, height;            /* of the encoded picture, pixels */
    uint32_t splats;                   /* that can be drawn */
    uint32_t identity;                 /* of the picture whose packets come */
    uint32_t count, received;          /* packets with splats, 0 before the first one; all that have come */
    uint32_t drawn;                    /* packets whose splats can be drawn, those that were computed again included */
    bool has_number[GSCL_MAX_PACKETS]; /* the packets that have come */
};

gscl_result gscl_decoder_create(gscl_decoder **decoder, const gscl_decode_settings *settings) {
    if (!decoder)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_decoder *d = calloc(1, sizeof *d);
    if (!d)
        return GSCL_ERROR_OUT_OF_MEMORY;
    gscl_decode_settings_default(&d->settings);
    gscl_result result = GSCL_STRUCT_READ(NULL, gscl_decode_settings, max_pixels, settings, &d->settings);
    if (result == GSCL_OK && !gscl_output_is_possible(&d->settings))
        result = GSCL_ERROR_INVALID_ARGUMENT;
    if (result != GSCL_OK) {
        free(d);
        return result;
    }
    *decoder = d;
    return GSCL_OK;
}

void gscl_decoder_free(gscl_decoder **decoder) {
    if (!decoder || !*decoder)
        return;
    free((*decoder)->bytes);
    free(*decoder);
    *decoder = NULL;
}

/* Reads a list; counts the packets whose splats it gives, and the splats. */
static gscl_result read_list(const uint8_t *list, size_t size, uint32_t *packets, uint32_t *splats) {
    gscl_coded_image coded;
    GSCL_TRY(gscl_coded_image_read(&coded, list, size, false));
    *packets = coded.file.packets_read;
    *splats = coded.file.header.splat_count;
    gscl_coded_image_free(&coded);
    return GSCL_OK;
}

/* Whether a packet is valid by itself. */
static gscl_result check_packet(const uint8_t *packet, size_t size) {
    uint8_t *list = NULL;
    size_t list_size;
    uint32_t packets, splats;
    GSCL_TRY(gscl_append_packet(&list, &list_size, packet, size));
    const gscl_result result = read_list(list, list_size, &packets, &splats);
    free(list);
    return result == GSCL_ERROR_DAMAGED ? GSCL_ERROR_CORRUPT : result;
}

/* Reads the list again, to which a packet was appended. */
static gscl_result renew(gscl_decoder *d, const gscl_packet_info *info) {
    uint32_t drawn, splats;
    if (info->repair && d->count == 0)
        return GSCL_OK; /* there is nothing yet that it could repair */
    GSCL_TRY(read_list(d->bytes, d->size, &drawn, &splats));
    if (drawn <= d->drawn && !info->repair)
        return GSCL_ERROR_OTHER_PICTURE; /* its steps or its background are others, or both are too much work */
    d->drawn = drawn;
    d->splats = splats;
    return GSCL_OK;
}

/* Takes a valid packet, where it belongs to those before it. */
static gscl_result take_packet(gscl_decoder *d, const uint8_t *packet, size_t size, const gscl_packet_info *info) {
    const size_t before = d->size;
    GSCL_TRY(gscl_append_packet(&d->bytes, &d->size, packet, size));
    const gscl_result result = renew(d, info);
    if (result != GSCL_OK) {
        d->size = before;
        if (before == 0) {
            free(d->bytes);
            d->bytes = NULL;
        }
        return result;
    }
    d->is_list = true;
    d->identity = info->identity;
    d->has_number[info->number] = true;
    d->received++;
    if (!info->repair) {
        d->width = info->width;
        d->height = info->height;
        d->count = info->count;
    }
    return GSCL_OK;
}

/* Whether the packet is one of those that have come. */
static bool is_of_picture(const gscl_decoder *d, const gscl_packet_info *info) {
    return d->identity == info->identity &&
           (info->repair || d->count == 0 ||
            (d->count == info->count && d->width == info->width && d->height == info->height));
}

gscl_result gscl_decoder_add_packet(gscl_decoder *d, const uint8_t *packet, size_t size) {
    gscl_packet_info info = {.struct_size = sizeof info};
    if (!d || !packet || (d->size > 0 && !d->is_list))
        return GSCL_ERROR_INVALID_ARGUMENT;
    GSCL_TRY(gscl_packet_probe(packet, size, &info));
    if (d->is_list && !is_of_picture(d, &info))
        return GSCL_ERROR_OTHER_PICTURE;
    if (d->has_number[info.number])
        return GSCL_OK;
    if (!info.repair)
        GSCL_TRY(check_packet(packet, size));
    if (d->count > 0 && d->drawn == d->count) { /* it is there already, computed again, or of no use */
        d->has_number[info.number] = true;
        d->received++;
        return GSCL_OK;
    }
    return take_packet(d, packet, size, &info);
}

gscl_result gscl_decoder_add_bytes(gscl_decoder *d, const uint8_t *bytes, size_t size) {
    if (!d || !bytes || d->is_list || size > SIZE_MAX - d->size)
        return GSCL_ERROR_INVALID_ARGUMENT;
    uint8_t *grown = realloc(d->bytes, d->size + size + 1);
    if (!grown)
        return GSCL_ERROR_OUT_OF_MEMORY;
    memcpy(grown + d->size, bytes, size);
    d->bytes = grown;
    d->size += size;
    return GSCL_OK;
}

/* What has come of a file. */
static gscl_result count_splats(const gscl_decoder *d, gscl_decoder_state *state) {
    gscl_info info = {.struct_size = sizeof info};
    gscl_read_settings settings;
    uint32_t total;
    gscl_read_settings_default(&settings);
    settings.bare = d->settings.bare;
    GSCL_TRY(gscl_probe(d->bytes, d->size, &settings, &info));
    state->width = info.width;
    state->height = info.height;
    return gscl_certain_splats(d->bytes, d->size, &settings, &state->splats, &total);
}

gscl_result gscl_decoder_inspect(const gscl_decoder *d, gscl_decoder_state *state) {
    if (!d || !state)
        return GSCL_ERROR_INVALID_ARGUMENT;
    GSCL_TRY(GSCL_STRUCT_CHECK(NULL, gscl_decoder_state, bytes, state));
    gscl_decoder_state own = {.width = d->width,
                              .height = d->height,
                              .splats = d->splats,
                              .packets = d->count,
                              .drawn = d->drawn,
                              .received = d->received,
                              .bytes = d->size};
    if (!d->bytes)
        return GSCL_ERROR_TRUNCATED;
    if (!d->is_list)
        GSCL_TRY(count_splats(d, &own));
    gscl_struct_write(state, &own);
    return GSCL_OK;
}

gscl_result gscl_decoder_draw(gscl_decoder *d, gscl_context *context, gscl_image *image) {
    if (!d || !context || !image)
        return GSCL_ERROR_INVALID_ARGUMENT;
    if (!d->bytes || (d->is_list && d->drawn == 0))
        return GSCL_ERROR_TRUNCATED;
    gscl_decode_settings settings = d->settings;
    settings.partial = true;
    return gscl_decode(context, d->bytes, d->size, &settings, image);
}
