/* Synthetic coded images, in the codes of the file. */
#ifndef GSCL_SYNTHETIC_SCENE_H
#define GSCL_SYNTHETIC_SCENE_H

#include "format/format.h"

typedef struct {
    gsf_coded_image image; /* its arrays hold header.splat_count splats */
    uint16_t shape_words[GSF_MAX_CODEBOOK][GSF_SHAPE_DIMS];
    uint16_t colour_words[GSF_MAX_CODEBOOK][GSF_MAX_COLOUR_DIMS];
} synthetic_scene;

/* A scene of zeros; NULL when memory runs out. */
synthetic_scene *synthetic_scene_new(const gsf_header *header);
void synthetic_scene_free(synthetic_scene *scene);
/* Writes the scene into a new buffer, which the caller frees, also after an error. */
gsf_result synthetic_scene_write(synthetic_scene *scene, uint8_t **bytes, size_t *size);

extern uint32_t synthetic_random_state;
/* A pseudo-random number 0..count - 1. */
uint32_t synthetic_random(uint32_t count);
/* A pseudo-random number between the two. */
float synthetic_uniform(double low, double high);

/* A random header; twelve consecutive numbers have all combinations of blend and layout. */
gsf_header synthetic_header(int number, gsf_coding coding);

/* Fill the named part of an image with random codes that its header allows. */
void synthetic_background(gsf_coded_image *image);
void synthetic_steps(gsf_coded_image *image);
void synthetic_colour(const gsf_coded_image *image, gsf_splat *splat);
/* A splat of this shape at a random position, with random angle and colour. */
void synthetic_splat(const gsf_coded_image *image, gsf_splat *splat, unsigned minor, unsigned aspect);
/* Moves a splat to the cell that contains a position in pixels, or to the nearest cell. */
void synthetic_place_splat(const gsf_coded_image *image, gsf_splat *splat, double x, double y);
/* Writes a file of the most frequent kind, RGB in scalar coding, with splats of some pixels each, into a new buffer, which the
 * caller frees.  Returns false when memory runs out. */
bool synthetic_file(uint32_t width, uint32_t height, uint32_t splats, uint8_t **bytes, size_t *size);
/* A file of a random kind, of which twelve numbers have all blends and layouts, with splats of some pixels each. */
typedef struct {
    uint32_t width, height, splats;
    gsf_coding coding;
    bool bare;
} synthetic_kind;
/* Writes it into a new buffer, which the caller frees, also after an error. */
gsf_result synthetic_file_of_kind(const synthetic_kind *kind, int number, uint8_t **bytes, size_t *size);
/* Random codebooks with axes up to `longest` 32nds of an octave above 1/16 pixel, and random splats that use them. */
void synthetic_codebooks(gsf_coded_image *image, int32_t longest);

#endif
