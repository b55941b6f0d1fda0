/* The gscl file as integers: what FORMAT.md describes, read from and written to bytes.
 *
 * Pure C99: no OpenCL, no stdio, no allocation, no floating point.  All memory is the caller's.
 * Everything an independent decoder needs is in this folder; names follow FORMAT.md. */
#ifndef GSCL_FORMAT_FORMAT_H
#define GSCL_FORMAT_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define GSF_VERSION 1
#define GSF_MAX_DIMENSION 16384 /* pixels, width and height */
#define GSF_MAX_SPLATS (1u << 20)
#define GSF_MAX_CODEBOOK 1024 /* code words in either codebook */
#define GSF_MAX_CHANNELS 4

typedef enum gsf_result {
    GSF_OK = 0,
    GSF_NOT_GSCL,      /* the magic bytes are missing */
    GSF_NEWER_VERSION, /* a format version that this code does not know */
    GSF_TRUNCATED,     /* the file ends before its content does */
    GSF_DAMAGED,       /* the checksum does not match */
    GSF_CORRUPT,       /* the checksum matches but a value is outside the format's limits */
    GSF_NO_SPACE,      /* the caller's buffer is too small */
    GSF_INVALID        /* (writer) the picture breaks a rule of the format */
} gsf_result;

typedef enum gsf_blend { GSF_BLEND_NORMALIZED = 0, GSF_BLEND_ALPHA = 1, GSF_BLEND_SUM = 2 } gsf_blend;

/* How splats are written: each parameter quantised on its own in the splat's frame, or shape and
 * colour as indices into two codebooks. */
typedef enum gsf_coding { GSF_CODING_SCALAR = 0, GSF_CODING_CODEBOOK = 1 } gsf_coding;

/* What the source image was, so that decoding gives back the same kind of image. */
typedef enum gsf_layout { GSF_GREY = 0, GSF_GREY_ALPHA = 1, GSF_RGB = 2, GSF_RGBA = 3 } gsf_layout;

typedef struct gsf_header {
    uint8_t version;
    gsf_blend blend;
    gsf_coding coding;
    gsf_layout layout;
    bool high_bit_depth;    /* the source had 16 bits (or float) a sample; else 8 */
    bool has_chroma;        /* effect: colour differences are coded */
    bool has_alpha;         /* effect: an alpha plane is coded; else alpha is 1 everywhere */
    bool has_opacity;       /* effect: each splat has an opacity; else it is 1 (normalized: weight 1) */
    bool has_texture;       /* effect: splats may carry a wave; scalar coding only */
    bool has_rotation;      /* effect: splats have an angle; else it is 0 */
    bool has_anisotropy;    /* effect: splats have two axes; else they are round (and have no angle) */
    uint32_t width, height; /* pixels, 1..GSF_MAX_DIMENSION */
    uint32_t splat_count;   /* 0..GSF_MAX_SPLATS */
} gsf_header;

/* Quantiser steps of scalar coding, as the indices that are stored (0..15 each); the functions
 * below say what they mean in pixels and in colour. */
typedef struct gsf_steps {
    uint8_t scale, position, angle, luma, chroma, alpha, opacity;
} gsf_steps;

#define GSF_MAX_SCALE_CODE 63
#define GSF_MAX_ANGLES 512

/* Axis length (sigma) in 1/65536 pixel: 2^(code * (steps->scale + 4) / 32 - 1) pixels, from an
 * integer table; at most 2^15 pixels (larger codes saturate). */
uint64_t gsf_sigma_q16(const gsf_steps *steps, unsigned code);
/* Position step of a splat in 1/256 pixel: sigma_minor * (steps->position + 2) / 32, at least 8. */
uint32_t gsf_position_step_q8(const gsf_steps *steps, unsigned minor);
/* Cells of that step that cover `dimension` pixels (rounded up); position = (cell + 0.5) * step. */
uint32_t gsf_position_cells(const gsf_steps *steps, unsigned minor, uint32_t dimension);
/* Angles in half a turn for an aspect code: ceil(pi / QT * (a - 1/a)) clamped to 1..GSF_MAX_ANGLES with
 * a = 2^(aspect * (steps->scale + 4) / 32), QT = (steps->angle + 2) / 16.  theta = code * pi / count. */
unsigned gsf_angle_count(const gsf_steps *steps, unsigned aspect);
/* Codes per unit of value: luma, chroma and alpha = code / levels.  Levels by index:
 * 4 6 8 11 16 20 24 28 32 40 48 64 96 128 192 255. */
unsigned gsf_colour_levels(unsigned step_index);
/* The range of codes: luma and alpha -L/8 .. L + L/8 (blend sum: -L - L/8 ..), chroma -L .. L. */
void gsf_luma_range(gsf_blend blend, unsigned step_index, int *min, int *max);
void gsf_chroma_range(unsigned step_index, int *min, int *max);
/* 2^(octaves32 / 32 - 4) in whole pixels, rounded up; octaves32 at most GSF_MAX_OCTAVES32. */
uint32_t gsf_octaves_to_pixels(unsigned octaves32);
/* Opacity = (code + 1) / levels with levels = steps->opacity + 1. */

/* A wave on a splat's colours: amplitude * cos(2 pi * distance along the direction / wavelength - phase). */
#define GSF_WAVES 16      /* wavelength = 2.5 * 2^(7 * wave / 16) pixels */
#define GSF_DIRECTIONS 16 /* of half a turn; also the bins of the angle's histogram */
#define GSF_PHASES 8      /* of a turn */
#define GSF_AMPLITUDES 16 /* amplitude = 4 * code / (3 * colour levels of the luma step); 0: no wave */
typedef struct gsf_texture {
    uint8_t wave, direction, phase; /* 0 where the amplitude is 0 */
    uint8_t amplitude;              /* 0..GSF_AMPLITUDES */
} gsf_texture;

/* One splat in scalar coding.  The stored order is canonical (FORMAT.md, "Order"): the writer
 * sorts, the reader returns splats in that order, and `alpha` blends the last splat in front. */
typedef struct gsf_splat {
    uint16_t minor;              /* minor-axis code, 0..63: sigma = 2^(minor * scale_step / 32 - 1) pixels */
    uint16_t aspect;             /* major-axis code minus minor-axis code, 0..63 */
    uint16_t angle;              /* 0..gsf_angle_count(steps, aspect) - 1, of half a turn */
    uint16_t opacity;            /* 0..opacity levels - 1 */
    uint32_t x, y;               /* cell of the splat's own position grid */
    int16_t luma, co, cg, alpha; /* colour codes */
    gsf_texture texture;
} gsf_splat;

/* One splat in codebook coding. */
typedef struct gsf_indexed_splat {
    uint16_t shape, colour; /* code word indices */
    uint16_t x, y;          /* 0..2^position_bits - 1 between the stored minimum and maximum */
} gsf_indexed_splat;

/* Uniform b-bit quantiser between two stored ends (paper eq. 7-8):
 * value = (min + code * (max - min) / (2^bits - 1)) / unit, code in 0..2^bits - 1. */
typedef struct gsf_range {
    int32_t min, max; /* in the dimension's unit, min <= max */
} gsf_range;

/* Dimensions of a shape code word: s1, s2 (unit 1/32 octave above 1/16 pixel: sigma = 2^(value / 32 - 4) pixels,
 * 0..GSF_MAX_OCTAVES32), theta (unit pi/256, 0..256).
 * Of a colour code word: the coded channels (Y, or R G B; then alpha if coded) and then the opacity
 * if coded, each in units of 1/255, range ends -255..510 (opacity 0..255). */
#define GSF_SHAPE_DIMS 3
#define GSF_MAX_OCTAVES32 640
#define GSF_MAX_COLOUR_DIMS 5
typedef struct gsf_codebooks {
    uint16_t shape_count, colour_count; /* code words, 1..GSF_MAX_CODEBOOK when there are splats */
    uint8_t position_bits;              /* 1..16: x = (code + 0.5) / 2^bits * width; y likewise */
    uint8_t shape_bits, colour_bits;    /* 1..16: of each dimension of a code word */
    gsf_range shape[GSF_SHAPE_DIMS];
    gsf_range colour[GSF_MAX_COLOUR_DIMS];
    uint16_t (*shape_words)[GSF_SHAPE_DIMS];       /* caller's, GSF_MAX_CODEBOOK rows; the writer wants
                                                      dimension 0 non-increasing: that is the drawing order */
    uint16_t (*colour_words)[GSF_MAX_COLOUR_DIMS]; /* caller's, GSF_MAX_CODEBOOK rows; dimension 0
                                                      non-decreasing */
} gsf_codebooks;

/* Where the bits went, for `gscl info`. */
typedef enum gsf_stream {
    GSF_STREAM_HEADER,   /* header and checksum */
    GSF_STREAM_SIDE,     /* background, steps or ranges */
    GSF_STREAM_CODEBOOK, /* code words */
    GSF_STREAM_POSITION,
    GSF_STREAM_SCALE, /* minor, aspect */
    GSF_STREAM_ANGLE,
    GSF_STREAM_LUMA,
    GSF_STREAM_CHROMA,
    GSF_STREAM_ALPHA,
    GSF_STREAM_OPACITY,
    GSF_STREAM_TEXTURE,
    GSF_STREAM_SHAPE_INDEX,
    GSF_STREAM_COLOUR_INDEX,
    GSF_STREAM_COUNT
} gsf_stream;

/* A whole picture. */
typedef struct gsf_coded_image {
    gsf_header header;
    uint16_t background[GSF_MAX_CHANNELS]; /* coded channels (Y, or R G B; then alpha), in 1/255 (deep: 1/65535) */
    gsf_steps steps;                       /* scalar coding */
    gsf_splat *splats;                     /* scalar coding: caller's array of splat_count */
    gsf_codebooks codebooks;               /* codebook coding */
    gsf_indexed_splat *indexed;            /* codebook coding: caller's array of splat_count */
    uint64_t *stream_bits256; /* out: 1/256 bits spent, by stream: caller's GSF_STREAM_COUNT numbers, or NULL */
} gsf_coded_image;

/* Channels that the picture codes: 1 or 3 colours plus 1 for alpha. */
unsigned gsf_channel_count(const gsf_header *header);

/* Reads the header alone and checks its limits; needs no memory.  The checksum is not looked at.
 * Call it first to learn coding and splat_count, then provide arrays and call gsf_read. */
gsf_result gsf_read_header(const uint8_t *bytes, size_t size, gsf_header *header);

/* Reads and checks everything.  `splats` or `indexed` (and the codebook arrays) must be in place.
 * Never reads outside bytes[0..size), whatever it holds. */
gsf_result gsf_read(const uint8_t *bytes, size_t size, gsf_coded_image *picture, void *scratch);

/* Bytes of working memory (aligned for uint64_t) that gsf_read and gsf_write want at `scratch`. */
size_t gsf_scratch_size(const gsf_header *header);

/* An upper bound of the size of the written file. */
size_t gsf_write_bound(const gsf_coded_image *picture);

/* Writes the picture and returns its size in *size.  Ignores header.version, and sets it.  Codes of
 * effects that are off are ignored, and zero afterwards.  GSF_INVALID also when the splats together cover more
 * pixels than FORMAT.md's "Limits" allow.  Sorts picture->splats (or ->indexed) into the
 * stored order in place, so that afterwards the picture equals what gsf_read would give.
 * The file is a function of the picture alone. */
gsf_result gsf_write(gsf_coded_image *picture, uint8_t *bytes, size_t capacity, size_t *size, void *scratch);

/* Sorts the splats into the stored order without writing: `alpha` depends on it.  Zeroes the codes of
 * effects that are off.  The codes must be within their limits. */
void gsf_sort(gsf_coded_image *picture, void *scratch);

#endif
