/* What surrounds a picture in a file, the header of a picture, and the results for files that break the rules. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "format/container.h"
#include "format/format.h"
#include "format/header.h"

static const gsf_header photo = {.layout = GSF_RGB,
                                 .has_chroma = true,
                                 .has_texture = true,
                                 .has_rotation = true,
                                 .has_anisotropy = true,
                                 .width = 768,
                                 .height = 512};

/* ---- Files without splats, which need no arrays ---- */

#define CAPACITY 8192

typedef struct file {
    uint8_t bytes[CAPACITY];
    size_t size;
} file;

static uint64_t stream_bits256[GSF_STREAM_COUNT];

static gsf_coded_image empty_image(const gsf_bytes *blocks, bool bare) {
    return (gsf_coded_image){
        .header = photo, .background = {10, 20, 30}, .stream_bits256 = stream_bits256, .bare = bare, .blocks = blocks};
}

static gsf_result write_file(const gsf_bytes *blocks, bool bare, file *f) {
    gsf_coded_image image = empty_image(blocks, bare);
    void *scratch = malloc(gsf_scratch_size(&image.header));
    size_t counted;
    const gsf_result result = gsf_write(&image, f->bytes, CAPACITY, &f->size, scratch);
    assert_int_equal(gsf_size(&image, &counted, scratch), result);
    assert_int_equal(counted, f->size);
    free(scratch);
    return result;
}

/* Reads a copy of exactly that size, so that a sanitizer detects reads beyond it. */
static gsf_result read_file(const uint8_t *bytes, size_t size, bool bare) {
    gsf_coded_image image = empty_image(NULL, bare);
    void *scratch = malloc(gsf_scratch_size(&image.header));
    uint8_t *copy = malloc(size > 0 ? size : 1);
    assert_true(scratch && copy);
    memcpy(copy, bytes, size);
    gsf_result result = gsf_read_header(copy, size, bare, &image.header);
    if (result == GSF_OK && image.header.splat_count == 0)
        result = gsf_read(copy, size, &image, scratch);
    else if (result == GSF_OK)
        result = GSF_NO_SPACE; /* for splats, which an error made */
    free(copy);
    free(scratch);
    return result;
}

static void store_check(file *f) {
    const uint16_t crc = gsf_crc16(f->bytes, f->size - 2);
    f->bytes[f->size - 2] = (uint8_t)(crc >> 8);
    f->bytes[f->size - 1] = (uint8_t)crc;
}

static void check_result(const file *f, gsf_result expected) {
    gsf_container container;
    const gsf_result result = read_file(f->bytes, f->size, false);
    if (result != expected)
        fail_msg("a file of %zu bytes gives %d, %d expected", f->size, (int)result, (int)expected);
    /* Errors of the container are found without the picture. */
    const gsf_result opened = gsf_open_container(f->bytes, f->size, &container);
    assert_true(opened == GSF_OK || opened == expected);
}

/* ---- Blocks ---- */

static uint8_t contents[GSF_BLOCK_COUNT][600];
static gsf_bytes all_blocks[GSF_BLOCK_COUNT] = {{contents[0], 2},
                                                {contents[1], 600},
                                                {contents[2], 1},
                                                {contents[3], 128}};

static int fill_contents(void **unused) {
    (void)unused;
    for (size_t i = 0; i < sizeof contents; i++)
        contents[i / 600][i % 600] = (uint8_t)(i * 7 + i / 600);
    return 0;
}

static void test_check_value(void **unused) {
    (void)unused;
    assert_int_equal(gsf_crc16((const uint8_t *)"123456789", 9), 0xD64E); /* of CRC-16/GENIBUS */
}

static void check_blocks(unsigned chosen, const file *plain) {
    gsf_bytes blocks[GSF_BLOCK_COUNT] = {{NULL, 0}};
    gsf_container container;
    file f;
    size_t content = 0;
    for (unsigned i = 0; i < GSF_BLOCK_COUNT; i++)
        if (chosen >> i & 1)
            blocks[i] = all_blocks[i];
    assert_int_equal(write_file(blocks, false, &f), GSF_OK);
    assert_int_equal(stream_bits256[GSF_STREAM_CONTAINER], 7 * 8 * 256);
    assert_int_equal(stream_bits256[GSF_STREAM_BLOCKS], (f.size - plain->size) * 8 * 256);
    check_result(&f, GSF_OK);
    assert_int_equal(gsf_open_container(f.bytes, f.size, &container), GSF_OK);
    assert_true(container.is_intact);
    for (unsigned i = 0; i < GSF_BLOCK_COUNT; i++) {
        assert_int_equal(container.blocks[i].size, blocks[i].size);
        if (blocks[i].data)
            assert_memory_equal(container.blocks[i].data, blocks[i].data, blocks[i].size);
        else
            assert_null(container.blocks[i].data);
        content += blocks[i].size;
    }
    assert_int_equal(container.picture.size, plain->size - 7);
    assert_memory_equal(container.picture.data, plain->bytes + 5, container.picture.size);
    assert_in_range(f.size - plain->size, content, content + 4 * 3 + 7);
}

static void test_blocks_round_trip(void **unused) {
    (void)unused;
    file plain;
    assert_int_equal(write_file(NULL, false, &plain), GSF_OK);
    for (unsigned chosen = 0; chosen < 1u << GSF_BLOCK_COUNT; chosen++)
        check_blocks(chosen, &plain);
}

static void test_bare_file_is_the_picture(void **unused) {
    (void)unused;
    file whole, bare;
    assert_int_equal(write_file(NULL, false, &whole), GSF_OK);
    assert_int_equal(write_file(NULL, true, &bare), GSF_OK);
    assert_int_equal(bare.size, whole.size - 7);
    assert_memory_equal(bare.bytes, whole.bytes + 5, bare.size);
    assert_int_equal(read_file(bare.bytes, bare.size, true), GSF_OK);
    assert_int_equal(read_file(bare.bytes, bare.size - 1, true), GSF_TRUNCATED);
    assert_int_equal(read_file(bare.bytes, 0, true), GSF_TRUNCATED);
    bare.bytes[bare.size] = 0;
    assert_int_equal(read_file(bare.bytes, bare.size + 1, true), GSF_CORRUPT);
    assert_int_equal(read_file(bare.bytes, bare.size, false), GSF_NOT_GSCL);
}

static void test_writer_refuses_blocks(void **unused) {
    (void)unused;
    file f;
    gsf_bytes blocks[GSF_BLOCK_COUNT] = {{contents[0], 2}};
    assert_int_equal(write_file(blocks, true, &f), GSF_INVALID); /* a bare file has none */
    blocks[GSF_BLOCK_COLOUR_SPACE].size = 3;
    assert_int_equal(write_file(blocks, false, &f), GSF_INVALID);
    blocks[GSF_BLOCK_COLOUR_SPACE].size = 2;
    blocks[GSF_BLOCK_XMP] = (gsf_bytes){contents[0], GSF_MAX_BLOCK_SIZE + 1u};
    assert_int_equal(write_file(blocks, false, &f), GSF_INVALID);
}

/* The lengths of blocks have one to three bytes. */
static void test_lengths_of_blocks(void **unused) {
    (void)unused;
    static const size_t sizes[] = {1, 127, 128, 16383, 16384, GSF_MAX_BLOCK_SIZE};
    uint8_t *content = calloc(GSF_MAX_BLOCK_SIZE, 1), *bytes = malloc(GSF_MAX_BLOCK_SIZE + 100);
    void *scratch = malloc(gsf_scratch_size(&photo));
    assert_true(content && bytes && scratch);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        for (int type = GSF_BLOCK_ICC; type <= GSF_BLOCK_EXIF; type++) {
            gsf_bytes blocks[GSF_BLOCK_COUNT] = {{NULL, 0}};
            gsf_coded_image image = empty_image(blocks, false);
            gsf_container container;
            size_t size;
            blocks[type] = (gsf_bytes){content, sizes[i]};
            assert_in_range(gsf_write_bound(&image), sizes[i], sizes[i] + 10000);
            assert_int_equal(gsf_write(&image, bytes, GSF_MAX_BLOCK_SIZE + 100, &size, scratch), GSF_OK);
            assert_int_equal(gsf_open_container(bytes, size, &container), GSF_OK);
            assert_int_equal(container.blocks[type].size, sizes[i]);
        }
    }
    free(scratch);
    free(bytes);
    free(content);
}

/* ---- Files made by hand ---- */

/* A file with these bytes before and after the picture, and flags in the byte of the version. */
static file made_file(uint8_t flags, const uint8_t *before, size_t before_size, const uint8_t *after,
                      size_t after_size) {
    file plain, f;
    assert_int_equal(write_file(NULL, false, &plain), GSF_OK);
    memcpy(f.bytes, plain.bytes, 5);
    f.bytes[4] |= flags;
    if (before_size > 0)
        memcpy(f.bytes + 5, before, before_size);
    memcpy(f.bytes + 5 + before_size, plain.bytes + 5, plain.size - 7);
    f.size = 5 + before_size + plain.size - 7;
    if (after_size > 0)
        memcpy(f.bytes + f.size, after, after_size);
    f.size += after_size + 2;
    store_check(&f);
    return f;
}

typedef struct list_case {
    uint8_t bytes[8];
    size_t size;
    gsf_result intact, damaged; /* the results with and without a check that matches */
} list_case;

static const list_case before_cases[] = {
    {{0x80, 2, 1, 13}, 4, GSF_OK, GSF_DAMAGED},                 /* a colour space */
    {{0xC0, 2, 1, 13}, 4, GSF_OK, GSF_DAMAGED},                 /* a mandatory one */
    {{0x85, 1, 9}, 3, GSF_OK, GSF_DAMAGED},                     /* unknown and optional */
    {{0x85, 0}, 2, GSF_OK, GSF_DAMAGED},                        /* without content */
    {{0x00, 2, 1, 13, 0x9F, 0}, 6, GSF_OK, GSF_DAMAGED},        /* two of them */
    {{0xC5, 1, 9}, 3, GSF_UNKNOWN_BLOCK, GSF_DAMAGED},          /* unknown and mandatory */
    {{0x80, 1, 9}, 3, GSF_CORRUPT, GSF_DAMAGED},                /* a colour space of another size */
    {{0x05, 0, 0x85, 0}, 4, GSF_CORRUPT, GSF_DAMAGED},          /* the same type twice */
    {{0x05, 0, 0x84, 0}, 4, GSF_CORRUPT, GSF_DAMAGED},          /* types that decrease */
    {{0xA0, 1, 9}, 3, GSF_CORRUPT, GSF_DAMAGED},                /* a type that belongs after the picture */
    {{0x85, 0x81, 0x00, 9}, 4, GSF_CORRUPT, GSF_DAMAGED},       /* a length with a byte too many */
    {{0x85, 0x80, 0x80, 0x80, 1}, 5, GSF_CORRUPT, GSF_DAMAGED}, /* a length of four bytes */
    {{0x85, 0x7F}, 2, GSF_CORRUPT, GSF_TRUNCATED},              /* content beyond the end */
    {{0x05, 0x07}, 2, GSF_CORRUPT, GSF_TRUNCATED},              /* a list beyond the end: it ends with the picture */
};

static void test_blocks_before_the_picture(void **unused) {
    (void)unused;
    for (size_t i = 0; i < sizeof before_cases / sizeof *before_cases; i++) {
        const list_case *c = &before_cases[i];
        file f = made_file(0x10, c->bytes, c->size, NULL, 0);
        check_result(&f, c->intact);
        f.bytes[f.size - 1] ^= 1;
        check_result(&f, c->damaged);
    }
}

static const list_case after_cases[] = {
    {{0xA0, 1, 9, 3}, 4, GSF_OK, GSF_DAMAGED},
    {{0xBF, 1, 9, 3}, 4, GSF_OK, GSF_DAMAGED},
    {{0xFF, 1, 9, 3}, 4, GSF_UNKNOWN_BLOCK, GSF_DAMAGED},
    {{0x80, 1, 9, 3}, 4, GSF_CORRUPT, GSF_DAMAGED},    /* a type that belongs before the picture */
    {{0xA0, 1, 9, 9, 4}, 5, GSF_CORRUPT, GSF_DAMAGED}, /* a byte more than the list */
    {{0xA0, 1, 9, 2}, 4, GSF_CORRUPT, GSF_DAMAGED},    /* a byte less */
    {{0xA0, 1, 9, 0}, 4, GSF_CORRUPT, GSF_DAMAGED},    /* nothing */
    {{0xA0, 1, 9, 99}, 4, GSF_CORRUPT, GSF_DAMAGED},   /* more than the file */
    {{0x20, 1, 9, 3}, 4, GSF_CORRUPT, GSF_DAMAGED},    /* no last block */
};

static void test_blocks_after_the_picture(void **unused) {
    (void)unused;
    for (size_t i = 0; i < sizeof after_cases / sizeof *after_cases; i++) {
        const list_case *c = &after_cases[i];
        uint8_t list[16] = {0};
        memcpy(list + 3, c->bytes, c->size); /* the last byte and three zeros are the length */
        file f = made_file(0x20, NULL, 0, list, c->size + 6);
        check_result(&f, c->intact);
        f.bytes[f.size - 1] ^= 1;
        check_result(&f, c->damaged);
    }
}

static void test_zeros_after_the_picture(void **unused) {
    (void)unused;
    for (int at = 0; at < 3; at++) {
        uint8_t list[] = {0, 0, 0, 0xA0, 1, 9, 3, 0, 0, 0};
        list[at] = 1;
        const file f = made_file(0x20, NULL, 0, list, sizeof list);
        check_result(&f, GSF_CORRUPT);
    }
}

static void test_first_bytes(void **unused) {
    (void)unused;
    for (uint8_t version = 0; version < 16; version++) {
        file f = made_file(0, NULL, 0, NULL, 0);
        f.bytes[4] = version;
        store_check(&f);
        check_result(&f, version < GSF_VERSION ? GSF_NOT_GSCL : version > GSF_VERSION ? GSF_NEWER_VERSION : GSF_OK);
    }
    for (int bit = 6; bit < 8; bit++) {
        file f = made_file((uint8_t)(1 << bit), NULL, 0, NULL, 0);
        check_result(&f, GSF_CORRUPT);
    }
    file f = made_file(0, NULL, 0, NULL, 0);
    for (int i = 0; i < 4; i++) {
        f.bytes[i] ^= 1;
        store_check(&f);
        check_result(&f, GSF_NOT_GSCL);
        f.bytes[i] ^= 1;
    }
}

/* ---- Cut and damaged files ---- */

static void test_every_cut(void **unused) {
    (void)unused;
    file f;
    assert_int_equal(write_file(all_blocks, false, &f), GSF_OK);
    for (size_t size = 0; size < f.size; size++) {
        const gsf_result result = read_file(f.bytes, size, false);
        assert_true(size < 4 ? result == GSF_NOT_GSCL
                             : result == GSF_TRUNCATED || result == GSF_DAMAGED || result == GSF_NO_SPACE);
    }
    assert_int_equal(write_file(NULL, false, &f), GSF_OK);
    for (size_t cut = 1; cut <= 2; cut++) /* the check */
        assert_int_equal(read_file(f.bytes, f.size - cut, false), GSF_TRUNCATED);
}

static void test_every_changed_byte(void **unused) {
    (void)unused;
    file f;
    assert_int_equal(write_file(all_blocks, false, &f), GSF_OK);
    for (size_t i = 0; i < f.size; i++) {
        for (unsigned change = 1; change < 256; change += 17) {
            f.bytes[i] ^= (uint8_t)change;
            const gsf_result result = read_file(f.bytes, f.size, false);
            assert_true(i < 4    ? result == GSF_NOT_GSCL
                        : i == 4 ? result != GSF_OK
                                 : result == GSF_TRUNCATED || result == GSF_DAMAGED || result == GSF_NO_SPACE);
            f.bytes[i] ^= (uint8_t)change;
        }
    }
}

static void test_picture_of_another_length(void **unused) {
    (void)unused;
    file f;
    assert_int_equal(write_file(NULL, false, &f), GSF_OK);
    f.size++;
    store_check(&f);
    check_result(&f, GSF_CORRUPT);
    f.size -= 2;
    store_check(&f);
    check_result(&f, GSF_CORRUPT);
}

/* ---- The header of a picture ---- */

/* Codes a header, decodes it and returns its bits times 256. */
static uint64_t check_header(const gsf_coded_image *image) {
    uint8_t bytes[64];
    gsf_coder coder;
    gsf_coded_image written = *image, read = {.header = {.width = 0}};
    memset(stream_bits256, 0, sizeof stream_bits256);
    assert_true(gsf_header_is_valid(&image->header));
    gsf_coder_write_to(&coder, bytes, sizeof bytes, stream_bits256);
    gsf_code_header(&coder, &written);
    gsf_range_encoder_finish(&coder.encoder);
    gsf_coder_read_from(&coder, bytes, coder.encoder.size, NULL);
    gsf_code_header(&coder, &read);
    assert_false(gsf_coder_overrun(&coder));
    const gsf_header *a = &image->header, *b = &read.header;
    assert_true(a->blend == b->blend && a->coding == b->coding && a->layout == b->layout);
    assert_true(a->high_bit_depth == b->high_bit_depth && a->has_chroma == b->has_chroma);
    assert_true(a->has_alpha == b->has_alpha && a->has_opacity == b->has_opacity && a->has_texture == b->has_texture);
    assert_true(a->has_rotation == b->has_rotation && a->has_anisotropy == b->has_anisotropy);
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->splat_count, b->splat_count);
    if (a->coding == GSF_CODING_SCALAR && a->splat_count > 0)
        assert_memory_equal(&written.steps, &read.steps, sizeof read.steps);
    assert_true(read.has_mean_background == (image->has_mean_background && a->splat_count > 0));
    if (!read.has_mean_background)
        assert_memory_equal(image->background, read.background, gsf_channel_count(a) * sizeof *read.background);
    return stream_bits256[GSF_STREAM_HEADER] + stream_bits256[GSF_STREAM_SIDE];
}

static void test_every_kind(void **unused) {
    (void)unused;
    for (unsigned bits = 0; bits < 3u << 11; bits++) {
        gsf_coded_image image = {.header = {.blend = (gsf_blend)(bits >> 11),
                                            .coding = (gsf_coding)(bits & 1),
                                            .layout = (gsf_layout)(bits >> 1 & 3),
                                            .high_bit_depth = bits >> 3 & 1,
                                            .has_chroma = bits >> 4 & 1,
                                            .has_alpha = bits >> 5 & 1,
                                            .has_opacity = bits >> 6 & 1,
                                            .has_rotation = bits >> 7 & 1,
                                            .has_anisotropy = bits >> 8 & 1,
                                            .has_texture = bits >> 9 & 1,
                                            .width = 5,
                                            .height = 4,
                                            .splat_count = bits >> 10 & 1},
                                 .background = {200, 128, 128, 255},
                                 .has_mean_background = bits >> 8 & 1,
                                 .steps = {1, 2, 3, 4, 5, 6, 7, 8}};
        if (gsf_header_is_valid(&image.header))
            check_header(&image);
    }
}

static void test_sizes(void **unused) {
    (void)unused;
    static const uint32_t sides[] = {1,   2,   3,   5,    63,   64,   65,   127,  128,   375,   500,  512,
                                     640, 667, 768, 1023, 1024, 1025, 4000, 8191, 16320, 16383, 16384};
    const size_t count = sizeof sides / sizeof *sides;
    for (size_t i = 0; i < count * count; i++) {
        gsf_coded_image image = {.header = photo, .has_mean_background = true};
        image.header.width = sides[i % count];
        image.header.height = sides[i / count];
        check_header(&image);
    }
}

static void test_counts(void **unused) {
    (void)unused;
    for (uint32_t power = 1; power <= GSF_MAX_SPLATS; power *= 2) {
        const uint32_t counts[] = {power - 1, power, power + power / 3};
        for (int i = 0; i < 3; i++) {
            gsf_coded_image image = {.header = photo, .has_mean_background = true};
            image.header.splat_count = counts[i] < GSF_MAX_SPLATS ? counts[i] : GSF_MAX_SPLATS;
            check_header(&image);
        }
    }
}

static void test_steps_and_backgrounds(void **unused) {
    (void)unused;
    for (unsigned step = 0; step < 7; step++) {
        gsf_coded_image image = {.header = photo, .has_mean_background = true, .steps = gsf_default_steps(0)};
        image.header.splat_count = 9;
        const uint64_t cheap = check_header(&image);
        ((uint8_t *)&image.steps)[step] ^= 1;
        const uint64_t other = check_header(&image);
        /* The image has neither alpha nor opacities. */
        assert_true(step < 5 ? other > cheap + 19 * 256 : other == cheap);
    }
    for (unsigned is_deep = 0; is_deep < 2; is_deep++) {
        gsf_coded_image image = {.header = photo, .background = {128, 1, 255}, .steps = gsf_default_steps(0)};
        image.header.high_bit_depth = is_deep;
        image.header.splat_count = 1;
        const uint64_t own = check_header(&image);
        image.has_mean_background = true;
        const uint64_t mean = check_header(&image);
        assert_in_range(own - mean, is_deep ? 48 * 256 : 24 * 256, is_deep ? 52 * 256 : 28 * 256);
        image.header.splat_count = 0; /* then there is no mean */
        check_header(&image);
    }
}

/* Magic, version, kind, size, steps, background and check of a photograph: at most ten bytes with the rounding at the
 * end, and five without the container. */
static void test_overhead_of_a_photograph(void **unused) {
    (void)unused;
    for (int portrait = 0; portrait < 2; portrait++) {
        for (int texture = 0; texture < 2; texture++) {
            gsf_coded_image image = {.header = photo, .has_mean_background = true, .steps = gsf_default_steps(0)};
            image.header.width = portrait ? 512 : 768;
            image.header.height = portrait ? 768 : 512;
            image.header.has_texture = texture;
            image.header.splat_count = 200;
            image.steps.pivot = (uint8_t)gsf_typical_size(&image.header, &image.steps);
            const uint64_t with_count = check_header(&image);
            assert_in_range(with_count, 18 * 256, 24 * 256);
            assert_in_range(with_count - 7 * 256 - 3 * 256, 0, 16 * 256); /* the count takes 3.2 and 7 bits */
        }
    }
}

/* Whatever the bytes are, the header is valid. */
static void test_random_headers_are_valid(void **unused) {
    (void)unused;
    uint32_t state = 1;
    for (int i = 0; i < 20000; i++) {
        uint8_t bytes[32];
        gsf_coder coder;
        gsf_coded_image image = {.header = {.width = 0}};
        for (size_t k = 0; k < sizeof bytes; k++) {
            state = state * 1664525u + 1013904223u;
            bytes[k] = (uint8_t)(state >> 24);
        }
        gsf_coder_read_from(&coder, bytes, sizeof bytes, NULL);
        gsf_code_header(&coder, &image);
        assert_true(gsf_header_is_valid(&image.header));
        check_header(&image);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_check_value),
        cmocka_unit_test(test_blocks_round_trip),
        cmocka_unit_test(test_bare_file_is_the_picture),
        cmocka_unit_test(test_writer_refuses_blocks),
        cmocka_unit_test(test_lengths_of_blocks),
        cmocka_unit_test(test_blocks_before_the_picture),
        cmocka_unit_test(test_blocks_after_the_picture),
        cmocka_unit_test(test_zeros_after_the_picture),
        cmocka_unit_test(test_first_bytes),
        cmocka_unit_test(test_every_cut),
        cmocka_unit_test(test_every_changed_byte),
        cmocka_unit_test(test_picture_of_another_length),
        cmocka_unit_test(test_every_kind),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_steps_and_backgrounds),
        cmocka_unit_test(test_overhead_of_a_photograph),
        cmocka_unit_test(test_random_headers_are_valid),
    };
    return cmocka_run_group_tests(tests, fill_contents, NULL);
}
