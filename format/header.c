#include "format/header.h"

#include <string.h>

#include "format/quantiser.h"

unsigned gsf_channel_count(const gsf_header *header) {
    return (header->has_chroma ? 3u : 1u) + (header->has_alpha ? 1u : 0u);
}

static bool has_colour(gsf_layout layout) {
    return layout == GSF_RGB || layout == GSF_RGBA;
}

static bool has_transparency(gsf_layout layout) {
    return layout == GSF_GREY_ALPHA || layout == GSF_RGBA;
}

static bool packet_is_valid(const gsf_header *header) {
    if (header->packets == 0)
        return header->packet == 0;
    return header->packets <= GSF_MAX_PACKETS && header->packet < header->packets &&
           header->coding == GSF_CODING_SCALAR && header->enhancement_layers == 0;
}

bool gsf_header_is_valid(const gsf_header *header) {
    return (unsigned)header->blend <= GSF_BLEND_SUM && (unsigned)header->coding <= GSF_CODING_CODEBOOK &&
           (unsigned)header->layout <= GSF_RGBA && (has_colour(header->layout) || !header->has_chroma) &&
           (has_transparency(header->layout) || !header->has_alpha) &&
           (header->has_anisotropy || !header->has_rotation) &&
           (header->coding == GSF_CODING_SCALAR || (!header->has_texture && header->enhancement_layers == 0)) &&
           header->enhancement_layers < GSF_MAX_LAYERS && header->width >= 1 && header->width <= GSF_MAX_DIMENSION &&
           header->height >= 1 && header->height <= GSF_MAX_DIMENSION && header->splat_count <= GSF_MAX_SPLATS &&
           packet_is_valid(header);
}

/* ---- Symbols of fixed probabilities ---- */

#define LENGTH(array) (sizeof(array) / sizeof *(array))

/* Codes an index of frequencies that are constant. */
static uint32_t code_fixed(gsf_coder *coder, uint32_t value, const uint16_t *freq, uint32_t count) {
    uint32_t total = 0;
    for (uint32_t i = 0; i < count; i++)
        total += freq[i];
    return gsf_code_symbol(coder, value, freq, count, total);
}

/* Codes a flag that is set with a probability of `set` / 16. */
static bool code_flag(gsf_coder *coder, bool value, uint32_t set) {
    const uint16_t freq[] = {(uint16_t)(16 - set), (uint16_t)set};
    return gsf_code_symbol(coder, value, freq, 2, 16) != 0;
}

static unsigned bit_length(uint32_t value) {
    unsigned length = 0;
    while (length < 32 && value >> length != 0) /* when decoding, the value is arbitrary */
        length++;
    return length;
}

/* Codes a number below 2^(lengths - 1): first its length in bits, whose frequencies are given, then the bits after the
 * leading one. */
static uint32_t code_number(gsf_coder *coder, uint32_t value, const uint16_t *freq, uint32_t lengths) {
    const uint32_t length = code_fixed(coder, bit_length(value), freq, lengths);
    if (length <= 1)
        return length;
    uint32_t number = 1;
    for (unsigned left = length - 1; left > 0;) {
        const unsigned bits = left > 16 ? left - 16 : left;
        left -= bits;
        number = number << bits | gsf_code_bits(coder, value >> left & ((UINT32_C(1) << bits) - 1), bits);
    }
    return number;
}

/* ---- Packet ---- */

static const uint16_t PACKET_LENGTHS[] = {8, 2, 3, 4, 4, 3, 2, 1, 1}; /* of the number of packets - 1 */

/* Codes which packet this is.  A reader has set header->packets where it is one. */
static void code_packet(gsf_coder *coder, gsf_header *header) {
    if (gsf_header_packets(header) == 0)
        return;
    header->packets = (uint16_t)(1 + code_number(coder, header->packets - 1u, PACKET_LENGTHS, LENGTH(PACKET_LENGTHS)));
    header->packet = (uint8_t)gsf_code_uniform(coder, header->packet, header->packets);
}

/* ---- Kind ---- */

static const uint16_t BLENDS[] = {10, 4, 2};
static const uint16_t LAYOUTS[] = {5, 2, 4, 5};

/* Whether a picture is of the most frequent kind: an ordinary photograph in colour. */
static bool is_ordinary(const gsf_header *h) {
    return h->blend == GSF_BLEND_NORMALIZED && h->coding == GSF_CODING_SCALAR && h->layout == GSF_RGB &&
           !h->high_bit_depth && h->has_chroma && !h->has_opacity && h->has_rotation && h->has_anisotropy;
}

static void set_ordinary(gsf_header *h) {
    *h = (gsf_header){.blend = GSF_BLEND_NORMALIZED,
                      .coding = GSF_CODING_SCALAR,
                      .layout = GSF_RGB,
                      .has_chroma = true,
                      .has_rotation = true,
                      .has_anisotropy = true,
                      .packets = h->packets,
                      .packet = h->packet};
}

static void code_special(gsf_coder *coder, gsf_header *h) {
    h->blend = (gsf_blend)code_fixed(coder, h->blend, BLENDS, LENGTH(BLENDS));
    h->coding = gsf_header_packets(h) > 0 ? GSF_CODING_SCALAR
                                          : (gsf_coding)code_flag(coder, h->coding == GSF_CODING_CODEBOOK, 3);
    h->layout = (gsf_layout)code_fixed(coder, h->layout, LAYOUTS, LENGTH(LAYOUTS));
    h->high_bit_depth = code_flag(coder, h->high_bit_depth, 4);
    h->has_chroma = has_colour(h->layout) && code_flag(coder, h->has_chroma, 12);
    h->has_alpha = has_transparency(h->layout) && code_flag(coder, h->has_alpha, 14);
    h->has_opacity = code_flag(coder, h->has_opacity, 6);
    h->has_anisotropy = code_flag(coder, h->has_anisotropy, 14);
    h->has_rotation = h->has_anisotropy && code_flag(coder, h->has_rotation, 14);
}

static void code_kind(gsf_coder *coder, gsf_header *header) {
    gsf_header h = *header;
    if (code_flag(coder, !is_ordinary(&h), 4))
        code_special(coder, &h);
    else if (GSF_DECODING(coder))
        set_ordinary(&h);
    h.has_texture = h.coding == GSF_CODING_SCALAR && code_flag(coder, h.has_texture, 12);
    *header = h;
}

/* ---- Size ---- */

static const uint16_t SIDE_LENGTHS[] = {1, 1, 1, 1, 2, 2, 3, 4, 6, 10, 14, 10, 6, 2, 1}; /* of the side - 1 */
static const uint16_t UNIT_LENGTHS[] = {1, 1, 3, 7, 9, 6, 3, 1, 1};                      /* of the side / 64 - 1 */
static const uint16_t RATIOS[] = {10, 3, 8, 6, 2, 1, 1, 1};
/* The sides of ratio 1 and up; ratio 0 leaves the shorter side free. */
static const struct {
    uint8_t longer, shorter;
} SIDES[] = {{0, 0}, {1, 1}, {3, 2}, {4, 3}, {16, 9}, {16, 10}, {5, 4}, {2, 1}};

/* The shorter side that a ratio gives, rounded. */
static uint32_t shorter_side(uint32_t longer, uint32_t ratio) {
    const uint32_t a = SIDES[ratio].longer, b = SIDES[ratio].shorter;
    const uint32_t side = (2 * longer * b + a) / (2 * a);
    return side > 0 ? side : 1;
}

static uint32_t ratio_of(uint32_t longer, uint32_t shorter) {
    for (uint32_t ratio = 1; ratio < LENGTH(SIDES); ratio++)
        if (shorter_side(longer, ratio) == shorter)
            return ratio;
    return 0;
}

static uint32_t code_longer_side(gsf_coder *coder, uint32_t side) {
    if (code_flag(coder, side % 64 == 0, 8))
        return 64 * (1 + code_number(coder, side / 64 - 1, UNIT_LENGTHS, LENGTH(UNIT_LENGTHS)));
    return 1 + code_number(coder, side - 1, SIDE_LENGTHS, LENGTH(SIDE_LENGTHS));
}

static void code_size(gsf_coder *coder, gsf_header *header) {
    const bool is_portrait = header->width < header->height;
    uint32_t longer = is_portrait ? header->height : header->width;
    uint32_t shorter = is_portrait ? header->width : header->height;
    longer = code_longer_side(coder, longer);
    const uint32_t ratio = code_fixed(coder, ratio_of(longer, shorter), RATIOS, LENGTH(RATIOS));
    shorter = ratio > 0 ? shorter_side(longer, ratio) : 1 + gsf_code_uniform(coder, shorter - 1, longer);
    const bool portrait = shorter < longer && code_flag(coder, is_portrait, 6);
    header->width = portrait ? shorter : longer;
    header->height = portrait ? longer : shorter;
}

/* ---- Number of splats, steps, background ---- */

static void code_layers(gsf_coder *coder, gsf_header *header) {
    const uint32_t layers = header->enhancement_layers;
    header->enhancement_layers = 0;
    if (header->coding == GSF_CODING_SCALAR && gsf_header_packets(header) == 0 && header->splat_count > 0 &&
        code_flag(coder, layers > 0, 1))
        header->enhancement_layers = (uint8_t)(1 + gsf_code_uniform(coder, layers - 1, GSF_MAX_LAYERS - 1));
}

static const uint16_t DIFFERENCE_LENGTHS[] = {8, 4, 4, 2, 1, 1, 1, 1}; /* of the pivot from the typical size */
static const uint16_t COUNT_LENGTHS[] = {2, 1, 1, 2, 4, 6, 8, 7, 7, 6, 5, 4, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1};

void gsf_code_fields(gsf_coder *coder, gsf_header *header) {
    gsf_coder_count_in(coder, GSF_STREAM_HEADER);
    code_packet(coder, header);
    code_kind(coder, header);
    code_size(coder, header);
    const uint32_t count = code_number(coder, header->splat_count, COUNT_LENGTHS, LENGTH(COUNT_LENGTHS));
    header->splat_count = count < GSF_MAX_SPLATS ? count : GSF_MAX_SPLATS;
    code_layers(coder, header);
}

gsf_steps gsf_default_steps(uint64_t splat_count) {
    const uint8_t finer = splat_count >= GSF_MANY_SPLATS;
    return (gsf_steps){.scale = 6,
                       .position = 8,
                       .angle = 4,
                       .luma = (uint8_t)(5 + finer),
                       .chroma = (uint8_t)(3 + finer),
                       .alpha = 4,
                       .opacity = 3};
}

/* The steps that the header codes; the others are 0. */
static gsf_steps used_steps(const gsf_header *header, gsf_steps steps) {
    steps.angle = header->has_rotation ? steps.angle : 0;
    steps.chroma = header->has_chroma ? steps.chroma : 0;
    steps.alpha = header->has_alpha ? steps.alpha : 0;
    steps.opacity = header->has_opacity ? steps.opacity : 0;
    return steps;
}

/* The pivot is close to the typical size, which an encoder does not know exactly before it has all splats. */
static void code_pivot(gsf_coder *coder, const gsf_header *header, gsf_steps *steps) {
    const int typical = (int)gsf_typical_size(header, steps);
    const int difference = GSF_DECODING(coder) ? 0 : steps->pivot - typical;
    const uint32_t folded = (uint32_t)(difference < 0 ? -2 * difference - 1 : 2 * difference);
    const int number = (int)code_number(coder, folded, DIFFERENCE_LENGTHS, LENGTH(DIFFERENCE_LENGTHS));
    const int pivot = typical + (number % 2 ? -(number + 1) / 2 : number / 2);
    steps->pivot = (uint8_t)(pivot < 0 ? 0 : pivot > GSF_MAX_SCALE_CODE ? GSF_MAX_SCALE_CODE : pivot);
}

static void code_step_indices(gsf_coder *coder, const gsf_header *header, gsf_steps *steps) {
    gsf_steps defaults = used_steps(header, gsf_default_steps(gsf_all_splats(header)));
    *steps = used_steps(header, *steps);
    defaults.pivot = steps->pivot;
    uint8_t *own[] = {&steps->scale,  &steps->position, &steps->angle,  &steps->luma,
                      &steps->chroma, &steps->alpha,    &steps->opacity};
    const bool used[] = {
        true, true, header->has_rotation, true, header->has_chroma, header->has_alpha, header->has_opacity};
    if (!code_flag(coder, memcmp(steps, &defaults, sizeof defaults) != 0, 2)) {
        *steps = defaults;
        return;
    }
    for (unsigned i = 0; i < LENGTH(own); i++)
        if (used[i])
            *own[i] = (uint8_t)gsf_code_bits(coder, *own[i], 4);
}

static void code_steps(gsf_coder *coder, const gsf_header *header, gsf_steps *steps) {
    code_step_indices(coder, header, steps);
    code_pivot(coder, header, steps);
}

static void code_background(gsf_coder *coder, gsf_coded_image *image) {
    const gsf_header *header = &image->header;
    const bool has_splats = header->splat_count > 0;
    const bool own = !has_splats || code_flag(coder, !image->has_mean_background, 2);
    if (has_splats)
        image->has_mean_background = !own;
    for (unsigned i = 0; own && i < gsf_channel_count(header); i++)
        image->background[i] = (uint16_t)gsf_code_bits(coder, image->background[i], header->high_bit_depth ? 16 : 8);
}

void gsf_code_header(gsf_coder *coder, gsf_coded_image *image) {
    gsf_code_fields(coder, &image->header);
    gsf_coder_count_in(coder, GSF_STREAM_SIDE);
    if (image->header.coding == GSF_CODING_SCALAR && image->header.splat_count > 0)
        code_steps(coder, &image->header, &image->steps);
    code_background(coder, image);
}
