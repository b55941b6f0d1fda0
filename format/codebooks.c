#include "format/codebooks.h"

#include "format/header.h"
#include "format/quantiser.h"

/* Limits of the range of one dimension. */
typedef struct limits {
    int32_t min, max;
} limits;

static const limits SHAPE_LIMITS[GSF_SHAPE_DIMS] = {{0, GSF_MAX_OCTAVES32}, {0, GSF_MAX_OCTAVES32}, {0, 256}};
static const limits COLOUR_LIMITS = {-255, 510};
static const limits OPACITY_LIMITS = {0, 255};

static const limits *colour_limits(const gsf_header *header, unsigned dim) {
    return dim < gsf_channel_count(header) ? &COLOUR_LIMITS : &OPACITY_LIMITS;
}

unsigned gsf_shape_dims(const gsf_header *header) {
    return 1u + (header->has_anisotropy ? 1u : 0u) + (header->has_rotation ? 1u : 0u);
}

unsigned gsf_colour_dims(const gsf_header *header) {
    return gsf_channel_count(header) + (header->has_opacity ? 1u : 0u);
}

static bool range_is_valid(const gsf_range *range, const limits *bounds) {
    return range->min >= bounds->min && range->min <= range->max && range->max <= bounds->max;
}

bool gsf_codebook_parameters_are_valid(const gsf_header *header, const gsf_codebooks *books) {
    bool valid = books->shape_count >= 1 && books->shape_count <= GSF_MAX_CODEBOOK && books->colour_count >= 1 &&
                 books->colour_count <= GSF_MAX_CODEBOOK && books->position_bits >= 1 && books->position_bits <= 16 &&
                 books->shape_bits >= 1 && books->shape_bits <= 16 && books->colour_bits >= 1 &&
                 books->colour_bits <= 16;
    for (unsigned i = 0; i < gsf_shape_dims(header); i++)
        valid = valid && range_is_valid(&books->shape[i], &SHAPE_LIMITS[i]);
    for (unsigned i = 0; i < gsf_colour_dims(header); i++)
        valid = valid && range_is_valid(&books->colour[i], colour_limits(header, i));
    return valid;
}

bool gsf_codebook_words_are_valid(const gsf_header *header, const gsf_codebooks *books) {
    bool valid = true;
    for (unsigned i = 0; i < books->shape_count; i++) {
        for (unsigned d = 0; d < gsf_shape_dims(header); d++)
            valid = valid && books->shape_words[i][d] >> books->shape_bits == 0;
        valid = valid && (i == 0 || books->shape_words[i][0] <= books->shape_words[i - 1][0]);
    }
    for (unsigned i = 0; i < books->colour_count; i++) {
        for (unsigned d = 0; d < gsf_colour_dims(header); d++)
            valid = valid && books->colour_words[i][d] >> books->colour_bits == 0;
        valid = valid && (i == 0 || books->colour_words[i][0] >= books->colour_words[i - 1][0]);
    }
    return valid;
}

/* Codes a number below 2^16: how many bits it has, then the bits after the leading one. */
static uint32_t code_number(gsf_coder *coder, uint32_t value) {
    uint32_t bits = 0;
    while (bits < 16 && value >> bits != 0)
        bits++;
    bits = gsf_code_uniform(coder, bits, 17);
    if (bits <= 1)
        return bits;
    const uint32_t leading = UINT32_C(1) << (bits - 1);
    return leading + gsf_code_bits(coder, value - leading, bits - 1);
}

/* The sum of the two, but at most `highest`: all numbers that can be decoded are allowed. */
static int32_t end_of_range(int32_t from, uint32_t number, int32_t highest) {
    return number < (uint32_t)(highest - from) ? from + (int32_t)number : highest;
}

static void code_range(gsf_coder *coder, gsf_range *range, const limits *bounds) {
    const uint32_t low = (uint32_t)(range->min - bounds->min);
    const uint32_t span = (uint32_t)(range->max - range->min);
    range->min = end_of_range(bounds->min, code_number(coder, low), bounds->max);
    range->max = end_of_range(range->min, code_number(coder, span), bounds->max);
}

void gsf_code_codebook_parameters(gsf_coder *coder, const gsf_header *header, gsf_codebooks *books) {
    books->position_bits = (uint8_t)(gsf_code_bits(coder, books->position_bits - 1u, 4) + 1);
    books->shape_bits = (uint8_t)(gsf_code_bits(coder, books->shape_bits - 1u, 4) + 1);
    books->colour_bits = (uint8_t)(gsf_code_bits(coder, books->colour_bits - 1u, 4) + 1);
    books->shape_count = (uint16_t)(gsf_code_bits(coder, books->shape_count - 1u, 10) + 1);
    books->colour_count = (uint16_t)(gsf_code_bits(coder, books->colour_count - 1u, 10) + 1);
    for (unsigned i = 0; i < gsf_shape_dims(header); i++)
        code_range(coder, &books->shape[i], &SHAPE_LIMITS[i]);
    for (unsigned i = 0; i < gsf_colour_dims(header); i++)
        code_range(coder, &books->colour[i], colour_limits(header, i));
}

/* Codes a sorted list of numbers of `bits` bits as points on a line. */
static void code_sorted(gsf_coder *coder, gsf_point *points, uint32_t n, unsigned bits) {
    const gsf_grid line = {UINT32_C(1) << bits, 1, 1, 1};
    gsf_prior none;
    gsf_set set;
    gsf_set_init(&set, points, &n, &line, &none);
    gsf_code_class_points(coder, &set, 0, 0);
}

static void code_shape_words(gsf_coder *coder, const gsf_header *header, gsf_codebooks *books, gsf_point *points) {
    const unsigned count = books->shape_count;
    for (unsigned i = 0; i < count; i++)
        points[count - 1 - i] = (gsf_point){books->shape_words[i][0], 0};
    code_sorted(coder, points, count, books->shape_bits);
    for (unsigned i = 0; i < count; i++) {
        uint16_t *word = books->shape_words[i];
        word[0] = (uint16_t)points[count - 1 - i].x;
        for (unsigned d = 1; d < gsf_shape_dims(header); d++)
            word[d] = (uint16_t)gsf_code_bits(coder, word[d], books->shape_bits);
    }
}

static void code_colour_words(gsf_coder *coder, const gsf_header *header, gsf_codebooks *books, gsf_point *points) {
    for (unsigned i = 0; i < books->colour_count; i++)
        points[i] = (gsf_point){books->colour_words[i][0], 0};
    code_sorted(coder, points, books->colour_count, books->colour_bits);
    for (unsigned i = 0; i < books->colour_count; i++) {
        uint16_t *word = books->colour_words[i];
        word[0] = (uint16_t)points[i].x;
        for (unsigned d = 1; d < gsf_colour_dims(header); d++)
            word[d] = (uint16_t)gsf_code_bits(coder, word[d], books->colour_bits);
    }
}

void gsf_code_codebook_words(gsf_coder *coder, const gsf_header *header, gsf_codebooks *books, gsf_point *points) {
    code_shape_words(coder, header, books, points);
    code_colour_words(coder, header, books, points);
}

void gsf_complete_shape_words(const gsf_header *header, gsf_codebooks *books) {
    if (!header->has_anisotropy)
        books->shape[1] = books->shape[0];
    if (!header->has_rotation)
        books->shape[2] = (gsf_range){0, 0};
    for (unsigned i = 0; i < books->shape_count; i++) {
        if (!header->has_anisotropy)
            books->shape_words[i][1] = books->shape_words[i][0];
        if (!header->has_rotation)
            books->shape_words[i][2] = 0;
    }
}

uint32_t gsf_shape_sigma(const gsf_codebooks *books, unsigned word, unsigned axis) {
    const uint64_t last = (UINT64_C(1) << books->shape_bits) - 1;
    const gsf_range *range = &books->shape[axis];
    const uint64_t span = (uint64_t)(range->max - range->min);
    const uint64_t scaled = (uint64_t)range->min * last + books->shape_words[word][axis] * span;
    return gsf_octaves_to_pixels((unsigned)((scaled + last - 1) / last));
}
