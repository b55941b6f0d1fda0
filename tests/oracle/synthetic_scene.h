/* Pictures made by hand, in the codes of the file. */
#ifndef GSCL_SYNTHETIC_SCENE_H
#define GSCL_SYNTHETIC_SCENE_H

#include "format/format.h"

typedef struct {
    gsf_coded_image picture; /* its arrays have room for header.splat_count splats */
    uint16_t shape_words[GSF_MAX_CODEBOOK][GSF_SHAPE_DIMS];
    uint16_t colour_words[GSF_MAX_CODEBOOK][GSF_MAX_COLOUR_DIMS];
} synthetic_scene;

/* A scene of zeros; NULL when there is no memory. */
synthetic_scene *synthetic_scene_new(const gsf_header *header);
void synthetic_scene_free(synthetic_scene *scene);
/* Writes the scene into a new buffer (free), even where gsf_write refuses it. */
gsf_result synthetic_scene_write(synthetic_scene *scene, uint8_t **bytes, size_t *size);

extern uint32_t synthetic_random_state;
/* 0..count - 1 */
uint32_t synthetic_random(uint32_t count);
/* Anywhere between the two. */
float synthetic_uniform(double low, double high);

/* Number `number` of a row of headers that visits all blends and layouts. */
gsf_header synthetic_header(int number, gsf_coding coding);
void synthetic_background(gsf_coded_image *picture);
void synthetic_steps(gsf_coded_image *picture);
void synthetic_colour(const gsf_coded_image *picture, gsf_splat *splat);
/* A splat of this shape anywhere, in any direction. */
void synthetic_splat(const gsf_coded_image *picture, gsf_splat *splat, unsigned minor, unsigned aspect);
/* Moves a splat to the cell that holds a place in pixels, or the nearest to it. */
void synthetic_place_splat(const gsf_coded_image *picture, gsf_splat *splat, double x, double y);
/* Codebooks with axes up to `longest` 32nds of an octave above 1/16 pixel, and splats that use them. */
void synthetic_codebooks(gsf_coded_image *picture, int32_t longest);

#endif
