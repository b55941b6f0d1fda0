#include "image/exif.h"

#include <string.h>

#include "image/tiff_tags.h"

enum {
    TAG_INTEROPERABILITY_INDEX = 0x0001,
    TAG_ORIENTATION = 0x0112,
    TAG_THUMBNAIL = 0x0201,
    TAG_THUMBNAIL_SIZE = 0x0202,
    TAG_EXIF_DIRECTORY = 0x8769,
    TAG_COLOUR_SPACE = 0xA001,
    TAG_INTEROPERABILITY_DIRECTORY = 0xA005,
};

/* Values of TAG_COLOUR_SPACE.  ADOBE_RGB is not of the standard, but some cameras write it. */
enum { COLOUR_SPACE_SRGB = 1, COLOUR_SPACE_ADOBE_RGB = 2 };

/* Values of TAG_INTEROPERABILITY_INDEX: the optional colour space of DCF, which is Adobe RGB, and the basic one, sRGB. */
static const char index_adobe_rgb[4] = "R03", index_srgb[4] = "R98";

static bool open_exif(tiff_view *view, const image_blob *exif) {
    return exif->size > 0 && tiff_open(view, exif->bytes, exif->size) && !view->is_big_tiff;
}

void exif_trim(image_blob *exif) {
    if (exif->size < 6 || memcmp(exif->bytes, "Exif\0", 6) != 0)
        return;
    exif->size -= 6;
    memmove(exif->bytes, exif->bytes + 6, exif->size);
    if (exif->size == 0)
        image_blob_free(exif);
}

bool exif_is_valid(const image_blob *exif) {
    tiff_view view;
    return open_exif(&view, exif);
}

int exif_orientation(const image_blob *exif) {
    tiff_view view;
    if (!open_exif(&view, exif))
        return 0;
    const uint64_t orientation = tiff_find_number(&view, view.directory, TAG_ORIENTATION, 0);
    return orientation <= 8 ? (int)orientation : 0;
}

void exif_set_upright(image_blob *exif) {
    tiff_view view;
    tiff_entry entry;
    if (!open_exif(&view, exif) || !tiff_find(&view, view.directory, TAG_ORIENTATION, &entry) || entry.count == 0)
        return;
    if (entry.type == TIFF_SHORT)
        tiff_put16(&view, entry.value, 1);
    else if (entry.type == TIFF_LONG)
        tiff_put32(&view, entry.value, 1);
}

/* Finds the values about colours; those that are missing have count 0. */
static void find_colours(const tiff_view *view, tiff_entry *space, tiff_entry *index) {
    const uint64_t exif = tiff_find_number(view, view->directory, TAG_EXIF_DIRECTORY, 0);
    const uint64_t interoperability = tiff_find_number(view, exif, TAG_INTEROPERABILITY_DIRECTORY, 0);
    if (!tiff_find(view, exif, TAG_COLOUR_SPACE, space) || space->type != TIFF_SHORT)
        *space = (tiff_entry){0};
    if (!tiff_find(view, interoperability, TAG_INTEROPERABILITY_INDEX, index) || index->type != TIFF_ASCII ||
        index->count != sizeof index_srgb)
        *index = (tiff_entry){0};
}

bool exif_names_adobe_rgb(const image_blob *exif) {
    tiff_view view;
    tiff_entry space, index;
    if (!open_exif(&view, exif))
        return false;
    find_colours(&view, &space, &index);
    const uint64_t value = tiff_number(&view, &space);
    if (value == COLOUR_SPACE_ADOBE_RGB)
        return true;
    return value != COLOUR_SPACE_SRGB && index.count &&
           memcmp(view.bytes + index.value, index_adobe_rgb, sizeof index_adobe_rgb) == 0;
}

void exif_set_srgb(image_blob *exif) {
    tiff_view view;
    tiff_entry space, index;
    if (!open_exif(&view, exif))
        return;
    find_colours(&view, &space, &index);
    if (space.count)
        tiff_put16(&view, space.value, COLOUR_SPACE_SRGB);
    if (index.count)
        memcpy(view.bytes + index.value, index_srgb, sizeof index_srgb);
}

void exif_drop_thumbnail(image_blob *exif) {
    tiff_view view;
    if (!open_exif(&view, exif))
        return;
    const uint64_t second = tiff_next_directory(&view, view.directory);
    if (second == 0)
        return;
    const uint64_t thumbnail = tiff_find_number(&view, second, TAG_THUMBNAIL, 0);
    const uint64_t size = tiff_find_number(&view, second, TAG_THUMBNAIL_SIZE, 0);
    tiff_put32(&view, (size_t)view.directory + 2 + tiff_entry_count(&view, view.directory) * TIFF_ENTRY_SIZE, 0);
    /* Bytes in the middle stay, because offsets to what follows would become wrong. */
    if (thumbnail > second && size > 0 && thumbnail + size >= exif->size && thumbnail < exif->size)
        exif->size = (size_t)thumbnail;
}

void xmp_set_upright(image_blob *xmp) {
    static const char name[] = "tiff:Orientation";
    const size_t length = sizeof name - 1;
    for (size_t at = 0; at + length + 2 < xmp->size; at++) {
        if (memcmp(xmp->bytes + at, name, length) != 0)
            continue;
        /* An attribute, ="6", or an element, >6<. */
        size_t digit = at + length + (xmp->bytes[at + length] == '=' ? 2 : 1);
        if (digit < xmp->size && xmp->bytes[digit] >= '2' && xmp->bytes[digit] <= '8')
            xmp->bytes[digit] = '1';
    }
}
