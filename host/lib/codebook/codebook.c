#include "codebook/codebook.h"

#include <stdlib.h>
#include <string.h>

#include "runtime/vectors.h"

static gscl_result book_create(gscl_book *book, gscl_context *context) {
    gscl_buffer *buffers[] = {&book->learnt, &book->stored, &book->first_moment, &book->second_moment};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
        GSCL_TRY(gscl_buffer_reserve(context, buffers[i], GSCL_BOOK_BYTES));
    return GSCL_OK;
}

static void book_free(gscl_book *book) {
    gscl_buffer *buffers[] = {&book->learnt, &book->stored, &book->first_moment, &book->second_moment};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
        gscl_buffer_free(buffers[i]);
}

static gscl_result allocate_host_copies(gscl_codebook *c) {
    const size_t count = gscl_codebook_splats(c) + 1, book_size = GSCL_BOOK_BYTES / sizeof *c->words;
    c->words = calloc(GSCL_BOOKS, GSCL_BOOK_BYTES);
    c->params = malloc(count * GSCL_PARAMS * sizeof *c->params);
    c->pairs = calloc(count, sizeof *c->pairs);
    c->sorted_params = malloc(count * GSCL_PARAMS * sizeof *c->sorted_params);
    c->sorted_pairs = malloc(count * sizeof *c->sorted_pairs);
    c->order = malloc(count * sizeof *c->order);
    if (!c->words || !c->params || !c->pairs || !c->sorted_params || !c->sorted_pairs || !c->order)
        return gscl_fail_memory(c->fit->context);
    for (int b = 0; b < GSCL_BOOKS; b++)
        c->books[b].words = c->words + (size_t)b * book_size;
    return GSCL_OK;
}

gscl_result gscl_codebook_create(gscl_codebook *c, gscl_fit *fit, int position_bits, int shape_bits, int colour_bits) {
    memset(c, 0, sizeof *c);
    c->fit = fit;
    c->position_bits = position_bits;
    c->books[GSCL_BOOK_SHAPE].bits = shape_bits;
    c->books[GSCL_BOOK_COLOUR].bits = colour_bits;
    const size_t count = gscl_codebook_splats(c);
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(book_create(&c->books[b], fit->context));
    GSCL_TRY(allocate_host_copies(c));
    GSCL_TRY(gscl_buffer_reserve(fit->context, &c->learnt, gscl_room_for_splats(count) * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_reserve(fit->context, &c->indices, count * sizeof(gscl_int2)));
    GSCL_TRY(gscl_fit_read(fit, c->params));
    return gscl_codebook_upload(c);
}

void gscl_codebook_free(gscl_codebook *c) {
    for (int b = 0; b < GSCL_BOOKS; b++)
        book_free(&c->books[b]);
    gscl_buffer_free(&c->learnt);
    gscl_buffer_free(&c->indices);
    free(c->words);
    free(c->params);
    free(c->pairs);
    free(c->sorted_params);
    free(c->sorted_pairs);
    free(c->order);
    memset(c, 0, sizeof *c);
}

gscl_result gscl_codebook_read_back(gscl_codebook *c) {
    const size_t count = gscl_codebook_splats(c);
    GSCL_TRY(gscl_buffer_read(c->fit->context, &c->learnt, 0, c->params, count * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_read(c->fit->context, &c->indices, 0, c->pairs, count * sizeof(gscl_int2)));
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(gscl_buffer_read(c->fit->context, &c->books[b].learnt, 0, c->books[b].words, GSCL_BOOK_BYTES));
    return GSCL_OK;
}

gscl_result gscl_codebook_upload(gscl_codebook *c) {
    const size_t count = gscl_codebook_splats(c);
    GSCL_TRY(gscl_buffer_write(c->fit->context, &c->learnt, 0, c->params, count * GSCL_PARAMS * sizeof(float)));
    GSCL_TRY(gscl_buffer_write(c->fit->context, &c->indices, 0, c->pairs, count * sizeof(gscl_int2)));
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(gscl_buffer_write(c->fit->context, &c->books[b].learnt, 0, c->books[b].words, GSCL_BOOK_BYTES));
    return GSCL_OK;
}

static void book_drop_unused(gscl_codebook *c, int which) {
    gscl_book *book = &c->books[which];
    const size_t splats = gscl_codebook_splats(c);
    int new_index[GSF_MAX_CODEBOOK], kept = 0;
    bool used[GSF_MAX_CODEBOOK] = {false};
    for (size_t i = 0; i < splats; i++)
        used[c->pairs[i][which]] = true;
    for (int k = 0; k < book->count; k++) {
        if (!used[k])
            continue;
        memmove(book->words + kept * GSCL_BOOK_DIMS, book->words + k * GSCL_BOOK_DIMS, GSCL_BOOK_DIMS * sizeof(float));
        new_index[k] = kept++;
    }
    for (size_t i = 0; i < splats; i++)
        c->pairs[i][which] = new_index[c->pairs[i][which]];
    book->count = kept;
}

void gscl_codebook_drop_unused(gscl_codebook *c) {
    for (int b = 0; b < GSCL_BOOKS; b++)
        book_drop_unused(c, b);
}
