#include "image/image_ico.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "image/image_kind.h"
#include "image/image_samples.h"

enum { FOLDER_SIZE = 6, ENTRY_SIZE = 16, DIB_SIZE = 40, BMP_HEADER_SIZE = 14 };

static uint32_t get32(const uint8_t *b) {
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static void put32(uint8_t *b, uint32_t value) {
    for (int i = 0; i < 4; i++)
        b[i] = (uint8_t)(value >> 8 * i);
}

static unsigned get16(const uint8_t *b) {
    return (unsigned)b[0] | (unsigned)b[1] << 8;
}

/* Rank of an entry: by pixels, then by bits, which in cursors are a coordinate. */
static uint64_t rank_of(const uint8_t *entry, bool is_icon) {
    const uint64_t width = entry[0] ? entry[0] : 256, height = entry[1] ? entry[1] : 256;
    return (width * height) << 16 | (is_icon ? get16(entry + 6) : 0);
}

static const uint8_t *find_entry(const uint8_t *bytes, size_t size) {
    const size_t count = get16(bytes + 4);
    const uint8_t *best = NULL;
    for (size_t i = 0; i < count && FOLDER_SIZE + (i + 1) * ENTRY_SIZE <= size; i++) {
        const uint8_t *entry = bytes + FOLDER_SIZE + i * ENTRY_SIZE;
        if (!best || rank_of(entry, bytes[2] == 1) > rank_of(best, bytes[2] == 1))
            best = entry;
    }
    return best;
}

/* Bytes of a row of a bitmap. */
static size_t row_size(uint32_t width, unsigned bits) {
    return ((size_t)width * bits + 31) / 32 * 4;
}

/* Makes a BMP file of a bitmap, whose height counts the mask, too. */
static bool make_bmp(const uint8_t *dib, size_t size, ico_image *found, char *message) {
    const uint32_t width = get32(dib + 4), height = get32(dib + 8) / 2, colours = get32(dib + 32);
    const unsigned bits = get16(dib + 14);
    const bool has_palette = bits == 1 || bits == 4 || bits == 8;
    if (get32(dib) != DIB_SIZE || get32(dib + 16) != 0 || !(has_palette || bits == 24 || bits == 32) || width < 1 ||
        width > 256 || height < 1 || height > 256 || colours > 256) {
        snprintf(message, IMAGE_MESSAGE_SIZE, "is an icon whose bitmap is of an unusual kind; convert it to PNG first");
        return false;
    }
    const size_t palette = has_palette ? 4 * (size_t)(colours ? colours : 1u << bits) : 0;
    const size_t pixels = row_size(width, bits) * height, mask = row_size(width, 1) * height;
    const size_t used = DIB_SIZE + palette + pixels;
    const bool has_mask = used + mask <= size; /* which some programs leave out where there is alpha */
    if (used > size || (!has_mask && bits != 32)) {
        snprintf(message, IMAGE_MESSAGE_SIZE, "ends too early; the file is truncated");
        return false;
    }
    found->size = BMP_HEADER_SIZE + used;
    found->bytes = calloc(found->size, 1);
    found->width = width;
    found->height = height;
    found->mask = has_mask ? dib + used : NULL;
    if (!found->bytes)
        return false;
    memcpy(found->bytes, "BM", 2);
    put32(found->bytes + 2, (uint32_t)found->size);
    put32(found->bytes + 10, (uint32_t)(BMP_HEADER_SIZE + DIB_SIZE + palette));
    memcpy(found->bytes + BMP_HEADER_SIZE, dib, used);
    put32(found->bytes + BMP_HEADER_SIZE + 8, height);
    return true;
}

bool ico_find_image(const uint8_t *bytes, size_t size, ico_image *found, char message[IMAGE_MESSAGE_SIZE]) {
    const uint8_t *entry = size >= FOLDER_SIZE ? find_entry(bytes, size) : NULL;
    const uint64_t at = entry ? get32(entry + 12) : 0, count = entry ? get32(entry + 8) : 0;
    *found = (ico_image){0};
    snprintf(message, IMAGE_MESSAGE_SIZE, "ends too early; the file is truncated");
    if (!entry || at > size || count > size - at || count < DIB_SIZE)
        return false;
    snprintf(message, IMAGE_MESSAGE_SIZE, "is too large for the available memory");
    found->is_png = image_kind_of(bytes + at, (size_t)count) == IMAGE_PNG;
    if (!found->is_png)
        return make_bmp(bytes + at, (size_t)count, found, message);
    found->size = (size_t)count;
    found->bytes = malloc(found->size);
    if (found->bytes)
        memcpy(found->bytes, bytes + at, found->size);
    return found->bytes != NULL;
}

bool ico_apply_mask(const ico_image *icon, gscl_image *image) {
    const size_t mask_row = row_size(image->width, 1);
    if (image->width != icon->width || image->height != icon->height || image->sample != GSCL_SAMPLE_U8)
        return false;
    if (image->channels % 2 == 0 && !image_alpha_is_clear(image))
        return true;
    if (image->channels % 2 == 0)
        image_drop_alpha(image);
    if (!icon->mask)
        return true;
    if (!image_add_alpha(image))
        return false;
    uint8_t *alpha = (uint8_t *)image->pixels + image->channels - 1;
    for (uint32_t y = 0; y < image->height; y++) {
        const uint8_t *row = icon->mask + (size_t)(image->height - 1 - y) * mask_row;
        for (uint32_t x = 0; x < image->width; x++, alpha += image->channels)
            *alpha = row[x / 8] >> (7 - x % 8) & 1 ? 0 : 255;
    }
    return true;
}
