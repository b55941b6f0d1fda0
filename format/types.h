/* The types and limits of a gscl file as integers.  Names follow FORMAT.md.  All arrays belong to the caller. */
#ifndef GSCL_FORMAT_TYPES_H
#define GSCL_FORMAT_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define GSF_VERSION 2
#define GSF_MAX_DIMENSION 16384 /* pixels, width and height */
#define GSF_MAX_SPLATS (1u << 20)
#define GSF_MAX_CODEBOOK 1024 /* code words in either codebook */
#define GSF_MAX_CHANNELS 4
#define GSF_MAX_LAYERS 8
#define GSF_MAX_PACKETS 256
#define GSF_NO_IDENTITY 0xC7u /* no packet begins with it: files do */

typedef enum gsf_result {
    GSF_OK = 0,
    GSF_NOT_GSCL,      /* the magic bytes are missing */
    GSF_NEWER_VERSION, /* a format version above GSF_VERSION */
    GSF_TRUNCATED,     /* the file ends before its content does */
    GSF_DAMAGED,       /* the check does not match */
    GSF_CORRUPT,       /* the check matches, but the file breaks a rule of the format */
    GSF_UNKNOWN_BLOCK, /* a block of an unknown type that a reader must understand */
    GSF_NO_SPACE,      /* the caller's buffer is too small */
    GSF_INVALID        /* (writer) the image breaks a rule of the format */
} gsf_result;

typedef enum gsf_blend { GSF_BLEND_NORMALIZED = 0, GSF_BLEND_ALPHA = 1, GSF_BLEND_SUM = 2 } gsf_blend;

/* How splats are written: each parameter quantised on its own in the splat's frame, or shape and colour as indices
 * into two codebooks. */
typedef enum gsf_coding { GSF_CODING_SCALAR = 0, GSF_CODING_CODEBOOK = 1 } gsf_coding;

/* The kind of the source image.  Decoding returns the same kind. */
typedef enum gsf_layout { GSF_GREY = 0, GSF_GREY_ALPHA = 1, GSF_RGB = 2, GSF_RGBA = 3 } gsf_layout;

typedef struct gsf_header {
    gsf_blend blend;
    gsf_coding coding;
    gsf_layout layout;
    bool high_bit_depth;        /* the source had 16 bits (or float) a sample; else 8 */
    bool has_chroma;            /* effect: colour differences are coded */
    bool has_alpha;             /* effect: an alpha plane is coded; else alpha is 1 everywhere */
    bool has_opacity;           /* effect: each splat has an opacity; else it is 1 (normalized: weight 1) */
    bool has_texture;           /* effect: splats may carry a wave; scalar coding only */
    bool has_rotation;          /* effect: splats have an angle; else it is 0 */
    bool has_anisotropy;        /* effect: splats have two axes; else they are isotropic (and have no angle) */
    uint32_t width, height;     /* pixels, 1..GSF_MAX_DIMENSION */
    uint32_t splat_count;       /* 0..GSF_MAX_SPLATS */
    uint8_t enhancement_layers; /* layers of splats after the base layer, 0..GSF_MAX_LAYERS - 1; scalar coding only */
    uint16_t packets; /* of a packet: how many the picture has, 1..GSF_MAX_PACKETS; 0: it is a whole picture.  That of
                         gsf_read_header for a list, too */
    uint8_t packet;   /* of a packet: its number */
} gsf_header;

/* A program that must be small and reads no packets defines GSF_WITHOUT_PACKETS: it has no code for them, and takes a list of
 * packets for no gscl file. */
#ifdef GSF_WITHOUT_PACKETS
#define GSF_HAS_PACKETS false
#else
#define GSF_HAS_PACKETS true
#endif

/* The field `packets`, as functions that read take it. */
static inline uint32_t gsf_header_packets(const gsf_header *header) {
    return GSF_HAS_PACKETS ? header->packets : 0;
}

/* Quantiser steps of scalar coding, as the indices that are stored (0..15 each).  quantiser.h converts them to pixels
 * and colour levels. */
typedef struct gsf_steps {
    uint8_t scale, position, angle, luma, chroma, alpha, opacity;
    uint8_t pivot; /* the code of the axis of circles to which the fineness of colours refers, 0..GSF_MAX_SCALE_CODE */
} gsf_steps;

#define GSF_MAX_SCALE_CODE 63
#define GSF_MAX_FINENESS 8 /* parts of a level of luma and chroma */
#define GSF_MAX_ANGLES 512

/* A wave on a splat's colours: amplitude * cos(2 pi * distance along the direction / wavelength - phase). */
#define GSF_WAVES 16      /* wavelength = 2.5 * 2^(7 * wave / 16) pixels */
#define GSF_DIRECTIONS 16 /* of half a turn; also the bins of the angle's histogram */
#define GSF_PHASES 8      /* of a turn */
#define GSF_AMPLITUDES 16 /* amplitude = 4 * code / (3 * colour levels of the luma step); 0: no wave */
typedef struct gsf_texture {
    uint8_t wave, direction, phase; /* 0 where the amplitude is 0 */
    uint8_t amplitude;              /* 0..GSF_AMPLITUDES */
} gsf_texture;

/* One splat in scalar coding.  The struct has no padding, because splats are compared as bytes. */
typedef struct gsf_splat {
    uint16_t major;              /* code of the major axis, 0..63: sigma = 2^(major * scale_step / 32 - 1) pixels */
    uint16_t aspect;             /* code of the major axis less that of the minor axis, 0..major */
    uint16_t angle;              /* 0..gsf_angle_count(steps, aspect) - 1, of half a turn */
    uint16_t opacity;            /* 0..opacity levels - 1 */
    uint32_t layer;              /* 0 (base) .. header.enhancement_layers */
    uint32_t x, y;               /* cell of the splat's own grid, see gsf_splat_grid */
    int16_t luma, co, cg, alpha; /* colour codes; luma, co and cg in parts of levels, see gsf_colour_fineness */
    gsf_texture texture;
} gsf_splat;

/* One splat in codebook coding. */
typedef struct gsf_indexed_splat {
    uint16_t shape, colour; /* code word indices */
    uint16_t x, y;          /* 0..2^position_bits - 1, of the width and of the height */
} gsf_indexed_splat;

/* Uniform b-bit quantiser between two stored ends (paper eq. 7-8):
 * value = (min + code * (max - min) / (2^bits - 1)) / unit, code in 0..2^bits - 1. */
typedef struct gsf_range {
    int32_t min, max; /* in the dimension's unit, min <= max */
} gsf_range;

/* A shape code word has s1, s2 (unit 1/32 octave above 1/16 pixel: sigma = 2^(value / 32 - 4) pixels,
 * 0..GSF_MAX_OCTAVES32) and theta (unit pi/256, 0..256).
 * A colour code word has the coded channels (Y, or R G B; then alpha if coded) and then the opacity if coded, each in
 * units of 1/255, with range ends -255..510 (opacity 0..255). */
#define GSF_SHAPE_DIMS 3
#define GSF_MAX_OCTAVES32 640
#define GSF_MAX_COLOUR_DIMS 5
typedef struct gsf_codebooks {
    uint16_t shape_count, colour_count; /* code words, 1..GSF_MAX_CODEBOOK when there are splats */
    uint8_t position_bits;              /* 1..16: x = (code + 0.5) / 2^bits * width; y likewise */
    uint8_t shape_bits, colour_bits;    /* 1..16: of each dimension of a code word */
    gsf_range shape[GSF_SHAPE_DIMS];
    gsf_range colour[GSF_MAX_COLOUR_DIMS];
    /* GSF_MAX_CODEBOOK rows.  Dimension 0 must not increase from word to word: that is the drawing order. */
    uint16_t (*shape_words)[GSF_SHAPE_DIMS];
    /* GSF_MAX_CODEBOOK rows.  Dimension 0 must not decrease from word to word. */
    uint16_t (*colour_words)[GSF_MAX_COLOUR_DIMS];
} gsf_codebooks;

/* Blocks around the picture, of which a file has at most one of each type. */
typedef enum gsf_block_type {
    GSF_BLOCK_COLOUR_SPACE, /* before the picture */
    GSF_BLOCK_ICC,
    GSF_BLOCK_EXIF, /* after the picture */
    GSF_BLOCK_XMP,
    GSF_BLOCK_COUNT
} gsf_block_type;

#define GSF_MAX_BLOCK_SIZE ((1u << 21) - 1) /* bytes of content */
#define GSF_COLOUR_SPACE_SIZE 2u            /* bytes: code points of the primaries and of the transfer function */

typedef struct gsf_bytes {
    const uint8_t *data; /* NULL: there are none */
    size_t size;
} gsf_bytes;

/* The parts of a file among which the bits are counted. */
typedef enum gsf_stream {
    GSF_STREAM_CONTAINER, /* magic, version and check */
    GSF_STREAM_BLOCKS,
    GSF_STREAM_HEADER,   /* flags, size, number of splats */
    GSF_STREAM_SIDE,     /* steps or ranges, background */
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

/* A whole coded image.  The stored order of its splats is canonical (FORMAT.md, "Order"): reading returns it, and the
 * blend `alpha` draws in it, the last splat in front. */
typedef struct gsf_coded_image {
    gsf_header header;
    bool has_mean_background;              /* the background is the mean of the splats' colours; not without splats */
    uint16_t background[GSF_MAX_CHANNELS]; /* otherwise: coded channels (Y, or R G B; then alpha), in 1/255 or, with
                                              high_bit_depth, in 1/65535 */
    gsf_steps steps;                       /* scalar coding */
    gsf_splat *splats;                     /* scalar coding: array of splat_count */
    gsf_codebooks codebooks;               /* codebook coding */
    gsf_indexed_splat *indexed;            /* codebook coding: array of splat_count */
    uint64_t *stream_bits256;              /* out: 1/256 bits of each stream, GSF_STREAM_COUNT numbers; may be NULL */
    bool bare;                             /* in: the file is the picture alone */
    uint8_t identity;                      /* in, writing a packet: of its picture, not GSF_NO_IDENTITY */
    uint32_t packets_read;                 /* out, reading a list of packets: those whose splats it has */
    const gsf_bytes *blocks;               /* in, writing: GSF_BLOCK_COUNT of them, or NULL; without `bare` only */
} gsf_coded_image;

#endif
