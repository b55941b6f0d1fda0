#include "image/image_heif.h"

#include <string.h>

#include "image/exif.h"

/* ---- Bytes and boxes (ISO/IEC 14496-12) --------------------------------------------------------------- */

/* The rest of a sequence of bytes.  Reading beyond its end gives 0 and empties it. */
typedef struct cursor {
    const uint8_t *at;
    size_t left;
} cursor;

static void skip(cursor *bytes, uint64_t count) {
    const size_t step = count < bytes->left ? (size_t)count : bytes->left;
    if (step == 0) /* nor may 0 be added to NULL, of a box that is missing */
        return;
    bytes->at += step;
    bytes->left -= step;
}

/* Reads a number of up to 8 bytes, most significant first. */
static uint64_t get(cursor *bytes, unsigned count) {
    uint64_t value = 0;
    for (unsigned i = 0; i < count && bytes->left >= count; i++)
        value = value << 8 | bytes->at[i];
    skip(bytes, bytes->left >= count ? count : bytes->left);
    return value;
}

typedef struct box {
    char type[4];
    cursor content;
} box;

/* Reads the next box of a sequence.  Returns false at the end, and where no box is. */
static bool next_box(cursor *boxes, box *found) {
    const cursor start = *boxes;
    if (boxes->left < 8)
        return false;
    uint64_t size = get(boxes, 4);
    memcpy(found->type, boxes->at, 4);
    skip(boxes, 4);
    if (size == 1)
        size = get(boxes, 8);
    else if (size == 0)
        size = start.left;
    const size_t header = start.left - boxes->left;
    if (size < header || size > start.left)
        return false;
    found->content = (cursor){start.at + header, (size_t)size - header};
    *boxes = start;
    skip(boxes, size);
    return true;
}

static bool is_type(const box *found, const char *type) {
    return memcmp(found->type, type, 4) == 0;
}

/* The content of the first box of a type; empty if there is none. */
static cursor find_box(cursor boxes, const char *type) {
    box found;
    while (next_box(&boxes, &found)) {
        if (is_type(&found, type))
            return found.content;
    }
    return (cursor){NULL, 0};
}

/* ---- Colours ----------------------------------------------------------------------------------- */

static void take_code_points(cursor *colours, image_metadata *metadata) {
    const uint64_t primaries = get(colours, 2), transfer = get(colours, 2);
    if (metadata->has_cicp || primaries > 255 || transfer > 255)
        return;
    metadata->has_cicp = true;
    metadata->cicp[0] = (uint8_t)primaries;
    metadata->cicp[1] = (uint8_t)transfer;
}

/* Takes the first profile, or the first code points, of the properties of all images of the file. */
static void take_colours(cursor properties, image_content *content) {
    image_metadata *metadata = &content->metadata;
    box property;
    while (next_box(&properties, &property)) {
        cursor *colours = &property.content;
        if (!is_type(&property, "colr") || colours->left < 4)
            continue;
        const uint8_t *kind = colours->at;
        skip(colours, 4);
        if (memcmp(kind, "nclx", 4) == 0)
            take_code_points(colours, metadata);
        else if ((memcmp(kind, "prof", 4) == 0 || memcmp(kind, "rICC", 4) == 0) && !metadata->icc.size)
            content->damaged_profile =
                colours->left == 0 || !image_blob_set(&metadata->icc, colours->at, colours->left);
    }
    if (metadata->icc.size)
        metadata->has_cicp = false;
}

/* ---- Items: EXIF and XMP ------------------------------------------------------------------------- */

/* Whether an entry of the list of items is of a type, and for "mime" of XMP.  Sets its number. */
static bool is_item(cursor entry, const char *type, uint64_t *item) {
    static const char xmp[] = "application/rdf+xml";
    const uint64_t version = get(&entry, 1);
    skip(&entry, 3);
    *item = get(&entry, version >= 3 ? 4 : 2);
    skip(&entry, 2);
    if (version < 2 || entry.left < 4 || memcmp(entry.at, type, 4) != 0)
        return false;
    skip(&entry, 4);
    const uint8_t *end = entry.left ? memchr(entry.at, 0, entry.left) : NULL; /* of the name */
    if (memcmp(type, "mime", 4) != 0)
        return true;
    skip(&entry, end ? (uint64_t)(end - entry.at) + 1 : entry.left);
    return entry.left >= sizeof xmp && memcmp(entry.at, xmp, sizeof xmp) == 0;
}

static bool find_item(cursor items, const char *type, uint64_t *item) {
    box entry;
    const uint64_t version = get(&items, 1);
    skip(&items, 3 + (version == 0 ? 2u : 4u));
    while (next_box(&items, &entry)) {
        if (is_type(&entry, "infe") && is_item(entry.content, type, item))
            return true;
    }
    return false;
}

/* Copies the extents of an item that lie in the file. */
static void copy_extents(cursor *locations, cursor file, uint64_t base, unsigned index_size, unsigned offset_size,
                         unsigned length_size, image_blob *blob) {
    uint64_t extents = get(locations, 2);
    if (index_size + offset_size + length_size == 0)
        return;
    for (; extents > 0 && locations->left > 0; extents--) {
        skip(locations, index_size);
        const uint64_t offset = base + get(locations, offset_size), length = get(locations, length_size);
        if (!blob || offset < base || offset > file.left || length > file.left - offset)
            continue;
        image_blob_append(blob, file.at + offset, (size_t)length);
    }
}

/* Copies an item whose place the box of locations gives. */
static void copy_item(cursor locations, cursor file, uint64_t item, image_blob *blob) {
    const uint64_t version = get(&locations, 1);
    skip(&locations, 3);
    const unsigned sizes = (unsigned)get(&locations, 2);
    const unsigned offset_size = sizes >> 12, length_size = sizes >> 8 & 15, base_size = sizes >> 4 & 15;
    const unsigned index_size = version > 0 ? sizes & 15 : 0;
    if (version > 2 || offset_size > 8 || length_size > 8 || base_size > 8)
        return;
    for (uint64_t items = get(&locations, version < 2 ? 2 : 4); items > 0 && locations.left > 0; items--) {
        const bool wanted = get(&locations, version < 2 ? 2 : 4) == item;
        const uint64_t method = version > 0 ? get(&locations, 2) & 15 : 0;
        skip(&locations, 2);
        const uint64_t base = get(&locations, base_size);
        copy_extents(&locations, file, base, index_size, offset_size, length_size, wanted && method == 0 ? blob : NULL);
    }
}

static void take_items(cursor meta, cursor file, image_metadata *metadata) {
    const cursor items = find_box(meta, "iinf"), locations = find_box(meta, "iloc");
    uint64_t item;
    if (find_item(items, "mime", &item))
        copy_item(locations, file, item, &metadata->xmp);
    if (!find_item(items, "Exif", &item))
        return;
    image_blob exif = {0};
    copy_item(locations, file, item, &exif);
    cursor block = {exif.bytes, exif.size};
    skip(&block, get(&block, 4)); /* to the header of TIFF */
    image_blob_set(&metadata->exif, block.at, block.left);
    exif_trim(&metadata->exif);
    image_blob_free(&exif);
}

/* ---- The file ---------------------------------------------------------------------------------- */

void image_take_heif_metadata(const uint8_t *bytes, size_t size, image_content *content) {
    const cursor file = {bytes, size};
    cursor meta = find_box(file, "meta");
    skip(&meta, 4); /* version and flags */
    take_colours(find_box(find_box(meta, "iprp"), "ipco"), content);
    take_items(meta, file, &content->metadata);
    content->orientation = 1;
}
