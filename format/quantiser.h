/* The values of codes in pixels and in colour levels (FORMAT.md, "Dequantisation").  They are integers because cell and
 * angle counts decide how bits are read. */
#ifndef GSCL_FORMAT_QUANTISER_H
#define GSCL_FORMAT_QUANTISER_H

#include "format/types.h"

/* Axis length (sigma) in 1/65536 pixel: 2^(code * (steps->scale + 4) / 32 - 1) pixels, from an
 * integer table; at most 2^15 pixels (larger codes saturate). */
uint64_t gsf_sigma_q16(const gsf_steps *steps, unsigned code);
/* Side of the square cells of a class, in 1/256 pixel: sigma_major * (steps->position + 2) / 32, at least 8. */
uint32_t gsf_position_step_q8(const gsf_steps *steps, unsigned major);
/* Number of cells of that side that cover `dimension` pixels, rounded up. */
uint32_t gsf_position_cells(const gsf_steps *steps, unsigned major, uint32_t dimension);
/* Number of parts into which a cell is divided across the major axis: 2^(aspect * (steps->scale + 4) / 32), rounded; at
 * most 65536. */
uint32_t gsf_position_parts(const gsf_steps *steps, unsigned aspect);
/* Number of angles in half a turn for an aspect code: ceil(pi / QT * (a - 1/a)) clamped to 1..GSF_MAX_ANGLES with
 * a = 2^(aspect * (steps->scale + 4) / 32), QT = (steps->angle + 2) / 16.  theta = code * pi / count. */
unsigned gsf_angle_count(const gsf_steps *steps, unsigned aspect);
/* The splats of the whole picture; a packet takes all packets to have as many as it has. */
uint64_t gsf_all_splats(const gsf_header *header);
/* The major code of a typical splat: the smallest with which as many circles of that sigma have, as squares, the area of
 * the image.  0..GSF_MAX_SCALE_CODE. */
unsigned gsf_typical_size(const gsf_header *header, const gsf_steps *steps);
/* The row of a trained table for a major code: its difference from the typical one, clamped to -below and on, which is row
 * 0, up to the last of the rows. */
uint32_t gsf_size_row(unsigned major, unsigned typical, uint32_t below, uint32_t rows);
/* Whether the major axis of an angle code is closer to the vertical than to the horizontal.  A tie is horizontal. */
bool gsf_angle_is_steep(unsigned angle, unsigned angle_count);

/* The cells in which the centre of one splat lies: those of its class, divided across its major axis.  The centre of
 * cell (x, y) is ((x + 1/2) step / parts_x, (y + 1/2) step / parts_y) in 1/256 pixel. */
typedef struct gsf_splat_grid {
    uint32_t step;
    uint32_t parts_x, parts_y; /* of a cell of the class; at least one of them is 1 */
    uint32_t cells_x, cells_y; /* of the splat: those of the class times the parts */
} gsf_splat_grid;

gsf_splat_grid gsf_splat_grid_of(const gsf_header *header, const gsf_steps *steps, const gsf_splat *splat);

/* Levels per unit of value.  Alpha = code / levels; luma and chroma = code / (levels * fineness).  Levels by index:
 * 4 6 8 11 16 20 24 28 32 40 48 64 96 128 192 255. */
unsigned gsf_colour_levels(unsigned step_index);
/* The areas of splats from which on levels have 2, 3, ... parts: the product of the axes in 1/32 octaves, relative to that
 * of a circle of the pivot's size. */
extern const int16_t gsf_finer_from[GSF_MAX_FINENESS - 1];
/* The parts into which a splat divides each level of luma and chroma: 1..GSF_MAX_FINENESS, more in larger splats, whose
 * colours change more pixels. */
unsigned gsf_colour_fineness(const gsf_steps *steps, unsigned major, unsigned aspect);
/* The level of a code of luma or chroma: code / fineness, rounded down. */
int gsf_colour_level(int code, unsigned fineness);
/* The codes of luma (or, with fineness 1, of alpha) of the levels -L/8 .. L + L/8 (blend sum: -L - L/8 .. L + L/8). */
void gsf_luma_range(gsf_blend blend, unsigned step_index, unsigned fineness, int *min, int *max);
/* The codes of Co and Cg of the levels -L .. L. */
void gsf_chroma_range(unsigned step_index, unsigned fineness, int *min, int *max);
/* 2^(octaves32 / 32 - 4) in whole pixels, rounded up; octaves32 at most GSF_MAX_OCTAVES32. */
uint32_t gsf_octaves_to_pixels(unsigned octaves32);

#endif
