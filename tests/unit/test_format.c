/* The file format: images to bytes and back, and the errors of writer and reader. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "format/format.h"
#include "format/header.h"

/* A coded image with memory of its own. */
typedef struct fixture {
    gsf_coded_image image;
    uint8_t *bytes;
    size_t capacity, size;
    void *scratch;
    uint64_t stream_bits256[GSF_STREAM_COUNT];
} fixture;

static uint32_t random_state;

/* 0..count - 1 */
static uint32_t pick(uint32_t count) {
    random_state = random_state * 1664525u + 1013904223u;
    return (random_state >> 8) % count;
}

static void *allocate(size_t count, size_t size) {
    void *memory = calloc(count > 0 ? count : 1, size);
    assert_non_null(memory);
    return memory;
}

static void create(fixture *f, const gsf_header *header) {
    memset(f, 0, sizeof *f);
    f->image.header = *header;
    f->image.splats = allocate(header->splat_count, sizeof *f->image.splats);
    f->image.indexed = allocate(header->splat_count, sizeof *f->image.indexed);
    f->image.codebooks.shape_words = allocate(GSF_MAX_CODEBOOK, sizeof *f->image.codebooks.shape_words);
    f->image.codebooks.colour_words = allocate(GSF_MAX_CODEBOOK, sizeof *f->image.codebooks.colour_words);
    f->image.stream_bits256 = f->stream_bits256;
    f->scratch = allocate(gsf_scratch_size(header), 1);
}

static void destroy(fixture *f) {
    free(f->image.splats);
    free(f->image.indexed);
    free(f->image.codebooks.shape_words);
    free(f->image.codebooks.colour_words);
    free(f->scratch);
    free(f->bytes);
}

static gsf_result write_fixture(fixture *f) {
    free(f->bytes);
    f->capacity = gsf_write_bound(&f->image);
    f->bytes = allocate(f->capacity, 1);
    return gsf_write(&f->image, f->bytes, f->capacity, &f->size, f->scratch);
}

static void read_fixture(const fixture *written, fixture *f) {
    gsf_header header;
    assert_int_equal(gsf_read_header(written->bytes, written->size, false, &header), GSF_OK);
    create(f, &header);
    assert_int_equal(gsf_read(written->bytes, written->size, &f->image, f->scratch), GSF_OK);
}

static void fill_steps(gsf_coded_image *image) {
    const gsf_header *h = &image->header;
    uint8_t *steps[7] = {&image->steps.scale,  &image->steps.position, &image->steps.angle,  &image->steps.luma,
                         &image->steps.chroma, &image->steps.alpha,    &image->steps.opacity};
    const bool used[7] = {true, true, h->has_rotation, true, h->has_chroma, h->has_alpha, h->has_opacity};
    for (int i = 0; i < 7; i++)
        *steps[i] = used[i] && h->splat_count > 0 ? (uint8_t)pick(16) : 0;
    image->steps.pivot = h->splat_count > 0 ? (uint8_t)pick(GSF_MAX_SCALE_CODE + 1) : 0;
}

static int16_t pick_between(int min, int max) {
    return (int16_t)(min + (int)pick((uint32_t)(max - min + 1)));
}

static void fill_colour(const gsf_coded_image *image, gsf_splat *splat) {
    const gsf_header *h = &image->header;
    const gsf_steps *steps = &image->steps;
    const unsigned fineness = gsf_colour_fineness(steps, splat->major, splat->aspect);
    int min, max;
    gsf_luma_range(h->blend, steps->luma, fineness, &min, &max);
    splat->luma = pick_between(min, max);
    gsf_luma_range(h->blend, steps->alpha, 1, &min, &max);
    splat->alpha = h->has_alpha ? pick_between(min, max) : 0;
    gsf_chroma_range(steps->chroma, fineness, &min, &max);
    splat->co = h->has_chroma ? pick_between(min, max) : 0;
    splat->cg = h->has_chroma ? pick_between(min, max) : 0;
}

static void fill_splat(const gsf_coded_image *image, gsf_splat *splat) {
    const gsf_header *h = &image->header;
    const gsf_steps *steps = &image->steps;
    splat->major = (uint16_t)pick(pick(2) ? 64 : 12);
    splat->aspect = h->has_anisotropy ? (uint16_t)pick(splat->major + 1u) : 0;
    splat->angle = h->has_rotation ? (uint16_t)pick(gsf_angle_count(steps, splat->aspect)) : 0;
    const gsf_splat_grid grid = gsf_splat_grid_of(h, steps, splat);
    splat->x = pick(grid.cells_x);
    splat->y = pick(grid.cells_y);
    fill_colour(image, splat);
    splat->opacity = h->has_opacity ? (uint16_t)pick(steps->opacity + 1u) : 0;
    if (h->has_texture && pick(3) > 0)
        splat->texture = (gsf_texture){.wave = (uint8_t)pick(GSF_WAVES),
                                       .direction = (uint8_t)pick(GSF_DIRECTIONS),
                                       .phase = (uint8_t)pick(GSF_PHASES),
                                       .amplitude = (uint8_t)(1 + pick(GSF_AMPLITUDES))};
}

static int descending(const void *a, const void *b) {
    return **(const uint16_t(*)[1])b - **(const uint16_t(*)[1])a;
}

static int ascending(const void *a, const void *b) {
    return descending(b, a);
}

static void fill_ranges(gsf_range *ranges, unsigned dims, int32_t lowest, int32_t highest) {
    for (unsigned i = 0; i < dims; i++) {
        ranges[i].min = lowest + (int32_t)pick((uint32_t)(highest - lowest + 1));
        ranges[i].max = ranges[i].min + (int32_t)pick((uint32_t)(highest - ranges[i].min + 1));
    }
}

static void fill_codebooks(gsf_coded_image *image) {
    const gsf_header *h = &image->header;
    gsf_codebooks *books = &image->codebooks;
    const unsigned channels = gsf_channel_count(h);
    books->shape_count = (uint16_t)(1 + pick(pick(2) ? GSF_MAX_CODEBOOK : 4));
    books->colour_count = (uint16_t)(1 + pick(pick(2) ? GSF_MAX_CODEBOOK : 4));
    books->position_bits = (uint8_t)(1 + pick(16));
    books->shape_bits = (uint8_t)(1 + pick(16));
    books->colour_bits = (uint8_t)(1 + pick(16));
    fill_ranges(books->shape, h->has_anisotropy ? 2 : 1, 0, 640);
    fill_ranges(books->shape + 2, h->has_rotation, 0, 256);
    fill_ranges(books->colour, channels, -255, 510);
    fill_ranges(books->colour + channels, h->has_opacity, 0, 255);
    for (unsigned i = 0; i < books->shape_count; i++)
        for (unsigned d = 0; d < 1u + h->has_anisotropy + h->has_rotation; d++)
            books->shape_words[i][d] = (uint16_t)pick(1u << books->shape_bits);
    for (unsigned i = 0; i < books->colour_count; i++)
        for (unsigned d = 0; d < channels + h->has_opacity; d++)
            books->colour_words[i][d] = (uint16_t)pick(1u << books->colour_bits);
    qsort(books->shape_words, books->shape_count, sizeof *books->shape_words, descending);
    qsort(books->colour_words, books->colour_count, sizeof *books->colour_words, ascending);
}

static void fill_indexed(const gsf_coded_image *image, gsf_indexed_splat *splat) {
    const gsf_codebooks *books = &image->codebooks;
    splat->shape = (uint16_t)pick(books->shape_count);
    splat->colour = (uint16_t)pick(books->colour_count);
    splat->x = (uint16_t)pick(1u << books->position_bits);
    splat->y = (uint16_t)pick(1u << books->position_bits);
}

/* Random content that the header allows. */
static void fill_image(gsf_coded_image *image) {
    const gsf_header *h = &image->header;
    image->has_mean_background = h->splat_count % 4 == 1;
    for (unsigned i = 0; i < gsf_channel_count(h) && !image->has_mean_background; i++)
        image->background[i] = (uint16_t)pick(h->high_bit_depth ? 65536 : 256);
    if (h->splat_count == 0)
        return;
    if (h->coding == GSF_CODING_SCALAR)
        fill_steps(image);
    else
        fill_codebooks(image);
    for (uint32_t i = 0; i < h->splat_count; i++) {
        if (h->coding == GSF_CODING_SCALAR)
            fill_splat(image, &image->splats[i]);
        else
            fill_indexed(image, &image->indexed[i]);
    }
}

static void assert_same_codebooks(const gsf_codebooks *a, const gsf_codebooks *b) {
    assert_int_equal(a->shape_count, b->shape_count);
    assert_int_equal(a->colour_count, b->colour_count);
    assert_int_equal(a->position_bits, b->position_bits);
    assert_int_equal(a->shape_bits, b->shape_bits);
    assert_int_equal(a->colour_bits, b->colour_bits);
    assert_memory_equal(a->shape, b->shape, sizeof a->shape);
    assert_memory_equal(a->colour, b->colour, sizeof a->colour);
    assert_memory_equal(a->shape_words, b->shape_words, a->shape_count * sizeof *a->shape_words);
    assert_memory_equal(a->colour_words, b->colour_words, a->colour_count * sizeof *a->colour_words);
}

static void assert_same_header(const gsf_header *a, const gsf_header *b) {
    assert_true(a->blend == b->blend && a->coding == b->coding && a->layout == b->layout);
    assert_true(a->high_bit_depth == b->high_bit_depth && a->has_chroma == b->has_chroma &&
                a->has_alpha == b->has_alpha);
    assert_true(a->has_opacity == b->has_opacity && a->has_rotation == b->has_rotation);
    assert_true(a->has_anisotropy == b->has_anisotropy && a->width == b->width && a->height == b->height);
    assert_int_equal(a->has_texture, b->has_texture);
    assert_int_equal(a->splat_count, b->splat_count);
}

static void assert_same_image(const gsf_coded_image *a, const gsf_coded_image *b) {
    const uint32_t n = a->header.splat_count;
    assert_same_header(&a->header, &b->header);
    assert_int_equal(a->has_mean_background, b->has_mean_background);
    assert_memory_equal(a->background, b->background, sizeof a->background);
    assert_memory_equal(&a->steps, &b->steps, sizeof a->steps);
    assert_memory_equal(a->stream_bits256, b->stream_bits256, GSF_STREAM_COUNT * sizeof *a->stream_bits256);
    if (a->header.coding == GSF_CODING_SCALAR)
        assert_memory_equal(a->splats, b->splats, n * sizeof *a->splats);
    else
        assert_memory_equal(a->indexed, b->indexed, n * sizeof *a->indexed);
    if (a->header.coding == GSF_CODING_CODEBOOK && n > 0)
        assert_same_codebooks(&a->codebooks, &b->codebooks);
}

/* Writes, reads back and writes again: the images and the bytes must be equal. */
static void check_round_trip(fixture *f) {
    fixture back;
    assert_int_equal(write_fixture(f), GSF_OK);
    size_t counted;
    assert_int_equal(gsf_size(&f->image, &counted, f->scratch), GSF_OK);
    assert_int_equal(counted, f->size);
    read_fixture(f, &back);
    assert_same_image(&f->image, &back.image);
    assert_int_equal(write_fixture(&back), GSF_OK);
    assert_int_equal(f->size, back.size);
    assert_memory_equal(f->bytes, back.bytes, f->size);
    destroy(&back);
}

static gsf_header header_from_bits(unsigned choice) {
    gsf_header h = {.layout = (gsf_layout)(choice & 3), .coding = (gsf_coding)(choice >> 2 & 1)};
    h.high_bit_depth = choice >> 3 & 1;
    h.has_chroma = (choice >> 4 & 1) && (h.layout == GSF_RGB || h.layout == GSF_RGBA);
    h.has_alpha = (choice >> 5 & 1) && (h.layout == GSF_GREY_ALPHA || h.layout == GSF_RGBA);
    h.has_opacity = choice >> 6 & 1;
    h.has_anisotropy = choice >> 7 & 1;
    h.has_rotation = (choice >> 8 & 1) && h.has_anisotropy;
    h.has_texture = h.coding == GSF_CODING_SCALAR && pick(2);
    h.blend = (gsf_blend)pick(3);
    return h;
}

static void test_random_images(void **unused) {
    (void)unused;
    random_state = 7;
    for (unsigned choice = 0; choice < 512; choice++) {
        fixture f;
        gsf_header header = header_from_bits(choice);
        header.width = 1 + pick(900);
        header.height = 1 + pick(900);
        header.splat_count = pick(120);
        create(&f, &header);
        fill_image(&f.image);
        check_round_trip(&f);
        destroy(&f);
    }
}

static const gsf_header photo =
    {.layout = GSF_RGB, .has_chroma = true, .has_rotation = true, .has_anisotropy = true, .width = 768, .height = 512};

static void check_size(uint32_t width, uint32_t height, uint32_t splats, gsf_coding coding) {
    fixture f;
    gsf_header header = photo;
    header.width = width;
    header.height = height;
    header.splat_count = splats;
    header.coding = coding;
    create(&f, &header);
    fill_image(&f.image);
    check_round_trip(&f);
    destroy(&f);
}

static void test_extreme_sizes(void **unused) {
    (void)unused;
    static const uint32_t sizes[][2] = {
        {1, 1}, {GSF_MAX_DIMENSION, GSF_MAX_DIMENSION}, {GSF_MAX_DIMENSION, 1}, {1, GSF_MAX_DIMENSION}};
    static const uint32_t counts[] = {0, 1, 2, 200};
    random_state = 11;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int coding = 0; coding < 2; coding++)
                check_size(sizes[i][0], sizes[i][1], counts[j], (gsf_coding)coding);
}

/* More splats than the table of a count split and the list of priors hold. */
static void test_many_splats(void **unused) {
    (void)unused;
    fixture f;
    gsf_header header = photo;
    header.splat_count = 40000;
    create(&f, &header);
    random_state = 5;
    f.image.steps = (gsf_steps){.scale = 8, .position = 10, .angle = 6, .luma = 8, .chroma = 4};
    for (uint32_t i = 0; i < header.splat_count; i++) {
        fill_splat(&f.image, &f.image.splats[i]);
        f.image.splats[i].major = (uint16_t)pick(3);
        f.image.splats[i].aspect %= f.image.splats[i].major + 1;
        f.image.splats[i].angle = 0;
        f.image.splats[i].x %= 512;
        f.image.splats[i].y = 0;
        fill_colour(&f.image, &f.image.splats[i]);
    }
    check_round_trip(&f);
    destroy(&f);
}

static void test_all_in_one_cell(void **unused) {
    (void)unused;
    fixture f;
    gsf_header header = photo;
    header.splat_count = 700;
    create(&f, &header);
    random_state = 6;
    f.image.steps = (gsf_steps){.luma = 15, .chroma = 15};
    for (uint32_t i = 0; i < header.splat_count; i++) {
        fill_splat(&f.image, &f.image.splats[i]);
        f.image.splats[i].major = 3;
        f.image.splats[i].x = 100;
        f.image.splats[i].y = 99;
        f.image.splats[i].aspect %= 4;
        f.image.splats[i].angle = 0;
        fill_colour(&f.image, &f.image.splats[i]);
    }
    check_round_trip(&f);
    destroy(&f);
}

static void test_largest_codes(void **unused) {
    (void)unused;
    fixture f;
    gsf_header header = photo;
    header.splat_count = 2;
    header.layout = GSF_RGBA;
    header.blend = GSF_BLEND_SUM;
    header.has_alpha = header.has_opacity = header.has_texture = header.high_bit_depth = true;
    create(&f, &header);
    f.image.steps = (gsf_steps){15, 15, 15, 15, 15, 15, 15, 0};
    memset(f.image.background, 0xFF, sizeof f.image.background);
    for (int i = 0; i < 2; i++)
        f.image.splats[i] = (gsf_splat){.major = 63,
                                        .aspect = 63,
                                        .angle = 511,
                                        .opacity = 15,
                                        .luma = 287 * GSF_MAX_FINENESS - 1,
                                        .co = 256 * GSF_MAX_FINENESS - 1,
                                        .cg = -255 * GSF_MAX_FINENESS,
                                        .alpha = -286,
                                        .texture = {GSF_WAVES - 1, GSF_DIRECTIONS - 1, GSF_PHASES - 1, GSF_AMPLITUDES}};
    check_round_trip(&f);
    destroy(&f);
}

/* Codes of effects that are off are ignored, and zero afterwards. */
static void test_unused_codes_are_cleared(void **unused) {
    (void)unused;
    fixture f;
    const gsf_header header = {.width = 9, .height = 9, .splat_count = 1};
    create(&f, &header);
    f.image.splats[0] = (gsf_splat){
        .aspect = 999, .angle = 999, .co = 999, .cg = 999, .alpha = 999, .opacity = 999, .texture = {99, 99, 99, 99}};
    f.image.steps.chroma = 3;
    check_round_trip(&f);
    assert_int_equal(f.image.splats[0].aspect, 0);
    assert_int_equal(f.image.splats[0].cg, 0);
    assert_int_equal(f.image.splats[0].texture.amplitude, 0);
    assert_int_equal(f.image.steps.chroma, 0);
    destroy(&f);
}

static void test_image_without_splats_is_tiny(void **unused) {
    (void)unused;
    fixture f;
    create(&f, &photo);
    check_round_trip(&f);
    assert_true(f.size <= 14);
    destroy(&f);
}

/* gsf_sort and gsf_write produce the same order from any order. */
static void test_sorting(void **unused) {
    (void)unused;
    fixture f, g;
    gsf_header header = photo;
    header.splat_count = 100;
    create(&f, &header);
    create(&g, &header);
    random_state = 3;
    fill_image(&f.image);
    g.image.steps = f.image.steps;
    for (uint32_t i = 0; i < header.splat_count; i++)
        g.image.splats[i] = f.image.splats[header.splat_count - 1 - i];
    gsf_sort(&g.image, g.scratch);
    assert_int_equal(write_fixture(&f), GSF_OK);
    assert_memory_equal(f.image.splats, g.image.splats, header.splat_count * sizeof *f.image.splats);
    destroy(&f);
    destroy(&g);
}

static void test_little_space(void **unused) {
    (void)unused;
    fixture f;
    gsf_header header = photo;
    header.splat_count = 50;
    create(&f, &header);
    fill_image(&f.image);
    assert_int_equal(write_fixture(&f), GSF_OK);
    const size_t whole = f.size;
    uint8_t *exact = allocate(whole, 1);
    for (size_t capacity = 0; capacity < whole; capacity++)
        assert_int_equal(gsf_write(&f.image, exact, capacity, &f.size, f.scratch), GSF_NO_SPACE);
    assert_int_equal(gsf_write(&f.image, exact, whole, &f.size, f.scratch), GSF_OK);
    free(exact);
    destroy(&f);
}

/* ---- Errors of the writer ---- */

static void check_invalid(fixture *f) {
    assert_int_equal(write_fixture(f), GSF_INVALID);
    destroy(f);
}

static void create_small(fixture *f, gsf_coding coding) {
    gsf_header header = photo;
    header.splat_count = 3;
    header.coding = coding;
    create(f, &header);
    random_state = 9;
    fill_image(&f->image);
}

static void test_writer_refuses_scalar(void **unused) {
    (void)unused;
    fixture f;
#define REFUSES(change)                      \
    do {                                     \
        create_small(&f, GSF_CODING_SCALAR); \
        f.image.change;                      \
        check_invalid(&f);                   \
    } while (0)
    REFUSES(header.width = 0);
    REFUSES(header.height = GSF_MAX_DIMENSION + 1);
    REFUSES(header.layout = GSF_GREY);
    REFUSES(header.has_alpha = true);
    REFUSES(header.has_anisotropy = false);
    REFUSES(background[2] = 256);
    REFUSES(steps.scale = 16);
    REFUSES(splats[1].major = 64);
    REFUSES(splats[1].aspect = 64);
    REFUSES(splats[1].angle = 512);
    REFUSES(splats[1].x = 1u << 30);
    REFUSES(splats[1].y = 1u << 30);
    REFUSES(steps.pivot = 64);
    REFUSES(splats[1].luma = 287 * GSF_MAX_FINENESS);
    REFUSES(splats[1].co = -256 * GSF_MAX_FINENESS);
    REFUSES(splats[1].cg = 256 * GSF_MAX_FINENESS);
    REFUSES(splats[1].texture.wave = f.image.header.has_texture = true);
    REFUSES(splats[1].texture.amplitude = GSF_AMPLITUDES + (f.image.header.has_texture = true));
#undef REFUSES
}

static void test_writer_refuses_codebook(void **unused) {
    (void)unused;
    fixture f;
#define REFUSES(change)                        \
    do {                                       \
        create_small(&f, GSF_CODING_CODEBOOK); \
        f.image.change;                        \
        check_invalid(&f);                     \
    } while (0)
    REFUSES(codebooks.shape_count = 0);
    REFUSES(codebooks.colour_count = GSF_MAX_CODEBOOK + 1);
    REFUSES(codebooks.position_bits = 17);
    REFUSES(codebooks.shape_bits = 0);
    REFUSES(codebooks.shape[0].min = -1);
    REFUSES(codebooks.shape[2].max = 257);
    REFUSES(codebooks.colour[2].max = 511);
    REFUSES(codebooks.colour[0].min = 600);
    REFUSES(codebooks.shape_words[0][0] = 0);
    REFUSES(indexed[2].shape = f.image.codebooks.shape_count);
    REFUSES(indexed[2].colour = f.image.codebooks.colour_count);
#undef REFUSES
}

/* Splats that cover all of a large image many hundred times would take a decoder too long. */
static void test_work_is_limited(void **unused) {
    (void)unused;
    fixture f;
    gsf_header header = photo;
    header.splat_count = 500;
    header.has_rotation = false;
    create(&f, &header);
    for (uint32_t i = 0; i < header.splat_count; i++)
        f.image.splats[i] = (gsf_splat){.major = 63, .aspect = 20};
    f.image.steps.scale = 8;
    check_invalid(&f);
}

/* ---- Errors of the reader ---- */

static gsf_result read_bytes(const uint8_t *bytes, size_t size, fixture *f) {
    gsf_header header;
    /* The copy has exactly that size, so that a sanitizer detects reads beyond it. */
    uint8_t *copy = allocate(size, 1);
    memcpy(copy, bytes, size);
    gsf_result result = gsf_read_header(copy, size, false, &header);
    if (result == GSF_OK && header.splat_count <= f->image.header.splat_count)
        result = gsf_read(copy, size, &f->image, f->scratch);
    else if (result == GSF_OK)
        result = GSF_DAMAGED; /* the fixture has no memory for that many */
    free(copy);
    return result;
}

/* Memory for any header that the changes below can produce: they raise a count of 30 to at most 2^15. */
static void create_reader(fixture *f) {
    const gsf_header header = {.width = 1, .height = 1, .splat_count = 1u << 15};
    create(f, &header);
}

static void check_damage(gsf_coding coding, uint32_t splats) {
    fixture f, reader;
    gsf_header header = photo;
    header.coding = coding;
    header.splat_count = splats;
    create(&f, &header);
    random_state = 13;
    fill_image(&f.image);
    assert_int_equal(write_fixture(&f), GSF_OK);
    for (size_t size = 0; size < f.size; size++) {
        create_reader(&reader);
        const gsf_result result = read_bytes(f.bytes, size, &reader);
        assert_int_not_equal(result, GSF_OK);
        assert_true(size < 4 ? result == GSF_NOT_GSCL : result == GSF_TRUNCATED || result == GSF_DAMAGED);
        destroy(&reader);
    }
    for (size_t i = 0; i < f.size; i++) {
        create_reader(&reader);
        f.bytes[i] ^= (uint8_t)(1 + i % 255);
        assert_int_not_equal(read_bytes(f.bytes, f.size, &reader), GSF_OK);
        f.bytes[i] ^= (uint8_t)(1 + i % 255);
        destroy(&reader);
    }
    destroy(&f);
}

static void test_damage_is_detected(void **unused) {
    (void)unused;
    check_damage(GSF_CODING_SCALAR, 0);
    check_damage(GSF_CODING_SCALAR, 30);
    check_damage(GSF_CODING_CODEBOOK, 30);
}

/* A file that lost its end is reported as truncated, not as damaged. */
static void test_truncation_differs_from_damage(void **unused) {
    (void)unused;
    fixture f, reader;
    create_small(&f, GSF_CODING_SCALAR);
    assert_int_equal(write_fixture(&f), GSF_OK);
    create_reader(&reader);
    assert_int_equal(read_bytes(f.bytes, f.size / 2 + 8, &reader), GSF_TRUNCATED);
    assert_int_equal(read_bytes(f.bytes, 10, &reader), GSF_TRUNCATED);
    destroy(&reader);
    destroy(&f);
}

/* ---- Numbers that the format fixes ---- */

static void test_quantiser(void **unused) {
    (void)unused;
    const gsf_steps steps = {.scale = 4, .position = 14, .angle = 6};
    assert_int_equal(gsf_sigma_q16(&steps, 0), 32768);
    assert_int_equal(gsf_sigma_q16(&steps, 4), 65536);
    assert_int_equal(gsf_sigma_q16(&steps, 6), 92681);
    assert_int_equal(gsf_sigma_q16(&steps, 63), 1805811328);
    assert_int_equal(gsf_sigma_q16(&steps, 64), UINT64_C(1) << 31);
    assert_int_equal(gsf_sigma_q16(&steps, 126), UINT64_C(1) << 31);
    assert_int_equal(gsf_position_step_q8(&steps, 4), 128);
    assert_int_equal(gsf_position_cells(&steps, 4, 10), 20);
    assert_int_equal(gsf_position_cells(&steps, 5, 10), 17);
    assert_int_equal(gsf_position_cells(&steps, 63, 16384), 2);
    assert_int_equal(gsf_angle_count(&steps, 0), 1);
    assert_int_equal(gsf_angle_count(&steps, 4), 10); /* a = 2: 2 pi 1.5 = 9.4 */
    assert_int_equal(gsf_angle_count(&steps, 63), GSF_MAX_ANGLES);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_images),
        cmocka_unit_test(test_extreme_sizes),
        cmocka_unit_test(test_many_splats),
        cmocka_unit_test(test_all_in_one_cell),
        cmocka_unit_test(test_largest_codes),
        cmocka_unit_test(test_unused_codes_are_cleared),
        cmocka_unit_test(test_image_without_splats_is_tiny),
        cmocka_unit_test(test_sorting),
        cmocka_unit_test(test_little_space),
        cmocka_unit_test(test_writer_refuses_scalar),
        cmocka_unit_test(test_writer_refuses_codebook),
        cmocka_unit_test(test_work_is_limited),
        cmocka_unit_test(test_damage_is_detected),
        cmocka_unit_test(test_truncation_differs_from_damage),
        cmocka_unit_test(test_quantiser),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
