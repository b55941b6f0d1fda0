#include "image/image_tiff.h"

#include <stdio.h>
#include <string.h>

#include "image/tiff_tags.h"

enum {
    PHOTOMETRIC_WHITE_IS_ZERO = 0,
    PHOTOMETRIC_BLACK_IS_ZERO = 1,
    PHOTOMETRIC_PALETTE = 3,
    PHOTOMETRIC_INKS = 5,
    PHOTOMETRIC_RAW = 32803,
    PHOTOMETRIC_LINEAR_RAW = 34892
};
enum { INK_SET_CMYK = 1, EXTRA_ASSOCIATED_ALPHA = 1, SUBFILE_REDUCED = 1 };
enum { FORMAT_UNSIGNED = 1, FORMAT_SIGNED = 2, FORMAT_FLOATING = 3 };

static uint64_t find_number(const tiff_view *view, uint16_t tag, uint64_t otherwise) {
    return tiff_find_number(view, view->directory, tag, otherwise);
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
static bool next_entry(const tiff_view *view, uint64_t directory, int depth, size_t *index, int *last_tag,
                       tiff_entry *entry) {
    const size_t count = tiff_entry_count(view, directory);
    while (*index < count) {
        if (!tiff_entry_read(view, directory, (*index)++, entry) || entry->tag <= *last_tag ||
            !belongs_to_exif(entry->tag, depth))
            continue;
        *last_tag = entry->tag;
        return true;
    }
    return false;
}

static unsigned count_entries(const tiff_view *view, uint64_t directory, int depth) {
    size_t index = 0;
    unsigned count = 0;
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

static bool copy_directory(const tiff_view *view, uint64_t directory, int depth, image_blob *exif);

/* Writes an entry into the block, whose numbers have the byte order of the file.  Types of BigTIFF are left out. */
static void put_entry(const tiff_view *view, const tiff_entry *entry, image_blob *exif, size_t at) {
    const tiff_view copy = {.bytes = exif->bytes, .size = exif->size, .big_endian = view->big_endian};
    tiff_put16(&copy, at, entry->tag);
    tiff_put16(&copy, at + 2, entry->type);
    tiff_put32(&copy, at + 4, (uint32_t)entry->count);
    if (entry->value_size <= 4)
        memcpy(exif->bytes + at + 8, view->bytes + entry->value, entry->value_size);
}

static void put_offset(const tiff_view *view, image_blob *exif, size_t at, size_t offset) {
    const tiff_view copy = {.bytes = exif->bytes, .size = exif->size, .big_endian = view->big_endian};
    tiff_put32(&copy, at + 8, (uint32_t)offset);
}

/* Copies an entry to the offset `at` of the block, and its value to the end of the block. */
static bool copy_entry(const tiff_view *view, const tiff_entry *entry, int depth, image_blob *exif, size_t at) {
    const size_t offset = exif->size;
    tiff_entry written = *entry;
    if (is_directory(entry->tag, depth)) {
        written.type = TIFF_LONG;
        put_entry(view, &written, exif, at);
        if (!copy_directory(view, tiff_number(view, entry), depth + 1, exif))
            return false;
    } else {
        put_entry(view, &written, exif, at);
        if (entry->value_size <= 4)
            return true;
        if (!image_blob_append(exif, view->bytes + entry->value, entry->value_size) ||
            !append_zeros(exif, entry->value_size % 2))
            return false;
    }
    put_offset(view, exif, at, offset);
    return true;
}

/* Appends a directory to the block. */
static bool copy_directory(const tiff_view *view, uint64_t directory, int depth, image_blob *exif) {
    const unsigned count = count_entries(view, directory, depth);
    size_t at = exif->size + 2;
    if (count == 0 || !append_zeros(exif, 2 + (size_t)count * TIFF_ENTRY_SIZE + 4))
        return false;
    const tiff_view copy = {.bytes = exif->bytes, .size = exif->size, .big_endian = view->big_endian};
    tiff_put16(&copy, at - 2, (uint16_t)count);
    size_t index = 0;
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
    const size_t count = tiff_entry_count(view, view->directory);
    for (size_t i = 0; i < count; i++) {
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

/* ---- Samples ----------------------------------------------------------------------------------- */

static bool refuse(char *message, const char *phrase) {
    snprintf(message, IMAGE_MESSAGE_SIZE, "%s", phrase);
    return false;
}

/* The raw formats of cameras derive from TIFF; their first directory often holds a preview. */
static bool is_raw(const tiff_view *view) {
    tiff_entry entry;
    const uint64_t photometric = find_number(view, TAG_PHOTOMETRIC, 0);
    const bool is_preview = find_number(view, TAG_SUBFILE_TYPE, 0) & SUBFILE_REDUCED;
    return (view->size >= 10 && memcmp(view->bytes + 8, "CR", 2) == 0) || photometric == PHOTOMETRIC_RAW ||
           photometric == PHOTOMETRIC_LINEAR_RAW || tiff_find(view, view->directory, TAG_DNG_VERSION, &entry) ||
           (is_preview && tiff_find(view, view->directory, TAG_SUBDIRECTORIES, &entry));
}

/* Whether OpenImageIO reads samples of such depth and kind. */
static bool check_samples(const tiff_view *view, char *message) {
    tiff_entry entry;
    const uint64_t format = find_number(view, TAG_SAMPLE_FORMAT, FORMAT_UNSIGNED);
    if (!tiff_find(view, view->directory, TAG_BITS, &entry))
        return refuse(message, "lacks the field BitsPerSample, which then is 1; write it into the file, for example by "
                               "'tiffset -s 258 1'");
    const uint64_t bits = tiff_number(view, &entry);
    const bool is_known = bits == 1 || bits == 16 || bits == 32 || (bits == 64 && format == FORMAT_FLOATING) ||
                          (bits <= 14 && bits % 2 == 0);
    if (is_known && format >= FORMAT_UNSIGNED && format <= FORMAT_FLOATING)
        return true;
    snprintf(message, IMAGE_MESSAGE_SIZE, "holds samples of %u bits and format %u; convert it to 8 or 16 bits first",
             (unsigned)(bits & 0xFFFF), (unsigned)(format & 0xFFFF));
    return false;
}

/* OpenImageIO inverts grey of 8 bits only, so the file is changed to black for zero and the samples are inverted later. */
static bool settle_white(const tiff_view *view, image_content *content, char *message) {
    tiff_entry entry;
    if (!tiff_find(view, view->directory, TAG_PHOTOMETRIC, &entry) || entry.type != TIFF_SHORT || entry.count == 0 ||
        tiff_number(view, &entry) != PHOTOMETRIC_WHITE_IS_ZERO)
        return true;
    if (find_number(view, TAG_SAMPLE_FORMAT, FORMAT_UNSIGNED) == FORMAT_SIGNED ||
        find_number(view, TAG_EXTRA_SAMPLES, 0) == EXTRA_ASSOCIATED_ALPHA)
        return refuse(message,
                      "holds grey whose zero is white, with negative samples or multiplied by alpha; convert it "
                      "to grey whose zero is black first");
    content->white_is_zero = true;
    tiff_put16(view, entry.value, PHOTOMETRIC_BLACK_IS_ZERO);
    return true;
}

/* Some programs store palettes of 8 bits; then no entry of the map exceeds 255. */
static void widen_palette(const tiff_view *view) {
    tiff_entry map;
    if (find_number(view, TAG_PHOTOMETRIC, 0) != PHOTOMETRIC_PALETTE ||
        !tiff_find(view, view->directory, TAG_COLOUR_MAP, &map) || map.type != TIFF_SHORT)
        return;
    for (size_t i = 0; i < map.count; i++) {
        if (tiff_number_at(view, &map, i) > 255)
            return;
    }
    for (size_t i = 0; i < map.count; i++)
        tiff_put16(view, map.value + 2 * i, (uint16_t)(257 * tiff_number_at(view, &map, i)));
}

bool image_prepare_tiff(uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]) {
    tiff_view view;
    tiff_entry extra;
    if (!tiff_open(&view, bytes, size))
        return true; /* the reader says what is wrong */
    if (is_raw(&view))
        return refuse(message, "is a raw file of a camera; develop it into a TIFF or PNG file first");
    if (!check_samples(&view, message) || !settle_white(&view, content, message))
        return false;
    const uint64_t orientation = find_number(&view, TAG_ORIENTATION, 1);
    content->orientation = orientation <= 8 ? (int)orientation : 1;
    content->cmyk = find_number(&view, TAG_PHOTOMETRIC, 0) == PHOTOMETRIC_INKS &&
                    find_number(&view, TAG_INK_SET, INK_SET_CMYK) == INK_SET_CMYK &&
                    find_number(&view, TAG_SAMPLES, 4) == 4;
    /* Readers agree that a fourth sample of which nothing is said is straight alpha. */
    content->alpha =
        tiff_find(&view, view.directory, TAG_EXTRA_SAMPLES, &extra) ? IMAGE_ALPHA_AS_READ : IMAGE_ALPHA_STRAIGHT;
    widen_palette(&view);
    take_profile(&view, content);
    take_xmp(&view, &content->metadata.xmp);
    take_exif(&view, &content->metadata.exif);
    hide_metadata(&view, content);
    return true;
}
