#include "synthetic_scene.h"

#include <math.h>
#include <stdlib.h>

uint32_t synthetic_random_state;

uint32_t synthetic_random(uint32_t count) {
    synthetic_random_state = synthetic_random_state * 1664525u + 1013904223u;
    return (synthetic_random_state >> 8) % count;
}

float synthetic_uniform(double low, double high) {
    return (float)(low + (high - low) * synthetic_random(1 << 20) / (1 << 20));
}

static int between(int min, int max) {
    return min + (int)synthetic_random((uint32_t)(max - min + 1));
}

synthetic_scene *synthetic_scene_new(const gsf_header *header) {
    synthetic_scene *scene = calloc(1, sizeof *scene);
    if (!scene)
        return NULL;
    gsf_coded_image *image = &scene->image;
    image->header = *header;
    image->splats = calloc(header->splat_count + 1, sizeof *image->splats);
    image->indexed = calloc(header->splat_count + 1, sizeof *image->indexed);
    image->codebooks.shape_words = scene->shape_words;
    image->codebooks.colour_words = scene->colour_words;
    if (!image->splats || !image->indexed) {
        synthetic_scene_free(scene);
        return NULL;
    }
    return scene;
}

void synthetic_scene_free(synthetic_scene *scene) {
    if (!scene)
        return;
    free(scene->image.splats);
    free(scene->image.indexed);
    free(scene);
}

gsf_result synthetic_scene_write(synthetic_scene *scene, uint8_t **bytes, size_t *size) {
    const size_t capacity = gsf_write_bound(&scene->image);
    void *scratch = malloc(gsf_scratch_size(&scene->image.header));
    *bytes = malloc(capacity);
    gsf_result result = GSF_NO_SPACE;
    if (scratch && *bytes)
        result = gsf_write(&scene->image, *bytes, capacity, size, scratch);
    free(scratch);
    return result;
}

gsf_header synthetic_header(int number, gsf_coding coding) {
    const gsf_layout layout = (gsf_layout)(number % 4);
    const bool anisotropy = synthetic_random(4) > 0;
    const bool layered = coding == GSF_CODING_SCALAR && number % 3 == 2;
    return (gsf_header){.blend = (gsf_blend)(number / 4 % 3),
                        .coding = coding,
                        .layout = layout,
                        .high_bit_depth = synthetic_random(2),
                        .has_chroma = layout >= GSF_RGB && synthetic_random(4) > 0,
                        .has_alpha = layout & 1,
                        .has_opacity = synthetic_random(2),
                        .has_rotation = anisotropy && synthetic_random(4) > 0,
                        .has_anisotropy = anisotropy,
                        .has_texture = coding == GSF_CODING_SCALAR && synthetic_random(2),
                        .width = 1 + synthetic_random(100),
                        .height = 1 + synthetic_random(100),
                        .splat_count = synthetic_random(150),
                        .enhancement_layers = layered ? (uint8_t)(1 + synthetic_random(GSF_MAX_LAYERS - 1)) : 0};
}

void synthetic_background(gsf_coded_image *image) {
    for (int i = 0; i < GSF_MAX_CHANNELS; i++)
        image->background[i] = (uint16_t)synthetic_random(image->header.high_bit_depth ? 65536 : 256);
}

void synthetic_steps(gsf_coded_image *image) {
    uint8_t *steps[7] = {&image->steps.scale,  &image->steps.position, &image->steps.angle,  &image->steps.luma,
                         &image->steps.chroma, &image->steps.alpha,    &image->steps.opacity};
    for (int i = 0; i < 7; i++)
        *steps[i] = (uint8_t)synthetic_random(16);
    image->steps.pivot = (uint8_t)synthetic_random(GSF_MAX_SCALE_CODE + 1);
    if (!image->header.has_rotation)
        image->steps.angle = 0;
}

void synthetic_colour(const gsf_coded_image *image, gsf_splat *splat) {
    const unsigned fineness = gsf_colour_fineness(&image->steps, splat->major, splat->aspect);
    int min, max;
    gsf_luma_range(image->header.blend, image->steps.luma, fineness, &min, &max);
    splat->luma = (int16_t)between(min, max);
    gsf_luma_range(image->header.blend, image->steps.alpha, 1, &min, &max);
    splat->alpha = (int16_t)between(min, max);
    gsf_chroma_range(image->steps.chroma, fineness, &min, &max);
    splat->co = (int16_t)between(min, max);
    splat->cg = (int16_t)between(min, max);
    splat->opacity = (uint16_t)synthetic_random(image->steps.opacity + 1u);
    splat->texture = (gsf_texture){0};
    if (image->header.has_texture && synthetic_random(2))
        splat->texture = (gsf_texture){.wave = (uint8_t)synthetic_random(GSF_WAVES),
                                       .direction = (uint8_t)synthetic_random(GSF_DIRECTIONS),
                                       .phase = (uint8_t)synthetic_random(GSF_PHASES),
                                       .amplitude = (uint8_t)(1 + synthetic_random(GSF_AMPLITUDES))};
}

void synthetic_splat(const gsf_coded_image *image, gsf_splat *splat, unsigned minor, unsigned aspect) {
    splat->layer = synthetic_random(image->header.enhancement_layers + 1u);
    splat->major = (uint16_t)(minor + aspect < GSF_MAX_SCALE_CODE ? minor + aspect : GSF_MAX_SCALE_CODE);
    splat->aspect = (uint16_t)(splat->major - minor);
    splat->angle =
        image->header.has_rotation ? (uint16_t)synthetic_random(gsf_angle_count(&image->steps, splat->aspect)) : 0;
    const gsf_splat_grid grid = gsf_splat_grid_of(&image->header, &image->steps, splat);
    splat->x = synthetic_random(grid.cells_x);
    splat->y = synthetic_random(grid.cells_y);
    synthetic_colour(image, splat);
}

static uint32_t cell_at(double place, double step, uint32_t cells) {
    const double cell = floor(place * 256.0 / step);
    return cell < 0.0 ? 0 : cell >= cells ? cells - 1 : (uint32_t)cell;
}

void synthetic_place_splat(const gsf_coded_image *image, gsf_splat *splat, double x, double y) {
    const gsf_splat_grid grid = gsf_splat_grid_of(&image->header, &image->steps, splat);
    splat->x = cell_at(x, (double)grid.step / grid.parts_x, grid.cells_x);
    splat->y = cell_at(y, (double)grid.step / grid.parts_y, grid.cells_y);
}

bool synthetic_file(uint32_t width, uint32_t height, uint32_t splats, uint8_t **bytes, size_t *size) {
    const gsf_header header = {.layout = GSF_RGB,
                               .has_chroma = true,
                               .has_rotation = true,
                               .has_anisotropy = true,
                               .width = width,
                               .height = height,
                               .splat_count = splats};
    synthetic_scene *scene = synthetic_scene_new(&header);
    *bytes = NULL;
    if (!scene)
        return false;
    synthetic_random_state = splats;
    scene->image.has_mean_background = true;
    scene->image.steps = (gsf_steps){.scale = 4, .position = 8, .angle = 4, .luma = 9, .chroma = 5};
    for (uint32_t i = 0; i < splats; i++)
        synthetic_splat(&scene->image, &scene->image.splats[i], 6 + synthetic_random(6), synthetic_random(5));
    const bool written = synthetic_scene_write(scene, bytes, size) == GSF_OK;
    synthetic_scene_free(scene);
    return written;
}

static int descending(const void *a, const void *b) {
    return (int)*(const uint16_t *)b - (int)*(const uint16_t *)a;
}

static int ascending(const void *a, const void *b) {
    return descending(b, a);
}

static void random_words(gsf_codebooks *books) {
    for (uint32_t i = 0; i < books->shape_count; i++) {
        for (int d = 0; d < GSF_SHAPE_DIMS; d++)
            books->shape_words[i][d] = (uint16_t)synthetic_random(1u << books->shape_bits);
    }
    for (uint32_t i = 0; i < books->colour_count; i++) {
        for (int d = 0; d < GSF_MAX_COLOUR_DIMS; d++)
            books->colour_words[i][d] = (uint16_t)synthetic_random(1u << books->colour_bits);
    }
    qsort(books->shape_words, books->shape_count, sizeof *books->shape_words, descending);
    qsort(books->colour_words, books->colour_count, sizeof *books->colour_words, ascending);
}

void synthetic_codebooks(gsf_coded_image *image, int32_t longest) {
    gsf_codebooks *books = &image->codebooks;
    const unsigned channels = gsf_channel_count(&image->header);
    books->shape_count = (uint16_t)(1 + synthetic_random(40));
    books->colour_count = (uint16_t)(1 + synthetic_random(60));
    books->position_bits = (uint8_t)(1 + synthetic_random(16));
    books->shape_bits = (uint8_t)(1 + synthetic_random(16));
    books->colour_bits = (uint8_t)(1 + synthetic_random(16));
    books->shape[0] = books->shape[1] = (gsf_range){between(0, 100), longest};
    books->shape[2] = (gsf_range){between(0, 20), 256};
    for (unsigned i = 0; i < channels; i++)
        books->colour[i] = (gsf_range){between(-100, 0), between(200, 500)};
    books->colour[channels] = (gsf_range){0, 255};
    random_words(books);
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        gsf_indexed_splat *splat = &image->indexed[i];
        splat->shape = (uint16_t)synthetic_random(books->shape_count);
        splat->colour = (uint16_t)synthetic_random(books->colour_count);
        splat->x = (uint16_t)synthetic_random(1u << books->position_bits);
        splat->y = (uint16_t)synthetic_random(1u << books->position_bits);
    }
}

gsf_result synthetic_file_of_kind(const synthetic_kind *kind, int number, uint8_t **bytes, size_t *size) {
    gsf_header header = synthetic_header(number, kind->coding);
    header.width = kind->width;
    header.height = kind->height;
    header.splat_count = kind->splats;
    header.has_texture = kind->coding == GSF_CODING_SCALAR && number % 2;
    *bytes = NULL;
    synthetic_scene *scene = synthetic_scene_new(&header);
    if (!scene)
        return GSF_NO_SPACE;
    gsf_coded_image *image = &scene->image;
    synthetic_background(image);
    synthetic_steps(image);
    image->steps.scale = 4;
    image->bare = kind->bare;
    if (kind->coding == GSF_CODING_CODEBOOK)
        synthetic_codebooks(image, 280);
    for (uint32_t i = 0; kind->coding == GSF_CODING_SCALAR && i < kind->splats; i++)
        synthetic_splat(image, &image->splats[i], 2 + synthetic_random(10),
                        header.has_anisotropy ? synthetic_random(10) : 0);
    const gsf_result result = synthetic_scene_write(scene, bytes, size);
    synthetic_scene_free(scene);
    return result;
}
