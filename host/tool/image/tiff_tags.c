#include "image/tiff_tags.h"

#include <string.h>

#define HEADER_SIZE 8
#define BIG_HEADER_SIZE 16

uint16_t tiff_get16(const tiff_view *view, size_t at) {
    const uint8_t *b = view->bytes + at;
    return (uint16_t)(view->big_endian ? b[0] << 8 | b[1] : b[1] << 8 | b[0]);
}

uint32_t tiff_get32(const tiff_view *view, size_t at) {
    const uint32_t first = tiff_get16(view, at), second = tiff_get16(view, at + 2);
    return view->big_endian ? first << 16 | second : second << 16 | first;
}

uint64_t tiff_get64(const tiff_view *view, size_t at) {
    const uint64_t first = tiff_get32(view, at), second = tiff_get32(view, at + 4);
    return view->big_endian ? first << 32 | second : second << 32 | first;
}

void tiff_put16(const tiff_view *view, size_t at, uint16_t value) {
    view->bytes[at + (view->big_endian ? 0 : 1)] = (uint8_t)(value >> 8);
    view->bytes[at + (view->big_endian ? 1 : 0)] = (uint8_t)value;
}

void tiff_put32(const tiff_view *view, size_t at, uint32_t value) {
    tiff_put16(view, at + (view->big_endian ? 0 : 2), (uint16_t)(value >> 16));
    tiff_put16(view, at + (view->big_endian ? 2 : 0), (uint16_t)value);
}

/* ---- Sizes that differ in BigTIFF ----------------------------------------------------------------- */

static size_t entry_size(const tiff_view *view) {
    return view->is_big_tiff ? 20 : TIFF_ENTRY_SIZE;
}

/* Of the number of entries before a directory. */
static size_t count_size(const tiff_view *view) {
    return view->is_big_tiff ? 8 : 2;
}

/* Of an offset, and of the room for a value in its entry. */
static size_t offset_size(const tiff_view *view) {
    return view->is_big_tiff ? 8 : 4;
}

static uint64_t get_offset(const tiff_view *view, size_t at) {
    return view->is_big_tiff ? tiff_get64(view, at) : tiff_get32(view, at);
}

/* ---- Directories and entries ------------------------------------------------------------------------ */

bool tiff_open(tiff_view *view, uint8_t *bytes, size_t size) {
    if (size < HEADER_SIZE || (memcmp(bytes, "II", 2) != 0 && memcmp(bytes, "MM", 2) != 0))
        return false;
    *view = (tiff_view){.bytes = bytes, .size = size, .big_endian = bytes[0] == 'M'};
    const unsigned version = tiff_get16(view, 2);
    view->is_big_tiff = version == 43;
    if ((version != 42 && version != 43) || (view->is_big_tiff && size < BIG_HEADER_SIZE))
        return false;
    view->directory = get_offset(view, view->is_big_tiff ? 8 : 4);
    return tiff_entry_count(view, view->directory) > 0;
}

size_t tiff_entry_count(const tiff_view *view, uint64_t directory) {
    const size_t prefix = count_size(view);
    if (directory < HEADER_SIZE || view->size < prefix || directory > view->size - prefix)
        return 0;
    const size_t at = (size_t)directory, room = (view->size - at - prefix) / entry_size(view);
    const uint64_t count = view->is_big_tiff ? tiff_get64(view, at) : tiff_get16(view, at);
    return count <= room ? (size_t)count : 0;
}

uint64_t tiff_next_directory(const tiff_view *view, uint64_t directory) {
    const size_t count = tiff_entry_count(view, directory);
    if (count == 0)
        return 0;
    const size_t at = (size_t)directory + count_size(view) + count * entry_size(view);
    return view->size - at >= offset_size(view) ? get_offset(view, at) : 0;
}

bool tiff_entry_read(const tiff_view *view, uint64_t directory, size_t index, tiff_entry *entry) {
    static const uint8_t type_size[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
    const size_t at = (size_t)directory + count_size(view) + index * entry_size(view);
    const size_t value_at = at + 4 + offset_size(view);
    *entry = (tiff_entry){
        .tag = tiff_get16(view, at), .type = tiff_get16(view, at + 2), .count = get_offset(view, at + 4), .at = at};
    const size_t unit = entry->type < sizeof type_size ? type_size[entry->type] : 0;
    if (unit == 0 || entry->count > view->size / unit)
        return false;
    const size_t size = (size_t)entry->count * unit;
    const uint64_t value = size <= offset_size(view) ? value_at : get_offset(view, value_at);
    if (value > view->size - size)
        return false;
    entry->value = (size_t)value;
    entry->value_size = size;
    return true;
}

bool tiff_find(const tiff_view *view, uint64_t directory, uint16_t tag, tiff_entry *entry) {
    const size_t count = tiff_entry_count(view, directory);
    for (size_t i = 0; i < count; i++) {
        if (tiff_entry_read(view, directory, i, entry) && entry->tag == tag)
            return true;
    }
    return false;
}

uint64_t tiff_number_at(const tiff_view *view, const tiff_entry *entry, size_t index) {
    switch (entry->type) {
    case TIFF_SHORT:
        return tiff_get16(view, entry->value + 2 * index);
    case TIFF_LONG:
    case TIFF_IFD:
        return tiff_get32(view, entry->value + 4 * index);
    case TIFF_LONG8:
    case TIFF_IFD8:
        return tiff_get64(view, entry->value + 8 * index);
    default:
        return 0;
    }
}

uint64_t tiff_number(const tiff_view *view, const tiff_entry *entry) {
    return entry->count ? tiff_number_at(view, entry, 0) : 0;
}

uint64_t tiff_find_number(const tiff_view *view, uint64_t directory, uint16_t tag, uint64_t otherwise) {
    tiff_entry entry;
    return tiff_find(view, directory, tag, &entry) ? tiff_number(view, &entry) : otherwise;
}

bool tiff_tag_describes_image(uint16_t tag) {
    enum {
        DESCRIPTION = 270,
        MAKE,
        MODEL,
        SOFTWARE = 305,
        DATE,
        ARTIST = 315,
        COPYRIGHT = 33432,
        EXIF = 34665,
        GPS = 34853
    };
    switch (tag) {
    case DESCRIPTION:
    case MAKE:
    case MODEL:
    case SOFTWARE:
    case DATE:
    case ARTIST:
    case COPYRIGHT:
    case EXIF:
    case GPS:
        return true;
    default:
        return false;
    }
}
