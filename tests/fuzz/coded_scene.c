#include "coded_scene.h"

#include <stdlib.h>
#include <string.h>

#include "format/header.h"

/* ---- The header -------------------------------------------------------------------------------- */

static uint32_t read_dimension(byte_source *source) {
    static const uint16_t lengths[] = {1, 2, 3, 16, 40, 129, 768, GSF_MAX_DIMENSION};
    const int choice = source_within(source, 0, 11);
    return choice < 8 ? lengths[choice] : (uint32_t)source_within(source, 1, choice < 10 ? 256 : GSF_MAX_DIMENSION);
}

static void read_header(gsf_header *header, byte_source *source) {
    const int kind = source_byte(source);
    header->coding = kind % 3 == 2 ? GSF_CODING_CODEBOOK : GSF_CODING_SCALAR;
    header->blend = (gsf_blend)(kind / 3 % 3);
    header->layout = (gsf_layout)(kind / 9 % 4);
    const bool has_colour = header->layout >= GSF_RGB, has_transparency = header->layout % 2 != 0;
    const int effects = source_byte(source);
    header->high_bit_depth = effects & 1;
    header->has_chroma = has_colour && (effects & 2) != 0;
    header->has_alpha = has_transparency && (effects & 4) != 0;
    header->has_opacity = (effects & 8) != 0;
    header->has_anisotropy = (effects & 16) != 0;
    header->has_rotation = header->has_anisotropy && (effects & 32) != 0;
    header->has_texture = header->coding == GSF_CODING_SCALAR && (effects & 64) != 0;
    header->width = read_dimension(source);
    header->height = read_dimension(source);
    header->splat_count = (uint32_t)source_within(source, 0, SCENE_MAX_SPLATS);
    if (header->coding == GSF_CODING_SCALAR && header->splat_count > 0 && (effects & 128) != 0)
        header->enhancement_layers = (uint8_t)source_within(source, 0, GSF_MAX_LAYERS - 1);
}

static void read_background(gsf_coded_image *image, byte_source *source) {
    image->has_mean_background = image->header.splat_count > 0 && source_flag(source);
    for (unsigned i = 0; i < gsf_channel_count(&image->header) && !image->has_mean_background; i++)
        image->background[i] = (uint16_t)source_within(source, 0, image->header.high_bit_depth ? 65535 : 255);
}

/* ---- Scalar coding ------------------------------------------------------------------------------ */

static void read_steps(gsf_steps *steps, byte_source *source) {
    uint8_t *codes[] = {&steps->scale,  &steps->position, &steps->angle,  &steps->luma,
                        &steps->chroma, &steps->alpha,    &steps->opacity};
    for (size_t i = 0; i < sizeof codes / sizeof *codes; i++)
        *codes[i] = (uint8_t)source_within(source, 0, 15);
    steps->pivot = (uint8_t)source_within(source, 0, GSF_MAX_SCALE_CODE);
}

static void read_colour(const gsf_coded_image *image, gsf_splat *splat, byte_source *source) {
    const gsf_header *header = &image->header;
    const unsigned fineness = gsf_colour_fineness(&image->steps, splat->major, splat->aspect);
    int min, max;
    gsf_luma_range(header->blend, image->steps.luma, fineness, &min, &max);
    splat->luma = (int16_t)source_within(source, min, max);
    gsf_chroma_range(image->steps.chroma, fineness, &min, &max);
    splat->co = (int16_t)(header->has_chroma ? source_within(source, min, max) : 0);
    splat->cg = (int16_t)(header->has_chroma ? source_within(source, min, max) : 0);
    gsf_luma_range(header->blend, image->steps.alpha, 1, &min, &max);
    splat->alpha = (int16_t)(header->has_alpha ? source_within(source, min, max) : 0);
    splat->opacity = (uint16_t)(header->has_opacity ? source_within(source, 0, image->steps.opacity) : 0);
}

static void read_texture(gsf_texture *texture, byte_source *source) {
    texture->amplitude = (uint8_t)source_within(source, 0, 2 * GSF_AMPLITUDES);
    if (texture->amplitude > GSF_AMPLITUDES)
        texture->amplitude = 0;
    if (texture->amplitude == 0)
        return;
    texture->wave = (uint8_t)source_within(source, 0, GSF_WAVES - 1);
    texture->direction = (uint8_t)source_within(source, 0, GSF_DIRECTIONS - 1);
    texture->phase = (uint8_t)source_within(source, 0, GSF_PHASES - 1);
}

/* A cell out of `count`; the last is as likely as all others of a large grid. */
static uint32_t read_cell(uint32_t count, byte_source *source) {
    const uint32_t value =
        (uint32_t)source_byte(source) << 16 | (uint32_t)source_byte(source) << 8 | source_byte(source);
    return value >> 20 == 15 ? count - 1 : value % count;
}

static void read_splat(gsf_coded_image *image, gsf_splat *splat, byte_source *source) {
    const gsf_header *header = &image->header;
    *splat = (gsf_splat){.layer = (uint32_t)source_within(source, 0, header->enhancement_layers)};
    splat->major = (uint16_t)source_within(source, 0, GSF_MAX_SCALE_CODE);
    splat->aspect = (uint16_t)(header->has_anisotropy ? source_within(source, 0, splat->major) : 0);
    if (header->has_rotation)
        splat->angle = (uint16_t)source_within(source, 0, (int)gsf_angle_count(&image->steps, splat->aspect) - 1);
    read_colour(image, splat, source);
    if (header->has_texture)
        read_texture(&splat->texture, source);
    const gsf_splat_grid grid = gsf_splat_grid_of(header, &image->steps, splat);
    splat->x = read_cell(grid.cells_x, source);
    splat->y = read_cell(grid.cells_y, source);
}

/* Some splats are copies of the one before. */
static void read_splats(gsf_coded_image *image, byte_source *source) {
    read_steps(&image->steps, source);
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        if (i > 0 && source_within(source, 0, 7) == 7)
            image->splats[i] = image->splats[i - 1];
        else
            read_splat(image, &image->splats[i], source);
    }
}

/* ---- Codebook coding ---------------------------------------------------------------------------- */

static gsf_range read_range(int min, int max, byte_source *source) {
    const int first = source_within(source, min, max);
    return (gsf_range){first, source_within(source, first, max)};
}

static int compare_words(const void *a, const void *b) {
    return *(const uint16_t *)a - *(const uint16_t *)b;
}

static void read_shapes(gsf_codebooks *books, byte_source *source) {
    uint16_t first[SCENE_MAX_SPLATS];
    const int peak = (1 << books->shape_bits) - 1;
    for (unsigned i = 0; i < books->shape_count; i++)
        first[i] = (uint16_t)source_within(source, 0, peak);
    qsort(first, books->shape_count, sizeof *first, compare_words);
    for (unsigned i = 0; i < books->shape_count; i++) {
        books->shape_words[i][0] = first[books->shape_count - 1 - i];
        for (unsigned d = 1; d < GSF_SHAPE_DIMS; d++)
            books->shape_words[i][d] = (uint16_t)source_within(source, 0, peak);
    }
}

static void read_colours(gsf_codebooks *books, byte_source *source) {
    uint16_t first[SCENE_MAX_SPLATS];
    const int peak = (1 << books->colour_bits) - 1;
    for (unsigned i = 0; i < books->colour_count; i++)
        first[i] = (uint16_t)source_within(source, 0, peak);
    qsort(first, books->colour_count, sizeof *first, compare_words);
    for (unsigned i = 0; i < books->colour_count; i++) {
        books->colour_words[i][0] = first[i];
        for (unsigned d = 1; d < GSF_MAX_COLOUR_DIMS; d++)
            books->colour_words[i][d] = (uint16_t)source_within(source, 0, peak);
    }
}

/* The last dimension of a colour is the opacity where opacities are coded, within 0..255. */
static void read_books(const gsf_header *header, gsf_codebooks *books, byte_source *source) {
    books->shape_count = (uint16_t)source_within(source, 1, SCENE_MAX_SPLATS);
    books->colour_count = (uint16_t)source_within(source, 1, SCENE_MAX_SPLATS);
    books->position_bits = (uint8_t)source_within(source, 1, 16);
    books->shape_bits = (uint8_t)source_within(source, 1, 16);
    books->colour_bits = (uint8_t)source_within(source, 1, 16);
    for (unsigned d = 0; d < GSF_SHAPE_DIMS; d++)
        books->shape[d] = read_range(0, d < 2 ? GSF_MAX_OCTAVES32 : 256, source);
    const unsigned dims = gsf_channel_count(header) + header->has_opacity;
    for (unsigned d = 0; d < dims; d++)
        books->colour[d] =
            header->has_opacity && d + 1 == dims ? read_range(0, 255, source) : read_range(-255, 510, source);
    read_shapes(books, source);
    read_colours(books, source);
}

static void read_indexed(gsf_coded_image *image, byte_source *source) {
    gsf_codebooks *books = &image->codebooks;
    if (image->header.splat_count == 0)
        return;
    read_books(&image->header, books, source);
    const int last_place = (1 << books->position_bits) - 1;
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        gsf_indexed_splat *splat = &image->indexed[i];
        splat->shape = (uint16_t)source_within(source, 0, books->shape_count - 1);
        splat->colour = (uint16_t)source_within(source, 0, books->colour_count - 1);
        splat->x = (uint16_t)source_within(source, 0, last_place);
        splat->y = (uint16_t)source_within(source, 0, last_place);
    }
}

/* ---- The whole image ---------------------------------------------------------------------------- */

static void read_block(coded_scene *scene, gsf_block_type type, byte_source *source) {
    gsf_bytes *block = &scene->blocks[type];
    uint8_t *bytes = scene->block_bytes[type];
    *block = (gsf_bytes){NULL, 0};
    if (source_within(source, 0, 2) != 0)
        return;
    block->size =
        type == GSF_BLOCK_COLOUR_SPACE ? GSF_COLOUR_SPACE_SIZE : (size_t)source_within(source, 0, SCENE_MAX_BLOCK);
    block->data = bytes;
    memset(bytes, source_byte(source), SCENE_MAX_BLOCK);
}

static void read_form(coded_scene *scene, byte_source *source) {
    const int form = source_within(source, 0, 2);
    scene->image.bare = form == 0;
    if (form < 2)
        return;
    for (int type = 0; type < GSF_BLOCK_COUNT; type++)
        read_block(scene, (gsf_block_type)type, source);
    scene->image.blocks = scene->blocks;
}

void scene_read(coded_scene *scene, fuzz_memory *memory, byte_source *source) {
    gsf_header header = {0};
    scene->memory = memory;
    read_header(&header, source);
    fuzz_require(fuzz_create(&scene->image, memory, &header), "a scene has more splats than was planned");
    read_form(scene, source);
    read_background(&scene->image, source);
    if (header.coding == GSF_CODING_SCALAR)
        read_splats(&scene->image, source);
    else
        read_indexed(&scene->image, source);
}

/* ---- Values outside their limits ---------------------------------------------------------------- */

static void break_header(gsf_header *header, byte_source *source) {
    switch (source_within(source, 0, 4)) {
    case 0:
        header->width = GSF_MAX_DIMENSION + 1u + source_byte(source);
        break;
    case 1:
        header->height = 0;
        break;
    case 2:
        header->enhancement_layers = (uint8_t)(GSF_MAX_LAYERS + source_byte(source) % 8);
        break;
    case 3:
        header->layout = (gsf_layout)(GSF_RGBA + 1 + source_byte(source));
        break;
    default:
        header->blend = (gsf_blend)(GSF_BLEND_SUM + 1 + source_byte(source));
    }
}

static void break_splat(gsf_coded_image *image, byte_source *source) {
    gsf_splat *splat = &image->splats[source_within(source, 0, (int)image->header.splat_count - 1)];
    switch (source_within(source, 0, 4)) {
    case 0:
        splat->major = (uint16_t)(GSF_MAX_SCALE_CODE + 1 + source_byte(source));
        break;
    case 1:
        splat->x = UINT32_MAX - source_byte(source);
        break;
    case 2:
        splat->luma = (int16_t)(INT16_MIN + source_byte(source));
        break;
    case 3:
        splat->layer = image->header.enhancement_layers + 1u + source_byte(source);
        break;
    default:
        image->steps.scale = (uint8_t)(16 + source_byte(source) % 16);
    }
}

static void break_books(gsf_coded_image *image, byte_source *source) {
    gsf_codebooks *books = &image->codebooks;
    gsf_indexed_splat *splat = &image->indexed[source_within(source, 0, (int)image->header.splat_count - 1)];
    switch (source_within(source, 0, 4)) {
    case 0:
        splat->shape = (uint16_t)(books->shape_count + source_byte(source));
        break;
    case 1:
        books->position_bits = (uint8_t)(17 + source_byte(source) % 8);
        break;
    case 2:
        books->shape[0].max = GSF_MAX_OCTAVES32 + 1 + source_byte(source);
        break;
    case 3:
        books->colour_count = (uint16_t)(GSF_MAX_CODEBOOK + 1 + source_byte(source));
        break;
    default:
        books->colour[0] = (gsf_range){1, 0};
    }
}

bool scene_break(coded_scene *scene, byte_source *source) {
    gsf_coded_image *image = &scene->image;
    const int part = source_within(source, 0, 31);
    if (part == 31)
        break_header(&image->header, source);
    else if (part == 30 && image->header.splat_count > 0 && image->header.coding == GSF_CODING_SCALAR)
        break_splat(image, source);
    else if (part == 30 && image->header.splat_count > 0)
        break_books(image, source);
    else
        return false;
    return true;
}
