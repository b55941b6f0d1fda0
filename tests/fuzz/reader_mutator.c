#include "mutator.h"

#include <stdbool.h>
#include <string.h>

#include "coded_memory.h"
#include "format/coder.h"
#include "format/payload.h"

#define FIXED_SIZE 5u   /* magic and version */
#define ROOM (1u << 16) /* bytes of a picture or of a list of blocks that is put together here */

static const uint8_t START[FIXED_SIZE] = {0xC7, 'g', 's', 'c', GSF_VERSION};

static bool is_whole(const uint8_t *data, size_t size) {
    return size >= FIXED_SIZE + GSF_CHECK_SIZE && memcmp(data, START, 4) == 0;
}

/* Makes the check match. */
static void seal(uint8_t *data, size_t size) {
    gsf_put_check(data, size - GSF_CHECK_SIZE, 0);
}

static size_t mutate_picture(uint8_t *picture, size_t size, size_t max_size) {
    return fuzz_picture_end(picture, LLVMFuzzerMutate(picture, size, max_size), false);
}

/* Changes the picture of a whole file, whose blocks stay. */
static size_t mutate_inside(uint8_t *data, size_t size, size_t max_size) {
    static uint8_t picture[ROOM], after[ROOM];
    gsf_container container;
    if (size > ROOM || size >= max_size || gsf_open_container(data, size, &container) != GSF_OK)
        return size;
    const size_t start = (size_t)(container.picture.data - data), old = container.picture.size;
    const size_t after_size = size - start - old, room = max_size - start - after_size;
    memcpy(picture, data + start, old);
    memcpy(after, data + start + old, after_size);
    const size_t now = mutate_picture(picture, old, room < ROOM ? room : ROOM);
    if (now > room)
        return size;
    memcpy(data + start, picture, now);
    memcpy(data + start + now, after, after_size);
    return start + now + after_size;
}

/* Changes one code of one splat a little. */
static void change_splat(gsf_coded_image *image) {
    const uint32_t i = fuzz_pick(image->header.splat_count);
    const int step = (int)fuzz_pick(9) - 4;
    gsf_splat *s = &image->splats[i];
    uint16_t *codes[] = {&s->major,          &s->aspect,           &s->angle,
                         &s->opacity,        (uint16_t *)&s->luma, (uint16_t *)&s->co,
                         (uint16_t *)&s->cg, (uint16_t *)&s->alpha};
    const uint32_t which = fuzz_pick(10);
    if (image->header.coding == GSF_CODING_CODEBOOK)
        image->indexed[i].x = (uint16_t)(image->indexed[i].x + step);
    else if (which < 8)
        *codes[which] = (uint16_t)(*codes[which] + step);
    else if (which == 8)
        s->x += (uint32_t)step;
    else
        s->texture = (gsf_texture){(uint8_t)fuzz_pick(16), (uint8_t)fuzz_pick(16), (uint8_t)fuzz_pick(8),
                                   (uint8_t)fuzz_pick(17)};
}

/* Changes codes and writes them again. */
static size_t mutate_codes(uint8_t *data, size_t size, size_t max_size) {
    static fuzz_memory memory;
    static uint8_t file[FUZZ_MAX_FILE];
    const bool bare = !is_whole(data, size);
    gsf_header header;
    gsf_coded_image image;
    size_t written = 0;
    if (gsf_read_header(data, size, bare, &header) != GSF_OK || header.splat_count == 0 ||
        !fuzz_create(&image, &memory, &header))
        return size;
    image.bare = bare;
    if (gsf_read(data, size, &image, fuzz_scratch(&header)) != GSF_OK)
        return size;
    change_splat(&image);
    if (gsf_write(&image, file, FUZZ_MAX_FILE, &written, fuzz_scratch(&header)) != GSF_OK || written > max_size)
        return size;
    memcpy(data, file, written);
    return written;
}

/* Writes a block with some bytes of content. */
static size_t put_block(uint8_t *at, unsigned type, bool last) {
    const uint32_t size = type == 0 && fuzz_pick(8) > 0 ? 2 : fuzz_pick(20);
    *at++ = (uint8_t)(type | (fuzz_pick(8) == 0 ? 0x40 : 0) | (last ? 0x80 : 0));
    *at++ = (uint8_t)size;
    for (uint32_t i = 0; i < size; i++)
        *at++ = (uint8_t)fuzz_pick(256);
    return size + 2;
}

static size_t put_blocks(uint8_t *at, unsigned first) {
    size_t size = 0;
    const bool two = fuzz_pick(2);
    if (two)
        size = put_block(at, first + fuzz_pick(2), false);
    return size + put_block(at + size, first + 1 + fuzz_pick(fuzz_pick(4) == 0 ? 30 : 2), true);
}

/* Puts new blocks around the picture, or takes all away; sometimes the container, too. */
static size_t change_form(uint8_t *data, size_t size, size_t max_size) {
    static uint8_t file[2 * ROOM];
    gsf_container container = {.picture = {data, size}};
    if (size > ROOM || (is_whole(data, size) && gsf_open_container(data, size, &container) != GSF_OK))
        return size;
    const bool before = fuzz_pick(2), after = fuzz_pick(2), bare = fuzz_pick(8) == 0;
    size_t at = bare ? 0 : FIXED_SIZE, list = 0;
    memcpy(file, START, FIXED_SIZE);
    file[4] = (uint8_t)(file[4] | (before ? 0x10 : 0) | (after ? 0x20 : 0));
    at += before && !bare ? put_blocks(file + at, 0) : 0;
    memcpy(file + at, container.picture.data, container.picture.size);
    at += container.picture.size;
    if (after && !bare) {
        memset(file + at, 0, 3);
        list = put_blocks(file + at + 3, 32);
        at += 3 + list;
        for (unsigned i = 0; i < 4; i++)
            file[at++] = (uint8_t)(list >> (8 * i));
    }
    at += bare ? 0 : GSF_CHECK_SIZE;
    if (at > max_size)
        return size;
    memcpy(data, file, at);
    return at;
}

static size_t mutate(uint8_t *data, size_t size, size_t max_size) {
    const uint32_t kind = fuzz_pick(8);
    if (kind < 3)
        return LLVMFuzzerMutate(data, size, max_size);
    if (kind < 6)
        return is_whole(data, size) ? mutate_inside(data, size, max_size) : mutate_picture(data, size, max_size);
    return kind == 6 ? mutate_codes(data, size, max_size) : change_form(data, size, max_size);
}

size_t fuzz_mutate_file(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    fuzz_begin_picks(seed);
    size = mutate(data, size, max_size);
    if (is_whole(data, size) && fuzz_pick(16) > 0)
        seal(data, size);
    return size;
}
