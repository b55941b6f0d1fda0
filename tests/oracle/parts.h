/* The parts of the oracle, in the order of the sections of FORMAT.md. */
#ifndef GSCL_ORACLE_PARTS_H
#define GSCL_ORACLE_PARTS_H

#include "oracle.h"

#define ORACLE_MAX_CLASSES 1024
#define ORACLE_MAX_SYMBOLS 1024
#define ORACLE_SCALAR_CLASSES 64

/* ---- Header (header.c) ---- */

/* Reads the fields and the stored checksum. */
oracle_result oracle_read_header(const uint8_t *bytes, size_t size, oracle_header *header, uint32_t *checksum);
uint32_t oracle_checksum(const uint8_t *bytes, size_t size, size_t header_bytes);

/* ---- Range coder (range_decoder.c) ---- */

typedef struct {
    const uint8_t *bytes;
    size_t size, consumed;
    uint32_t range, code;
    bool corrupt; /* a value that is not allowed has been decoded */
} oracle_decoder;

void oracle_decoder_start(oracle_decoder *decoder, const uint8_t *bytes, size_t size);
/* Whether more than three bytes beyond the end were read. */
bool oracle_decoder_overrun(const oracle_decoder *decoder);
/* Whether decoding has failed and can stop. */
bool oracle_decoder_failed(const oracle_decoder *decoder);
uint32_t oracle_symbol(oracle_decoder *decoder, const uint32_t *frequencies, uint32_t count);
uint32_t oracle_uniform(oracle_decoder *decoder, uint32_t n);
uint32_t oracle_raw(oracle_decoder *decoder, uint32_t bits);

/* ---- Adaptive models and count splits (models.c) ---- */

typedef enum {
    ORACLE_MODEL_ASPECT,
    ORACLE_MODEL_DIRECTION,
    ORACLE_MODEL_LUMA,
    ORACLE_MODEL_ALPHA,
    ORACLE_MODEL_OPACITY,
    ORACLE_MODEL_TEXTURED,
    ORACLE_MODEL_AMPLITUDE,
    ORACLE_MODEL_WAVE,
    ORACLE_MODEL_WAVE_DIRECTION,
    ORACLE_MODEL_PLAIN_CHROMA,
    ORACLE_MODEL_RESIDUAL_CHROMA,
    ORACLE_MODEL_COLOUR_INDEX
} oracle_model_kind;

typedef struct {
    uint32_t count, limit;
    uint32_t gain[3];
    uint32_t f[ORACLE_MAX_SYMBOLS];
} oracle_model;

void oracle_model_init(oracle_model *model, oracle_model_kind kind, uint32_t count, uint32_t centre);
void oracle_model_add(oracle_model *model, int64_t symbol, uint32_t amount);
void oracle_model_update(oracle_model *model, uint32_t symbol);
uint32_t oracle_model_decode(oracle_model *model, oracle_decoder *decoder);
uint32_t oracle_count_split(oracle_decoder *decoder, uint32_t n, uint64_t left_weight, uint64_t right_weight);

/* ---- Set coding (sets.c) ---- */

typedef struct {
    uint32_t cells_x, cells_y;
    uint64_t pitch_x, pitch_y;
} oracle_grid;

typedef struct {
    uint32_t x, y;
} oracle_cell;

/* Reads the number of splats of each class into `counts`. */
void oracle_class_counts(oracle_decoder *decoder, uint32_t classes, uint32_t n, uint32_t *counts);
/* Reads one set of n points without priors. */
void oracle_points(oracle_decoder *decoder, const oracle_grid *grid, uint32_t n, oracle_cell *cells);
/* Reads the points of all classes in turn, each with its priors.  False: out of memory. */
bool oracle_positions(oracle_decoder *decoder, uint32_t classes, const uint32_t *counts, const oracle_grid *grids,
                      oracle_cell *cells);

/* ---- Payload (payload.c, attributes.c, codebooks.c) ---- */

typedef struct {
    uint32_t scale, position, angle, luma, chroma, alpha, opacity;
} oracle_steps;

typedef struct {
    uint32_t dimensions, words, bits;
    int32_t min[ORACLE_CHANNELS + 1], max[ORACLE_CHANNELS + 1];
    uint32_t codes[ORACLE_MAX_CLASSES][ORACLE_CHANNELS + 1];
} oracle_codebook;

typedef struct {
    uint32_t position_bits;
    oracle_codebook shapes, colours;
} oracle_codebooks;

/* The codes of a splat. */
typedef struct {
    oracle_cell cell;
    uint32_t class;
    uint32_t aspect, angle, opacity, colour_index;
    uint32_t amplitude, wave, wave_direction, phase;
    int32_t luma, chroma[2], alpha;
} oracle_codes;

typedef struct {
    oracle_header header;
    oracle_decoder decoder;
    uint32_t background[ORACLE_CHANNELS];
    oracle_steps steps;
    oracle_codebooks books;
    oracle_grid grids[ORACLE_MAX_CLASSES];
    oracle_codes *splats;
} oracle_payload;

/* Both return false when memory runs out.  All other errors are in the state of the decoder. */
bool oracle_read_payload(oracle_payload *payload);
bool oracle_read_attributes(oracle_payload *payload);
void oracle_read_codebooks(oracle_decoder *decoder, const oracle_header *header, oracle_codebooks *books);

/* ---- Dequantisation and limits (dequantise.c) ---- */

uint64_t oracle_sigma(const oracle_steps *steps, uint32_t code);
uint32_t oracle_step(const oracle_steps *steps, uint32_t minor);
uint32_t oracle_cells(const oracle_steps *steps, uint32_t minor, uint32_t dimension);
uint32_t oracle_angle_count(const oracle_steps *steps, uint32_t aspect);
int32_t oracle_levels(uint32_t step);
uint32_t oracle_minor(uint32_t class);
/* The range of luma and alpha codes. */
int32_t oracle_luma_min(oracle_blend blend, int32_t levels);
int32_t oracle_luma_max(int32_t levels);
void oracle_dequantise(const oracle_payload *payload, oracle_splat *splats, double *background);
bool oracle_within_limits(const oracle_payload *payload);

#endif
