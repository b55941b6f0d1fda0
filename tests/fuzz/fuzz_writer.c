/* Writes images that the input describes, in every form: whole with and without blocks, bare, in layers, and cut off.  What
 * is read back must equal what was written, the counted size must be the written one, and the splats of a prefix must be
 * the first ones of the whole image.  Values outside their limits must be refused. */
#include <string.h>

#include "coded_scene.h"
#include "format/check.h"
#include "format/header.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define PREFIXES 4 /* of each file */

static coded_scene scene;
static fuzz_memory memory, memory_again;
static uint8_t file[FUZZ_MAX_FILE], again[FUZZ_MAX_FILE];

/* Writes into a buffer of exactly the counted size. */
static size_t write_scene(gsf_coded_image *image) {
    size_t counted = 0, size = 0;
    void *scratch = fuzz_scratch(&image->header);
    gsf_sort(image, scratch);
    fuzz_require(gsf_size(image, &counted, scratch) == GSF_OK, "the size of a valid image cannot be counted");
    fuzz_require(counted <= gsf_write_bound(image) && counted <= sizeof file, "a file is larger than its bound");
    if (counted > 0)
        fuzz_require(gsf_write(image, file, counted - 1, &size, scratch) == GSF_NO_SPACE,
                     "a file fits into less than its size");
    fuzz_require(gsf_write(image, file, counted, &size, scratch) == GSF_OK, "a valid image cannot be written");
    fuzz_require(size == counted, "a file has another size than was counted");
    return size;
}

static void compare_books(const gsf_header *header, const gsf_codebooks *a, const gsf_codebooks *b) {
    const unsigned colour_dims = gsf_channel_count(header) + header->has_opacity;
    const unsigned shape_dims = header->has_rotation ? 3 : header->has_anisotropy ? 2 : 1;
    fuzz_require(a->shape_count == b->shape_count && a->colour_count == b->colour_count &&
                     a->position_bits == b->position_bits && a->shape_bits == b->shape_bits &&
                     a->colour_bits == b->colour_bits,
                 "codebooks are read otherwise than they were written");
    for (unsigned d = 0; d < shape_dims; d++)
        for (unsigned i = 0; i < a->shape_count; i++)
            fuzz_require(a->shape_words[i][d] == b->shape_words[i][d], "a shape is read otherwise than it was written");
    for (unsigned d = 0; d < colour_dims; d++)
        for (unsigned i = 0; i < a->colour_count; i++)
            fuzz_require(a->colour_words[i][d] == b->colour_words[i][d],
                         "a colour is read otherwise than it was written");
    fuzz_require(memcmp(a->shape, b->shape, shape_dims * sizeof *a->shape) == 0 &&
                     memcmp(a->colour, b->colour, colour_dims * sizeof *a->colour) == 0,
                 "ranges are read otherwise than they were written");
}

static void compare_headers(const gsf_header *a, const gsf_header *b) {
    fuzz_require(a->blend == b->blend && a->coding == b->coding && a->layout == b->layout &&
                     a->high_bit_depth == b->high_bit_depth && a->has_chroma == b->has_chroma &&
                     a->has_alpha == b->has_alpha && a->has_opacity == b->has_opacity &&
                     a->has_texture == b->has_texture && a->has_rotation == b->has_rotation &&
                     a->has_anisotropy == b->has_anisotropy && a->width == b->width && a->height == b->height &&
                     a->splat_count == b->splat_count && a->enhancement_layers == b->enhancement_layers,
                 "a header is read otherwise than it was written");
}

static void compare_images(const gsf_coded_image *a, const gsf_coded_image *b) {
    compare_headers(&a->header, &b->header);
    fuzz_require(a->has_mean_background == b->has_mean_background, "the background is read otherwise");
    for (unsigned i = 0; i < gsf_channel_count(&a->header) && !a->has_mean_background; i++)
        fuzz_require(a->background[i] == b->background[i], "the background is read otherwise than it was written");
    if (a->header.splat_count == 0)
        return;
    if (a->header.coding == GSF_CODING_SCALAR) {
        fuzz_require(memcmp(a->splats, b->splats, a->header.splat_count * sizeof *a->splats) == 0,
                     "splats are read otherwise than they were written");
    } else {
        fuzz_require(memcmp(a->indexed, b->indexed, a->header.splat_count * sizeof *a->indexed) == 0,
                     "splats are read otherwise than they were written");
        compare_books(&a->header, &a->codebooks, &b->codebooks);
    }
}

static void compare_blocks(const gsf_bytes *blocks, size_t size) {
    gsf_container container;
    fuzz_require(gsf_open_container(file, size, &container) == GSF_OK && container.is_intact,
                 "the parts of a file are not found");
    for (int i = 0; i < GSF_BLOCK_COUNT; i++) {
        const gsf_bytes *found = &container.blocks[i], *written = &blocks[i];
        fuzz_require(found->size == written->size && !found->data == !written->data,
                     "a block is read with another size");
        fuzz_require(found->size == 0 || memcmp(found->data, written->data, found->size) == 0, "a block is changed");
    }
}

/* Writing what was read gives the same file. */
static void compare_files(gsf_coded_image *image, const gsf_bytes *blocks, size_t size) {
    size_t size_again = 0;
    image->blocks = blocks;
    fuzz_require(gsf_write(image, again, sizeof again, &size_again, fuzz_scratch(&image->header)) == GSF_OK,
                 "an image that was read cannot be written");
    fuzz_require(size == size_again && memcmp(file, again, size) == 0, "writing is not stable");
}

/* Reads the first `size` bytes. */
static void check_prefix(const gsf_coded_image *whole, size_t size) {
    gsf_coded_image image;
    uint32_t total = 0;
    fuzz_require(fuzz_create(&image, &memory_again, &whole->header), "a scene has too many splats");
    image.bare = whole->bare;
    if (gsf_read_prefix(file, size, &image, &total, fuzz_scratch(&whole->header)) != GSF_OK)
        return;
    const uint32_t n = image.header.splat_count;
    fuzz_require(total == whole->header.splat_count && n <= total, "a prefix has another number of splats");
    if (image.bare && n == total) /* the first bytes of a bare file may be a file themselves, since it has no check */
        return;
    if (whole->header.coding == GSF_CODING_SCALAR)
        fuzz_require(n == 0 || memcmp(image.splats, whole->splats, n * sizeof *image.splats) == 0,
                     "the splats of a prefix are not the first ones");
    else
        fuzz_require(n == 0 || memcmp(image.indexed, whole->indexed, n * sizeof *image.indexed) == 0,
                     "the splats of a prefix are not the first ones");
}

static void check_reading(const gsf_coded_image *image, size_t size, byte_source *source) {
    gsf_coded_image read;
    gsf_header header;
    fuzz_require(gsf_read_header(file, size, image->bare, &header) == GSF_OK, "a header cannot be read");
    compare_headers(&image->header, &header);
    fuzz_require(fuzz_create(&read, &memory_again, &header), "a scene has too many splats");
    read.bare = image->bare;
    fuzz_require(gsf_read(file, size, &read, fuzz_scratch(&header)) == GSF_OK, "a written file cannot be read");
    compare_images(image, &read);
    if (image->blocks)
        compare_blocks(image->blocks, size);
    compare_files(&read, image->blocks, size);
    for (int i = 0; i < PREFIXES; i++)
        check_prefix(image, (size_t)source_within(source, 0, (int)size));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    byte_source source = {data, size};
    gsf_coded_image *image = &scene.image;
    size_t counted;
    scene_read(&scene, &memory, &source);
    const bool is_broken = scene_break(&scene, &source);
    if (is_broken || !gsf_work_is_bounded(image)) {
        fuzz_require(gsf_write(image, file, sizeof file, &counted, fuzz_scratch(&image->header)) == GSF_INVALID,
                     "an image that breaks a rule is written");
        return 0;
    }
    check_reading(image, write_scene(image), &source);
    return 0;
}
