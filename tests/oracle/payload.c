/* "Payload". */
#include <stdlib.h>

#include "parts.h"

static void read_steps(oracle_decoder *decoder, const oracle_header *header, oracle_steps *steps) {
    steps->scale = oracle_raw(decoder, 4);
    steps->position = oracle_raw(decoder, 4);
    if (header->has_rotation)
        steps->angle = oracle_raw(decoder, 4);
    steps->luma = oracle_raw(decoder, 4);
    if (header->has_chroma)
        steps->chroma = oracle_raw(decoder, 4);
    if (header->has_alpha)
        steps->alpha = oracle_raw(decoder, 4);
    if (header->has_opacity)
        steps->opacity = oracle_raw(decoder, 4);
}

static uint32_t class_count(const oracle_payload *payload) {
    return payload->header.codebook ? payload->books.shapes.words : ORACLE_SCALAR_CLASSES;
}

static void make_grids(oracle_payload *payload) {
    const oracle_header *header = &payload->header;
    for (uint32_t class = 0; class < class_count(payload); class ++) {
        oracle_grid *grid = &payload->grids[class];
        if (header->codebook) {
            grid->cells_x = grid->cells_y = 1u << payload->books.position_bits;
            grid->pitch_x = header->width;
            grid->pitch_y = header->height;
        } else {
            const uint32_t minor = oracle_minor(class);
            grid->cells_x = oracle_cells(&payload->steps, minor, header->width);
            grid->cells_y = oracle_cells(&payload->steps, minor, header->height);
            grid->pitch_x = grid->pitch_y = oracle_step(&payload->steps, minor);
        }
    }
}

static bool read_set(oracle_payload *payload) {
    const uint32_t classes = class_count(payload), n = payload->header.splats;
    uint32_t counts[ORACLE_MAX_CLASSES];
    oracle_cell *cells = calloc(n, sizeof *cells);
    if (!cells)
        return false;
    oracle_class_counts(&payload->decoder, classes, n, counts);
    const bool done = oracle_positions(&payload->decoder, classes, counts, payload->grids, cells);
    uint32_t at = 0;
    for (uint32_t class = 0; class < classes; class ++) {
        for (uint32_t i = 0; i < counts[class]; i++, at++)
            payload->splats[at] = (oracle_codes){.cell = cells[at], .class = class};
    }
    free(cells);
    return done;
}

static void read_colour_words(oracle_payload *payload) {
    oracle_model model;
    oracle_model_init(&model, ORACLE_MODEL_COLOUR_INDEX, payload->books.colours.words, 0);
    for (uint32_t i = 0; i < payload->header.splats && !oracle_decoder_failed(&payload->decoder); i++)
        payload->splats[i].colour_index = oracle_model_decode(&model, &payload->decoder);
}

bool oracle_read_payload(oracle_payload *payload) {
    const oracle_header *header = &payload->header;
    oracle_decoder *decoder = &payload->decoder;
    for (uint32_t i = 0; i < header->channels; i++)
        payload->background[i] = oracle_raw(decoder, header->high_bit_depth ? 16 : 8);
    if (header->splats == 0)
        return true;

    if (header->codebook)
        oracle_read_codebooks(decoder, header, &payload->books);
    else
        read_steps(decoder, header, &payload->steps);
    if (oracle_decoder_failed(decoder))
        return true;

    payload->splats = calloc(header->splats, sizeof *payload->splats);
    if (!payload->splats)
        return false;
    make_grids(payload);
    if (!read_set(payload))
        return false;
    if (header->codebook)
        read_colour_words(payload);
    else if (!oracle_read_attributes(payload))
        return false;
    return true;
}
