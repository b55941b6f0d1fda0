/* The last step of the paper profile: words and splats as the integers of the file (P8). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "codebook/codebook.h"
#include "cl/constants.h"
#include "decode/quantise.h"

/* A word's dimensions in the units of the file (format.h). */
static double to_units(int book, int dim, int channels, float value) {
    const double pi = 3.14159265358979323846;
    if (book == GSCL_BOOK_SHAPE && dim < 2)
        return (value / 0.69314718055994530942 + 4) * 32;
    if (book == GSCL_BOOK_SHAPE)
        return (value - pi * floor(value / pi)) * 256 / pi;
    if (dim < channels)
        return value * 255.0;
    return 255.0 / (1.0 + exp(-value));
}

/* Ends of a dimension over all words, whole units inside the format's limits. */
static gsf_range range_of(const gscl_book *words, int book, int dim, int channels) {
    double low = 1e9, high = -1e9;
    for (int i = 0; i < words->count; i++) {
        double v = to_units(book, dim, channels, words->words[i * GSCL_BOOK_DIMS + dim]);
        low = fmin(low, v);
        high = fmax(high, v);
    }
    double least = book == GSCL_BOOK_COLOUR && dim < channels ? -255 : 0;
    double most = book == GSCL_BOOK_SHAPE ? (dim < 2 ? GSF_MAX_OCTAVES32 : 256) : dim < channels ? 510 : 255;
    low = fmin(fmax(floor(low + 0.25), least), most); /* outward, but not for a hair's breadth */
    high = fmin(fmax(ceil(high - 0.25), low), most);
    return (gsf_range){(int32_t)low, (int32_t)high};
}

static uint16_t code_of(const gsf_range *range, int bits, double value) {
    double last = (double)((1u << bits) - 1u);
    if (range->max == range->min)
        return 0;
    return (uint16_t)fmin(fmax(rint((value - range->min) * last / (range->max - range->min)), 0), last);
}

/* A word on its way into stored order. */
typedef struct coded {
    uint16_t code[GSCL_BOOK_DIMS];
    int from;
} coded;

static int compare_words(const coded *p, const coded *q, int sign) {
    if (p->code[0] != q->code[0])
        return p->code[0] < q->code[0] ? -sign : sign;
    return p->from < q->from ? -1 : p->from > q->from;
}
static int descending(const void *a, const void *b) {
    return compare_words(a, b, -1);
}
static int ascending(const void *a, const void *b) {
    return compare_words(a, b, 1);
}

/* Writes one book into the picture and tells where each word went. */
static void write_book(const gscl_codebook *c, int which, gsf_coded_image *file, coded *words, int *places) {
    const gscl_book *book = &c->books[which];
    gsf_codebooks *books = &file->codebooks;
    int channels = c->fit->renderer.channels, dims = which == GSCL_BOOK_SHAPE ? 3 : channels + 1;
    gsf_range *ranges = which == GSCL_BOOK_SHAPE ? books->shape : books->colour;
    for (int d = 0; d < dims; d++)
        ranges[d] = range_of(book, which, d, channels);
    for (int i = 0; i < book->count; i++) {
        words[i].from = i;
        for (int d = 0; d < dims; d++)
            words[i].code[d] =
                code_of(&ranges[d], book->bits, to_units(which, d, channels, book->words[i * GSCL_BOOK_DIMS + d]));
    }
    qsort(words, (size_t)book->count, sizeof *words, which == GSCL_BOOK_SHAPE ? descending : ascending);
    for (int i = 0; i < book->count; i++) {
        places[words[i].from] = i;
        if (which == GSCL_BOOK_SHAPE)
            memcpy(books->shape_words[i], words[i].code, 3 * sizeof(uint16_t));
        else
            memcpy(books->colour_words[i], words[i].code, (size_t)dims * sizeof(uint16_t));
    }
}

static uint16_t cell_of(float position, uint32_t size, int bits) {
    double cells = (double)(1u << bits), cell = floor(position / size * cells);
    return (uint16_t)fmin(fmax(cell, 0), cells - 1);
}

gscl_result gscl_codebook_quantise(const gscl_codebook *c, gscl_coded_image *picture) {
    size_t count = (size_t)c->fit->renderer.count;
    gsf_coded_image *file = &picture->file;
    GSCL_TRY(gscl_coded_image_reserve(picture, count));
    coded *words = malloc(GSF_MAX_CODEBOOK * sizeof *words);
    int(*places)[GSF_MAX_CODEBOOK] = malloc(GSCL_BOOKS * sizeof *places);
    if (words && places) {
        file->header.splat_count = (uint32_t)count;
        file->codebooks.shape_count = (uint16_t)c->books[GSCL_BOOK_SHAPE].count;
        file->codebooks.colour_count = (uint16_t)c->books[GSCL_BOOK_COLOUR].count;
        file->codebooks.position_bits = (uint8_t)c->position_bits;
        file->codebooks.shape_bits = (uint8_t)c->books[GSCL_BOOK_SHAPE].bits;
        file->codebooks.colour_bits = (uint8_t)c->books[GSCL_BOOK_COLOUR].bits;
        for (int b = 0; b < GSCL_BOOKS; b++)
            write_book(c, b, file, words, places[b]);
        for (size_t i = 0; i < count; i++) {
            const float *p = c->params + i * GSCL_PARAMS;
            file->indexed[i] =
                (gsf_indexed_splat){(uint16_t)places[0][c->pairs[i][0]], (uint16_t)places[1][c->pairs[i][1]],
                                    cell_of(p[GSCL_X], c->fit->pyramid.width, c->position_bits),
                                    cell_of(p[GSCL_Y], c->fit->pyramid.height, c->position_bits)};
        }
    }
    gscl_result result = words && places ? GSCL_OK : gscl_fail_memory(c->fit->context);
    free(words);
    free(places);
    return result;
}

/* Tells how many of `count` words are used and where each of these goes: their order stays. */
static uint16_t count_used(const bool *used, uint16_t count, uint16_t *places) {
    uint16_t kept = 0;
    for (uint16_t k = 0; k < count; k++)
        if (used[k])
            places[k] = kept++;
    return kept;
}

void gscl_codebook_drop_unused(gsf_coded_image *file) {
    bool used[GSCL_BOOKS][GSF_MAX_CODEBOOK] = {{false}};
    uint16_t places[GSCL_BOOKS][GSF_MAX_CODEBOOK];
    gsf_codebooks *books = &file->codebooks;
    if (file->header.splat_count == 0)
        return;
    for (uint32_t i = 0; i < file->header.splat_count; i++) {
        used[GSCL_BOOK_SHAPE][file->indexed[i].shape] = true;
        used[GSCL_BOOK_COLOUR][file->indexed[i].colour] = true;
    }
    uint16_t shapes = count_used(used[GSCL_BOOK_SHAPE], books->shape_count, places[GSCL_BOOK_SHAPE]);
    uint16_t colours = count_used(used[GSCL_BOOK_COLOUR], books->colour_count, places[GSCL_BOOK_COLOUR]);
    for (uint16_t k = 0; k < books->shape_count; k++)
        if (used[GSCL_BOOK_SHAPE][k])
            memmove(books->shape_words[places[GSCL_BOOK_SHAPE][k]], books->shape_words[k], sizeof *books->shape_words);
    for (uint16_t k = 0; k < books->colour_count; k++)
        if (used[GSCL_BOOK_COLOUR][k])
            memmove(books->colour_words[places[GSCL_BOOK_COLOUR][k]], books->colour_words[k],
                    sizeof *books->colour_words);
    for (uint32_t i = 0; i < file->header.splat_count; i++) {
        file->indexed[i].shape = places[GSCL_BOOK_SHAPE][file->indexed[i].shape];
        file->indexed[i].colour = places[GSCL_BOOK_COLOUR][file->indexed[i].colour];
    }
    books->shape_count = shapes;
    books->colour_count = colours;
}
