/* "Codebooks" of the payload. */
#include "parts.h"

typedef struct {
    int32_t lowest, highest;
} limits;

static int32_t number(oracle_decoder *decoder) {
    const uint32_t b = oracle_uniform(decoder, 17);
    if (b <= 1)
        return (int32_t)b;
    return (int32_t)((1u << (b - 1)) + oracle_raw(decoder, b - 1));
}

static void read_ranges(oracle_decoder *decoder, oracle_codebook *book, const limits *allowed) {
    for (uint32_t i = 0; i < book->dimensions; i++) {
        book->min[i] = allowed[i].lowest + number(decoder);
        book->max[i] = book->min[i] + number(decoder);
        if (book->max[i] > allowed[i].highest)
            decoder->corrupt = true;
    }
}

static void read_words(oracle_decoder *decoder, oracle_codebook *book, bool descending) {
    oracle_cell cells[ORACLE_MAX_CLASSES] = {{0, 0}};
    const oracle_grid line = {1u << book->bits, 1, 1, 1};
    oracle_points(decoder, &line, book->words, cells);
    for (uint32_t i = 0; i < book->words; i++)
        book->codes[i][0] = cells[descending ? book->words - 1 - i : i].x;
    for (uint32_t i = 0; i < book->words; i++) {
        for (uint32_t d = 1; d < book->dimensions; d++)
            book->codes[i][d] = oracle_raw(decoder, book->bits);
    }
}

void oracle_read_codebooks(oracle_decoder *decoder, const oracle_header *header, oracle_codebooks *books) {
    const limits shape[] = {{0, 640}, {0, 640}, {0, 256}};
    limits colour[ORACLE_CHANNELS + 1];
    for (uint32_t i = 0; i < header->channels; i++)
        colour[i] = (limits){-255, 510};
    colour[header->channels] = (limits){0, 255};

    books->shapes.dimensions = 1 + (header->has_anisotropy ? 1 : 0) + (header->has_rotation ? 1 : 0);
    books->colours.dimensions = header->channels + (header->has_opacity ? 1 : 0);
    books->position_bits = oracle_raw(decoder, 4) + 1;
    books->shapes.bits = oracle_raw(decoder, 4) + 1;
    books->colours.bits = oracle_raw(decoder, 4) + 1;
    books->shapes.words = oracle_raw(decoder, 10) + 1;
    books->colours.words = oracle_raw(decoder, 10) + 1;
    read_ranges(decoder, &books->shapes, shape);
    read_ranges(decoder, &books->colours, colour);
    if (oracle_decoder_failed(decoder))
        return;
    read_words(decoder, &books->shapes, true);
    read_words(decoder, &books->colours, false);
}
