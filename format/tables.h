/* Trained tables (FORMAT.md, "Tables"), made by tests/bench/train_tables.py.  A splat's relative size is its major code
 * less that of a typical splat of the image (gsf_typical_size). */
#ifndef GSCL_FORMAT_TABLES_H
#define GSCL_FORMAT_TABLES_H

#include <stdint.h>

/* Rows: the relative size, from -GSF_ASPECT_BELOW on. */
#define GSF_ASPECT_ROWS 24
#define GSF_ASPECT_COLUMNS 24
#define GSF_ASPECT_BELOW 10
extern const uint8_t gsf_aspect_table[GSF_ASPECT_ROWS * GSF_ASPECT_COLUMNS];

/* Rows: half the aspect code. */
#define GSF_DIRECTION_ROWS 8
#define GSF_DIRECTION_COLUMNS 16
extern const uint8_t gsf_direction_table[GSF_DIRECTION_ROWS * GSF_DIRECTION_COLUMNS];

/* Rows: half the relative size, from -GSF_TEXTURED_BELOW on. */
#define GSF_TEXTURED_ROWS 12
#define GSF_TEXTURED_BELOW 5
extern const uint8_t gsf_textured_table[GSF_TEXTURED_ROWS * 2];

/* One row each. */
extern const uint8_t gsf_amplitude_table[16];
extern const uint8_t gsf_wave_table[16];

/* The weights, in 1/64, of the splats in a class and of those that remain for the classes after it.
 * Entries: the relative size, from -GSF_CLASS_BELOW on. */
#define GSF_CLASS_ROWS 40
#define GSF_CLASS_BELOW 12
extern const uint16_t gsf_class_weight_table[GSF_CLASS_ROWS][2];

#endif
