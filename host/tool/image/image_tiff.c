#include "image/image_tiff.h"

#include <string.h>

#include "image/tiff_tags.h"

enum { PHOTOMETRIC_INKS = 5, PHOTOMETRIC_RAW = 32803, INK_SET_CMYK = 1 };

bool image_is_tiff(const uint8_t *bytes, size_t size) {
    return size >= 4 && (memcmp(bytes, "II*\0", 4) == 0 || memcmp(bytes, "MM\0*", 4) == 0);
}

bool image_tiff_is_raw(const uint8_t *bytes, size_t size) {
    tiff_view view;
    tiff_entry entry;
    if (size >= 10 && memcmp(bytes + 8, "CR", 2) == 0)
        return true;
    return tiff_open(&view, (uint8_t *)(uintptr_t)bytes, size) /* it only reads */ &&
           (tiff_find(&view, view.directory, TAG_SUBDIRECTORIES, &entry) ||
            tiff_find(&view, view.directory, TAG_DNG_VERSION, &entry) ||
            tiff_find_number(&view, view.directory, TAG_PHOTOMETRIC, 0) == PHOTOMETRIC_RAW);
}

bool image_tiff_lacks_bits(const uint8_t *bytes, size_t size) {
    tiff_view view;
    tiff_entry entry;
    return tiff_open(&view, (uint8_t *)(uintptr_t)bytes, size) /* it only reads */ &&
           !tiff_find(&view, view.directory, TAG_BITS, &entry);
}

/* ---- EXIF: a TIFF structure of its own ----------------------------------------------------------- */

/* Whether an entry goes into the block: at the top those that describe the image and not its storage, deeper down all. */
static bool belongs_to_exif(uint16_t tag, int depth) {
    return depth > 0 || tiff_tag_describes_image(tag);
}

static bool is_directory(uint16_t tag, int depth) {
    return depth == 0 ? tag == TAG_EXIF || tag == TAG_GPS : depth == 1 && tag == TAG_INTEROPERABILITY;
}

/* Reads the next entry of a directory from *index on that belongs to the block.  Tags must ascend, as TIFF requires, so
 * that no forged directory is visited twice. */
static bool next_entry(const tiff_view *view, uint32_t directory, int depth, unsigned *index, int *last_tag,
                       tiff_entry *entry) {
    const unsigned count = tiff_entry_count(view, directory);
    while (*index < count) {
        if (!tiff_entry_read(view, directory, (*index)++, entry) || entry->tag <= *last_tag ||
            !belongs_to_exif(entry->tag, depth))
            continue;
        *last_tag = entry->tag;
        return true;
    }
    return false;
}

static unsigned count_entries(const tiff_view *view, uint32_t directory, int depth) {
    unsigned index = 0, count = 0;
    int last_tag = -1;
    tiff_entry entry;
    while (next_entry(view, directory, depth, &index, &last_tag, &entry))
        count++;
    return count;
}

static bool append_zeros(image_blob *blob, size_t size) {
    static const uint8_t zeros[64];
    bool ok = true;
    for (; ok && size > 0; size -= size < sizeof zeros ? size : sizeof zeros)
        ok = image_blob_append(blob, zeros, size < sizeof zeros ? size : sizeof zeros);
    return ok;
}

static bool copy_directory(const tiff_view *view, uint32_t directory, int depth, image_blob *exif);

/* Copies an entry to the offset `at` of the block, and its value to the end of the block. */
static bool copy_entry(const tiff_view *view, const tiff_entry *entry, int depth, image_blob *exif, size_t at) {
    uint32_t offset = (uint32_t)exif->size;
    memcpy(exif->bytes + at, view->bytes + entry->at, TIFF_ENTRY_SIZE);
    if (is_directory(entry->tag, depth)) {
        if (!copy_directory(view, tiff_number(view, entry), depth + 1, exif))
            return false;
    } else if (entry->value_size > 4) {
        if (!image_blob_append(exif, view->bytes + entry->value, entry->value_size) ||
            !append_zeros(exif, entry->value_size % 2))
            return false;
    } else {
        return true;
    }
    const tiff_view copy = {.bytes = exif->bytes, .size = exif->size, .big_endian = view->big_endian};
    tiff_put32(&copy, at + 8, offset);
    return true;
}

/* Appends a directory to the block. */
static bool copy_directory(const tiff_view *view, uint32_t directory, int depth, image_blob *exif) {
    const unsigned count = count_entries(view, directory, depth);
    size_t at = exif->size + 2;
    if (count == 0 || !append_zeros(exif, 2 + (size_t)count * TIFF_ENTRY_SIZE + 4))
        return false;
    const tiff_view copy = {.bytes = exif->bytes, .size = exif->size, .big_endian = view->big_endian};
    tiff_put16(&copy, at - 2, (uint16_t)count);
    unsigned index = 0;
    int last_tag = -1;
    tiff_entry entry;
    for (; next_entry(view, directory, depth, &index, &last_tag, &entry); at += TIFF_ENTRY_SIZE) {
        if (!copy_entry(view, &entry, depth, exif, at))
            return false;
    }
    return true;
}

static void take_exif(const tiff_view *view, image_blob *exif) {
    static const uint8_t little[8] = "II*\0\x08\0\0", big[8] = "MM\0*\0\0\0\x08";
    if (count_entries(view, view->directory, 0) > 0 &&
        (!image_blob_set(exif, view->big_endian ? big : little, 8) || !copy_directory(view, view->directory, 0, exif)))
        image_blob_free(exif);
}

/* ---- Other metadata ---------------------------------------------------------------------------- */

static void take_profile(const tiff_view *view, image_content *content) {
    tiff_entry entry;
    if (tiff_find(view, view->directory, TAG_ICC, &entry))
        content->damaged_profile = entry.value_size == 0 ||
                                   !image_blob_set(&content->metadata.icc, view->bytes + entry.value, entry.value_size);
}

static void take_xmp(const tiff_view *view, image_blob *xmp) {
    tiff_entry entry;
    if (tiff_find(view, view->directory, TAG_XMP, &entry))
        image_blob_set(xmp, view->bytes + entry.value, entry.value_size);
}

static bool is_metadata(uint16_t tag) {
    return tag == TAG_XMP || tag == TAG_IPTC || tag == TAG_PHOTOSHOP || tag == TAG_EXIF || tag == TAG_ICC ||
           tag == TAG_GPS || tag == TAG_LAYERS;
}

/* Gives entries a type that does not exist, so that libtiff ignores them. */
static void hide_metadata(const tiff_view *view, image_content *content) {
    const unsigned count = tiff_entry_count(view, view->directory);
    for (unsigned i = 0; i < count; i++) {
        tiff_entry entry;
        const bool readable = tiff_entry_read(view, view->directory, i, &entry);
        if (!is_metadata(entry.tag))
            continue;
        if (entry.tag == TAG_ICC && !readable)
            content->damaged_profile = true;
        if (readable && (entry.tag == TAG_IPTC || entry.tag == TAG_PHOTOSHOP || entry.tag == TAG_LAYERS))
            content->other_bytes += entry.value_size;
        tiff_put16(view, entry.at + 2, 0);
    }
}

void image_take_tiff_metadata(uint8_t *bytes, size_t size, image_content *content) {
    tiff_view view;
    if (!tiff_open(&view, bytes, size))
        return;
    const uint32_t directory = view.directory;
    const uint32_t orientation = tiff_find_number(&view, directory, TAG_ORIENTATION, 1);
    content->orientation = orientation <= 8 ? (int)orientation : 1;
    content->cmyk = tiff_find_number(&view, directory, TAG_PHOTOMETRIC, 0) == PHOTOMETRIC_INKS &&
                    tiff_find_number(&view, directory, TAG_INK_SET, INK_SET_CMYK) == INK_SET_CMYK &&
                    tiff_find_number(&view, directory, TAG_SAMPLES, 4) == 4;
    take_profile(&view, content);
    take_xmp(&view, &content->metadata.xmp);
    take_exif(&view, &content->metadata.exif);
    hide_metadata(&view, content);
}
