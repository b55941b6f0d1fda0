/* Coded images made from the bytes of a fuzzed input: each byte is a choice among the values that the format allows. */
#ifndef GSCL_FUZZ_CODED_SCENE_H
#define GSCL_FUZZ_CODED_SCENE_H

#include "byte_source.h"
#include "coded_memory.h"

#define SCENE_MAX_SPLATS 64u
#define SCENE_MAX_BLOCK 300u /* bytes; above 127, from where on a size takes two bytes */

typedef struct coded_scene {
    gsf_coded_image image;
    fuzz_memory *memory;
    gsf_bytes blocks[GSF_BLOCK_COUNT];
    uint8_t block_bytes[GSF_BLOCK_COUNT][SCENE_MAX_BLOCK];
} coded_scene;

/* Makes an image, in `memory`.  All its values are within their limits, but its splats may cover too many pixels. */
void scene_read(coded_scene *scene, fuzz_memory *memory, byte_source *source);

/* Puts one value outside its limits, if the input asks for it.  Returns whether it did. */
bool scene_break(coded_scene *scene, byte_source *source);

#endif
