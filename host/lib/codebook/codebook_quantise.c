#include "codebook/codebook_quantise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/elementary.h"

/* A dimension of a word in the units of the file (format/format.h). */
static double to_units(int book, int dim, int channels, float value) {
    const double pi = 3.14159265358979323846;
    if (book == GSCL_BOOK_SHAPE && dim < 2)
        return (value / 0.69314718055994530942 + 4) * 32;
    if (book == GSCL_BOOK_SHAPE)
        return (value - pi * floor(value / pi)) * 256 / pi;
    if (dim < channels)
        return value * 255.0;
    return 255.0 / (1.0 + gscl_exp(-value));
}

/* The range of a dimension over all words, in whole units and within the format's limits. */
static gsf_range range_of(const gscl_book *words, int book, int dim, int channels) {
    double low = 1e9, high = -1e9;
    for (int i = 0; i < words->count; i++) {
        double v = to_units(book, dim, channels, words->words[i * GSCL_BOOK_DIMS + dim]);
        low = fmin(low, v);
        high = fmax(high, v);
    }
    const double min = book == GSCL_BOOK_COLOUR && dim < channels ? -255 : 0;
    const double max = book == GSCL_BOOK_SHAPE ? (dim < 2 ? GSF_MAX_OCTAVES32 : 256) : dim < channels ? 510 : 255;
    /* Rounded outward, unless a quarter of a unit or less would be cut off. */
    low = fmin(fmax(floor(low + 0.25), min), max);
    high = fmin(fmax(ceil(high - 0.25), low), max);
    return (gsf_range){(int32_t)low, (int32_t)high};
}

static uint16_t code_of(const gsf_range *range, int bits, double value) {
    double last = (double)((1u << bits) - 1u);
    if (range->max == range->min)
        return 0;
    return (uint16_t)fmin(fmax(rint((value - range->min) * last / (range->max - range->min)), 0), last);
}

/* A word and its index before it was sorted into the stored order. */
typedef struct coded_word {
    uint16_t code[GSCL_BOOK_DIMS];
    int from;
} coded_word;

static int compare_words(const coded_word *p, const coded_word *q, int sign) {
    if (p->code[0] != q->code[0])
        return p->code[0] < q->code[0] ? -sign : sign;
    return p->from < q->from ? -1 : p->from > q->from;
}

static int compare_descending(const void *a, const void *b) {
    return compare_words(a, b, -1);
}

static int compare_ascending(const void *a, const void *b) {
    return compare_words(a, b, 1);
}

/* Writes one book into the coded image; word k of the codebook becomes word places[k] of the file. */
static void write_book(const gscl_codebook *c, int which, gsf_coded_image *file, int *places) {
    const gscl_book *book = &c->books[which];
    gsf_codebooks *books = &file->codebooks;
    coded_word words[GSF_MAX_CODEBOOK];
    const int channels = gscl_codebook_channels(c), dims = gscl_codebook_dims(c, which);
    gsf_range *ranges = which == GSCL_BOOK_SHAPE ? books->shape : books->colour;
    for (int d = 0; d < dims; d++)
        ranges[d] = range_of(book, which, d, channels);
    for (int i = 0; i < book->count; i++) {
        words[i].from = i;
        for (int d = 0; d < dims; d++)
            words[i].code[d] =
                code_of(&ranges[d], book->bits, to_units(which, d, channels, book->words[i * GSCL_BOOK_DIMS + d]));
    }
    qsort(words, (size_t)book->count, sizeof *words, which == GSCL_BOOK_SHAPE ? compare_descending : compare_ascending);
    for (int i = 0; i < book->count; i++) {
        uint16_t *stored = which == GSCL_BOOK_SHAPE ? books->shape_words[i] : books->colour_words[i];
        places[words[i].from] = i;
        memcpy(stored, words[i].code, (size_t)dims * sizeof *stored);
    }
}

static uint16_t cell_of(float position, uint32_t size, int bits) {
    double cells = (double)(1u << bits), cell = floor(position / size * cells);
    return (uint16_t)fmin(fmax(cell, 0), cells - 1);
}

/* Sets the numbers of words and the bits of words and positions. */
static void write_layout(const gscl_codebook *c, gsf_codebooks *books) {
    books->shape_count = (uint16_t)c->books[GSCL_BOOK_SHAPE].count;
    books->colour_count = (uint16_t)c->books[GSCL_BOOK_COLOUR].count;
    books->position_bits = (uint8_t)c->position_bits;
    books->shape_bits = (uint8_t)c->books[GSCL_BOOK_SHAPE].bits;
    books->colour_bits = (uint8_t)c->books[GSCL_BOOK_COLOUR].bits;
}

gscl_result gscl_codebook_quantise(const gscl_codebook *c, gscl_coded_image *coded) {
    const size_t count = gscl_codebook_splats(c);
    gsf_coded_image *file = &coded->file;
    int places[GSCL_BOOKS][GSF_MAX_CODEBOOK];
    GSCL_TRY(gscl_coded_image_reserve(coded, count));
    file->header.splat_count = (uint32_t)count;
    write_layout(c, &file->codebooks);
    for (int b = 0; b < GSCL_BOOKS; b++)
        write_book(c, b, file, places[b]);
    for (size_t i = 0; i < count; i++) {
        const float *p = c->params + i * GSCL_PARAMS;
        const int32_t *pair = c->pairs[i];
        file->indexed[i] = (gsf_indexed_splat){(uint16_t)places[GSCL_BOOK_SHAPE][pair[GSCL_BOOK_SHAPE]],
                                               (uint16_t)places[GSCL_BOOK_COLOUR][pair[GSCL_BOOK_COLOUR]],
                                               cell_of(p[GSCL_X], c->fit->pyramid.width, c->position_bits),
                                               cell_of(p[GSCL_Y], c->fit->pyramid.height, c->position_bits)};
    }
    return GSCL_OK;
}

/* Gives each used word its new index, in the old order, and returns the number of used words. */
static uint16_t renumber_used(const bool *used, uint16_t count, uint16_t *places) {
    uint16_t kept = 0;
    for (uint16_t k = 0; k < count; k++)
        if (used[k])
            places[k] = kept++;
    return kept;
}

void gscl_coded_codebooks_drop_unused(gsf_coded_image *file) {
    bool used_shapes[GSF_MAX_CODEBOOK] = {false}, used_colours[GSF_MAX_CODEBOOK] = {false};
    uint16_t shape_places[GSF_MAX_CODEBOOK], colour_places[GSF_MAX_CODEBOOK];
    gsf_codebooks *books = &file->codebooks;
    const uint32_t splats = file->header.splat_count;
    if (splats == 0)
        return;
    for (uint32_t i = 0; i < splats; i++) {
        used_shapes[file->indexed[i].shape] = true;
        used_colours[file->indexed[i].colour] = true;
    }
    const uint16_t shapes = renumber_used(used_shapes, books->shape_count, shape_places);
    const uint16_t colours = renumber_used(used_colours, books->colour_count, colour_places);
    for (uint16_t k = 0; k < books->shape_count; k++)
        if (used_shapes[k])
            memmove(books->shape_words[shape_places[k]], books->shape_words[k], sizeof *books->shape_words);
    for (uint16_t k = 0; k < books->colour_count; k++)
        if (used_colours[k])
            memmove(books->colour_words[colour_places[k]], books->colour_words[k], sizeof *books->colour_words);
    for (uint32_t i = 0; i < splats; i++) {
        file->indexed[i].shape = shape_places[file->indexed[i].shape];
        file->indexed[i].colour = colour_places[file->indexed[i].colour];
    }
    books->shape_count = shapes;
    books->colour_count = colours;
}
