#include "image/tiff_tags.h"

#include <string.h>

#define HEADER_SIZE 8

uint16_t tiff_get16(const tiff_view *view, size_t at) {
    const uint8_t *b = view->bytes + at;
    return (uint16_t)(view->big_endian ? b[0] << 8 | b[1] : b[1] << 8 | b[0]);
}

uint32_t tiff_get32(const tiff_view *view, size_t at) {
    const uint32_t first = tiff_get16(view, at), second = tiff_get16(view, at + 2);
    return view->big_endian ? first << 16 | second : second << 16 | first;
}

void tiff_put16(const tiff_view *view, size_t at, uint16_t value) {
    view->bytes[at + (view->big_endian ? 0 : 1)] = (uint8_t)(value >> 8);
    view->bytes[at + (view->big_endian ? 1 : 0)] = (uint8_t)value;
}

void tiff_put32(const tiff_view *view, size_t at, uint32_t value) {
    tiff_put16(view, at + (view->big_endian ? 0 : 2), (uint16_t)(value >> 16));
    tiff_put16(view, at + (view->big_endian ? 2 : 0), (uint16_t)value);
}

bool tiff_open(tiff_view *view, uint8_t *bytes, size_t size) {
    if (size < HEADER_SIZE || (memcmp(bytes, "II*\0", 4) != 0 && memcmp(bytes, "MM\0*", 4) != 0))
        return false;
    *view = (tiff_view){.bytes = bytes, .size = size, .big_endian = bytes[0] == 'M'};
    view->directory = tiff_get32(view, 4);
    return tiff_entry_count(view, view->directory) > 0;
}

unsigned tiff_entry_count(const tiff_view *view, uint32_t directory) {
    if (directory < HEADER_SIZE || directory > view->size - 2)
        return 0;
    const unsigned count = tiff_get16(view, directory);
    return count * (size_t)TIFF_ENTRY_SIZE <= view->size - directory - 2 ? count : 0;
}

uint32_t tiff_next_directory(const tiff_view *view, uint32_t directory) {
    const unsigned count = tiff_entry_count(view, directory);
    const size_t at = directory + 2 + (size_t)count * TIFF_ENTRY_SIZE;
    return count > 0 && view->size - at >= 4 ? tiff_get32(view, at) : 0;
}

bool tiff_entry_read(const tiff_view *view, uint32_t directory, unsigned index, tiff_entry *entry) {
    static const uint8_t type_size[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4};
    const size_t at = directory + 2 + (size_t)index * TIFF_ENTRY_SIZE;
    *entry = (tiff_entry){
        .tag = tiff_get16(view, at), .type = tiff_get16(view, at + 2), .count = tiff_get32(view, at + 4), .at = at};
    if (entry->type == 0 || entry->type >= sizeof type_size)
        return false;
    const uint64_t size = (uint64_t)entry->count * type_size[entry->type];
    entry->value = size <= 4 ? at + 8 : tiff_get32(view, at + 8);
    if (size > view->size || entry->value > view->size - size)
        return false;
    entry->value_size = (size_t)size;
    return true;
}

bool tiff_find(const tiff_view *view, uint32_t directory, uint16_t tag, tiff_entry *entry) {
    const unsigned count = tiff_entry_count(view, directory);
    for (unsigned i = 0; i < count; i++) {
        if (tiff_entry_read(view, directory, i, entry) && entry->tag == tag)
            return true;
    }
    return false;
}

uint32_t tiff_number(const tiff_view *view, const tiff_entry *entry) {
    if (entry->count == 0)
        return 0;
    if (entry->type == TIFF_SHORT)
        return tiff_get16(view, entry->value);
    return entry->type == TIFF_LONG || entry->type == TIFF_IFD ? tiff_get32(view, entry->value) : 0;
}

uint32_t tiff_find_number(const tiff_view *view, uint32_t directory, uint16_t tag, uint32_t otherwise) {
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
