/* The values of codes in pixels and in colour levels (FORMAT.md, "Dequantisation").  They are integers because cell and
 * angle counts decide how bits are read. */
#ifndef GSCL_FORMAT_QUANTISER_H
#define GSCL_FORMAT_QUANTISER_H

#include "format/types.h"

/* Axis length (sigma) in 1/65536 pixel: 2^(code * (steps->scale + 4) / 32 - 1) pixels, from an
 * integer table; at most 2^15 pixels (larger codes saturate). */
uint64_t gsf_sigma_q16(const gsf_steps *steps, unsigned code);
/* Position step of a splat in 1/256 pixel: sigma_minor * (steps->position + 2) / 32, at least 8. */
uint32_t gsf_position_step_q8(const gsf_steps *steps, unsigned minor);
/* Number of cells of that step that cover `dimension` pixels, rounded up.  Position = (cell + 0.5) * step. */
uint32_t gsf_position_cells(const gsf_steps *steps, unsigned minor, uint32_t dimension);
/* Number of angles in half a turn for an aspect code: ceil(pi / QT * (a - 1/a)) clamped to 1..GSF_MAX_ANGLES with
 * a = 2^(aspect * (steps->scale + 4) / 32), QT = (steps->angle + 2) / 16.  theta = code * pi / count. */
unsigned gsf_angle_count(const gsf_steps *steps, unsigned aspect);
/* Codes per unit of value: luma, chroma and alpha = code / levels.  Levels by index:
 * 4 6 8 11 16 20 24 28 32 40 48 64 96 128 192 255. */
unsigned gsf_colour_levels(unsigned step_index);
/* The range of luma and alpha codes, with L levels: -L/8 .. L + L/8 (blend sum: -L - L/8 .. L + L/8). */
void gsf_luma_range(gsf_blend blend, unsigned step_index, int *min, int *max);
/* The range of Co and Cg codes, with L levels: -L .. L. */
void gsf_chroma_range(unsigned step_index, int *min, int *max);
/* 2^(octaves32 / 32 - 4) in whole pixels, rounded up; octaves32 at most GSF_MAX_OCTAVES32. */
uint32_t gsf_octaves_to_pixels(unsigned octaves32);

#endif
