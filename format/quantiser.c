#include "format/quantiser.h"

/* 2^(i / 32) * 2^24, rounded. */
static const uint32_t POWER[33] = {
    16777216, 17144589, 17520007, 17903645, 18295684, 18696307, 19105703, 19524063, 19951585, 20388467, 20834917,
    21291142, 21757357, 22233781, 22720638, 23218155, 23726566, 24246111, 24777031, 25319578, 25874004, 26440571,
    27019544, 27611195, 28215802, 28833647, 29465022, 30110222, 30769550, 31443315, 32131834, 32835430, 33554432,
};

static const uint16_t COLOUR_LEVELS[16] = {4, 6, 8, 11, 16, 20, 24, 28, 32, 40, 48, 64, 96, 128, 192, 255};
enum { MAX_LEVEL = 255 + 255 / 8 };

/* With these the parts grow as the fifth root of the area. */
const int16_t gsf_finer_from[GSF_MAX_FINENESS - 1] = {-210, -92, -15, 43, 90, 128, 161};

uint64_t gsf_sigma_q16(const gsf_steps *steps, unsigned code) {
    const unsigned exponent = code * (steps->scale + 4u); /* in 1/32 octaves above half a pixel */
    if (exponent >= 16 * 32)
        return UINT64_C(1) << 31;
    return ((uint64_t)POWER[exponent % 32] << (exponent / 32)) >> 9;
}

uint32_t gsf_octaves_to_pixels(unsigned octaves32) {
    const uint64_t q28 = (uint64_t)POWER[octaves32 % 32] << (octaves32 / 32); /* 24 bits of the table, 4 octaves */
    return (uint32_t)((q28 + (1u << 28) - 1) >> 28);
}

uint32_t gsf_position_step_q8(const gsf_steps *steps, unsigned major) {
    const uint64_t step = gsf_sigma_q16(steps, major) * (steps->position + 2u) >> 13;
    return step < 8 ? 8 : (uint32_t)step;
}

uint32_t gsf_position_cells(const gsf_steps *steps, unsigned major, uint32_t dimension) {
    const uint32_t step = gsf_position_step_q8(steps, major);
    return (dimension * 256u + step - 1) / step;
}

uint32_t gsf_position_parts(const gsf_steps *steps, unsigned aspect) {
    const unsigned exponent = aspect * (steps->scale + 4u);
    if (exponent >= 16 * 32)
        return 65536;
    return (uint32_t)((((uint64_t)POWER[exponent % 32] << (exponent / 32)) + (1u << 23)) >> 24);
}

uint64_t gsf_all_splats(const gsf_header *header) {
    const uint32_t packets = gsf_header_packets(header);
    return (uint64_t)header->splat_count * (packets > 0 ? packets : 1);
}

unsigned gsf_typical_size(const gsf_header *header, const gsf_steps *steps) {
    const uint64_t area = (uint64_t)header->width * header->height << 16; /* of the image, in 1/256 pixel squared */
    for (unsigned code = 0; code < GSF_MAX_SCALE_CODE; code++) {
        const uint64_t sigma = gsf_sigma_q16(steps, code) >> 8;
        if (sigma * sigma * gsf_all_splats(header) >= area) /* below 2^64: the area is below 2^44, a step below 2^4 */
            return code;
    }
    return GSF_MAX_SCALE_CODE;
}

uint32_t gsf_size_row(unsigned major, unsigned typical, uint32_t below, uint32_t rows) {
    const int32_t relative = (int32_t)major - (int32_t)typical + (int32_t)below;
    return relative < 0 ? 0 : (uint32_t)relative < rows ? (uint32_t)relative : rows - 1;
}

bool gsf_angle_is_steep(unsigned angle, unsigned angle_count) {
    return 4 * angle > angle_count && 4 * angle < 3 * angle_count;
}

gsf_splat_grid gsf_splat_grid_of(const gsf_header *header, const gsf_steps *steps, const gsf_splat *splat) {
    const uint32_t parts = header->has_anisotropy ? gsf_position_parts(steps, splat->aspect) : 1;
    const bool steep = header->has_rotation && gsf_angle_is_steep(splat->angle, gsf_angle_count(steps, splat->aspect));
    gsf_splat_grid grid = {
        .step = gsf_position_step_q8(steps, splat->major), .parts_x = steep ? parts : 1, .parts_y = steep ? 1 : parts};
    grid.cells_x = grid.parts_x * ((header->width * 256u + grid.step - 1) / grid.step);
    grid.cells_y = grid.parts_y * ((header->height * 256u + grid.step - 1) / grid.step);
    return grid;
}

unsigned gsf_angle_count(const gsf_steps *steps, unsigned aspect) {
    const uint64_t pi_q24 = 52707179;
    const unsigned exponent = aspect * (steps->scale + 4u);
    if (exponent >= 8 * 32) /* a >= 256: more than GSF_MAX_ANGLES for every step */
        return GSF_MAX_ANGLES;
    const uint64_t a = (uint64_t)POWER[exponent % 32] << (exponent / 32);
    const uint64_t inverse = POWER[32 - exponent % 32] >> (exponent / 32 + 1);
    const uint64_t divisor = (uint64_t)(steps->angle + 2u) << 44;
    const uint64_t count = ((a - inverse) * pi_q24 + divisor - 1) / divisor;
    return count < 1 ? 1 : count > GSF_MAX_ANGLES ? GSF_MAX_ANGLES : (unsigned)count;
}

unsigned gsf_colour_levels(unsigned step_index) {
    return COLOUR_LEVELS[step_index & 15];
}

unsigned gsf_colour_fineness(const gsf_steps *steps, unsigned major, unsigned aspect) {
    const int area = ((int)(2 * major - aspect) - 2 * steps->pivot) * (steps->scale + 4);
    unsigned fineness = 1;
    while (fineness < GSF_MAX_FINENESS && area >= gsf_finer_from[fineness - 1])
        fineness++;
    return fineness;
}

int gsf_colour_level(int code, unsigned fineness) {
    const int positive = 2 * MAX_LEVEL; /* makes the division round down */
    return (code + positive * (int)fineness) / (int)fineness - positive;
}

/* The codes of the levels from the lowest to the highest. */
static void range_of_levels(int lowest, int highest, unsigned fineness, int *min, int *max) {
    *min = lowest * (int)fineness;
    *max = (highest + 1) * (int)fineness - 1;
}

void gsf_luma_range(gsf_blend blend, unsigned step_index, unsigned fineness, int *min, int *max) {
    const int levels = (int)gsf_colour_levels(step_index), highest = levels + levels / 8;
    range_of_levels(blend == GSF_BLEND_SUM ? -highest : -(levels / 8), highest, fineness, min, max);
}

void gsf_chroma_range(unsigned step_index, unsigned fineness, int *min, int *max) {
    const int levels = (int)gsf_colour_levels(step_index);
    range_of_levels(-levels, levels, fineness, min, max);
}
