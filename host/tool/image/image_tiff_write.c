#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <zlib.h>

#include "image/image_tiff.h"
#include "image/tiff_tags.h"

#define HEADER_SIZE 8
#define STRIP_BYTES (256u << 10) /* about; a strip has whole rows */
#define LEVEL 1                  /* of zlib: fast, and on photographs hardly larger than slow ones */
#define MAX_FIELDS 40

enum {
    COMPRESSION_DEFLATE = 8,
    PREDICTOR_DIFFERENCES = 2,
    PHOTOMETRIC_GREY = 1,
    PHOTOMETRIC_RGB = 2,
    ALPHA_STRAIGHT = 2
};

/* A file in three parts: the head, which is a header or the block of EXIF (whose offsets then stay right), the strips of
 * pixels, and the tail with long values and the directory. */
typedef struct tiff_writer {
    const gscl_image *image;
    size_t row_bytes;
    uint32_t strip_rows, strips;
    uint8_t *pixels;                       /* all strips, compressed */
    uint32_t *strip_offsets, *strip_sizes; /* offsets in the file */
    image_blob head, tail;
    bool big_endian;
    size_t tail_at; /* offset in the file */
    uint8_t fields[MAX_FIELDS][TIFF_ENTRY_SIZE];
    unsigned field_count;
} tiff_writer;

static tiff_view view_of(const tiff_writer *writer, uint8_t *bytes) {
    return (tiff_view){.bytes = bytes, .big_endian = writer->big_endian};
}

/* ---- Pixels ------------------------------------------------------------------------------------ */

/* Copies a row with each sample replaced by its difference to that of the pixel before, in the order of the file. */
static void copy_differences(const tiff_writer *writer, uint32_t y, uint8_t *row) {
    const gscl_image *image = writer->image;
    const size_t samples = (size_t)image->width * image->channels;
    if (image->sample == GSCL_SAMPLE_U8) {
        const uint8_t *source = (const uint8_t *)image->pixels + y * samples;
        for (size_t i = 0; i < samples; i++)
            row[i] = (uint8_t)(source[i] - (i < image->channels ? 0 : source[i - image->channels]));
        return;
    }
    const uint16_t *source = (const uint16_t *)image->pixels + y * samples;
    const tiff_view view = view_of(writer, row);
    for (size_t i = 0; i < samples; i++)
        tiff_put16(&view, 2 * i, (uint16_t)(source[i] - (i < image->channels ? 0 : source[i - image->channels])));
}

/* Compresses a strip to `at`, which has room for it.  Returns its size, 0 without memory. */
static size_t pack_strip(const tiff_writer *writer, uint32_t strip, uint8_t *rows, uint8_t *at, size_t room) {
    const uint32_t first = strip * writer->strip_rows, left = writer->image->height - first;
    const uint32_t count = left < writer->strip_rows ? left : writer->strip_rows;
    for (uint32_t y = 0; y < count; y++)
        copy_differences(writer, first + y, rows + y * writer->row_bytes);
    uLongf size = (uLongf)room;
    return compress2(at, &size, rows, (uLong)(count * writer->row_bytes), LEVEL) == Z_OK ? size : 0;
}

/* Compresses all pixels.  Returns false without memory, or if the file would exceed the 4 GiB of its offsets. */
static bool pack_pixels(tiff_writer *writer) {
    const size_t strip_bytes = writer->strip_rows * writer->row_bytes, bound = compressBound((uLong)strip_bytes);
    uint8_t *rows = malloc(strip_bytes);
    writer->pixels = malloc(writer->strips * bound);
    writer->strip_offsets = malloc(writer->strips * sizeof *writer->strip_offsets);
    writer->strip_sizes = malloc(writer->strips * sizeof *writer->strip_sizes);
    bool ok = rows && writer->pixels && writer->strip_offsets && writer->strip_sizes;
    size_t used = 0;
    for (uint32_t strip = 0; ok && strip < writer->strips; strip++) {
        const size_t size = pack_strip(writer, strip, rows, writer->pixels + used, bound);
        ok = size > 0 && writer->head.size + used + size < UINT32_MAX - 2 * IMAGE_MAX_BLOB;
        writer->strip_offsets[strip] = (uint32_t)(writer->head.size + used);
        writer->strip_sizes[strip] = (uint32_t)size;
        used += size;
    }
    free(rows);
    writer->tail_at = writer->head.size + used;
    return ok;
}

/* ---- Directory --------------------------------------------------------------------------------- */

/* Appends to the tail, which begins its values at even offsets of the file. */
static bool append_tail(tiff_writer *writer, const void *bytes, size_t size) {
    static const uint8_t zero;
    return image_blob_append(&writer->tail, &zero, (writer->tail_at + writer->tail.size) % 2) &&
           image_blob_append(&writer->tail, bytes, size);
}

/* Adds a field whose value is in the order of the file. */
static bool add_bytes(tiff_writer *writer, uint16_t tag, uint16_t type, uint32_t count, const void *bytes,
                      size_t size) {
    uint8_t *field = writer->fields[writer->field_count++];
    const tiff_view view = view_of(writer, field);
    memset(field, 0, TIFF_ENTRY_SIZE);
    tiff_put16(&view, 0, tag);
    tiff_put16(&view, 2, type);
    tiff_put32(&view, 4, count);
    if (size <= 4) {
        memcpy(field + 8, bytes, size);
        return true;
    }
    const bool ok = append_tail(writer, bytes, size);
    tiff_put32(&view, 8, (uint32_t)(writer->tail_at + writer->tail.size - size));
    return ok;
}

static bool add_shorts(tiff_writer *writer, uint16_t tag, unsigned count, uint16_t value) {
    uint8_t bytes[8];
    const tiff_view view = view_of(writer, bytes);
    for (unsigned i = 0; i < count; i++)
        tiff_put16(&view, 2 * (size_t)i, value);
    return add_bytes(writer, tag, TIFF_SHORT, count, bytes, 2 * (size_t)count);
}

static bool add_longs(tiff_writer *writer, uint16_t tag, uint32_t count, const uint32_t *values) {
    uint8_t *bytes = malloc(4 * (size_t)count);
    const tiff_view view = view_of(writer, bytes);
    for (uint32_t i = 0; bytes && i < count; i++)
        tiff_put32(&view, 4 * (size_t)i, values[i]);
    const bool ok = bytes && add_bytes(writer, tag, TIFF_LONG, count, bytes, 4 * (size_t)count);
    free(bytes);
    return ok;
}

static bool add_block(tiff_writer *writer, uint16_t tag, uint16_t type, const image_blob *block) {
    return block->size == 0 || add_bytes(writer, tag, type, (uint32_t)block->size, block->bytes, block->size);
}

static bool add_image_fields(tiff_writer *writer) {
    const gscl_image *image = writer->image;
    const unsigned channels = image->channels;
    return add_longs(writer, TAG_WIDTH, 1, &image->width) && add_longs(writer, TAG_HEIGHT, 1, &image->height) &&
           add_shorts(writer, TAG_BITS, channels, image->sample == GSCL_SAMPLE_U16 ? 16 : 8) &&
           add_shorts(writer, TAG_COMPRESSION, 1, COMPRESSION_DEFLATE) &&
           add_shorts(writer, TAG_PHOTOMETRIC, 1, channels <= 2 ? PHOTOMETRIC_GREY : PHOTOMETRIC_RGB) &&
           add_longs(writer, TAG_STRIP_OFFSETS, writer->strips, writer->strip_offsets) &&
           add_shorts(writer, TAG_ORIENTATION, 1, 1) && add_shorts(writer, TAG_SAMPLES, 1, (uint16_t)channels) &&
           add_longs(writer, TAG_STRIP_ROWS, 1, &writer->strip_rows) &&
           add_longs(writer, TAG_STRIP_SIZES, writer->strips, writer->strip_sizes) &&
           add_shorts(writer, TAG_PREDICTOR, 1, PREDICTOR_DIFFERENCES) &&
           (channels % 2 == 1 || add_shorts(writer, TAG_EXTRA_SAMPLES, 1, ALPHA_STRAIGHT));
}

/* Adds the fields of the block of EXIF that describe the image.  Their values lie in the head. */
static void add_exif_fields(tiff_writer *writer) {
    tiff_view view;
    if (!tiff_open(&view, writer->head.bytes, writer->head.size))
        return;
    const unsigned count = tiff_entry_count(&view, view.directory);
    tiff_entry entry;
    int last_tag = -1;
    for (unsigned i = 0; i < count; i++) {
        if (!tiff_entry_read(&view, view.directory, i, &entry) || entry.tag <= last_tag ||
            !tiff_tag_describes_image(entry.tag))
            continue;
        last_tag = entry.tag;
        memcpy(writer->fields[writer->field_count++], view.bytes + entry.at, TIFF_ENTRY_SIZE);
    }
}

/* Sorts the fields by tag, as TIFF requires. */
static void sort_fields(tiff_writer *writer) {
    const tiff_view view = view_of(writer, writer->fields[0]);
    for (unsigned i = 1; i < writer->field_count; i++) {
        for (unsigned j = i; j > 0; j--) {
            uint8_t *b = writer->fields[j], *a = writer->fields[j - 1], swapped[TIFF_ENTRY_SIZE];
            if (tiff_get16(&view, (size_t)(a - view.bytes)) <= tiff_get16(&view, (size_t)(b - view.bytes)))
                break;
            memcpy(swapped, a, sizeof swapped);
            memcpy(a, b, sizeof swapped);
            memcpy(b, swapped, sizeof swapped);
        }
    }
}

/* Appends the directory to the tail, and points the head to it. */
static bool append_directory(tiff_writer *writer) {
    uint8_t count[2], none[4] = {0};
    tiff_view view = view_of(writer, count);
    tiff_put16(&view, 0, (uint16_t)writer->field_count);
    sort_fields(writer);
    if (!append_tail(writer, count, sizeof count))
        return false;
    view = view_of(writer, writer->head.bytes);
    tiff_put32(&view, 4, (uint32_t)(writer->tail_at + writer->tail.size - sizeof count));
    return image_blob_append(&writer->tail, writer->fields, writer->field_count * (size_t)TIFF_ENTRY_SIZE) &&
           image_blob_append(&writer->tail, none, sizeof none);
}

/* ---- The file ---------------------------------------------------------------------------------- */

static bool start_head(tiff_writer *writer, const image_metadata *metadata) {
    static const uint8_t header[HEADER_SIZE] = "II*\0";
    tiff_view exif;
    if (!metadata || !tiff_open(&exif, metadata->exif.bytes, metadata->exif.size))
        return image_blob_set(&writer->head, header, sizeof header);
    writer->big_endian = exif.big_endian;
    return image_blob_set(&writer->head, metadata->exif.bytes, metadata->exif.size);
}

static bool build(tiff_writer *writer, const image_metadata *metadata) {
    const gscl_image *image = writer->image;
    writer->row_bytes = (size_t)image->width * image->channels * (image->sample == GSCL_SAMPLE_U16 ? 2 : 1);
    writer->strip_rows = (uint32_t)(writer->row_bytes < STRIP_BYTES ? STRIP_BYTES / writer->row_bytes : 1);
    writer->strips = (image->height + writer->strip_rows - 1) / writer->strip_rows;
    if (!start_head(writer, metadata) || !pack_pixels(writer) || !add_image_fields(writer))
        return false;
    add_exif_fields(writer);
    return (!metadata || (add_block(writer, TAG_XMP, TIFF_BYTE, &metadata->xmp) &&
                          add_block(writer, TAG_ICC, TIFF_UNDEFINED, &metadata->icc))) &&
           append_directory(writer);
}

bool image_write_tiff(output_file *output, const gscl_image *image, const image_metadata *metadata,
                      char message[IMAGE_MESSAGE_SIZE]) {
    tiff_writer writer = {.image = image};
    bool ok = build(&writer, metadata);
    if (!ok)
        snprintf(message, IMAGE_MESSAGE_SIZE, "is too large for the available memory or for .tif");
    ok = ok && output_write(output, writer.head.bytes, writer.head.size) &&
         output_write(output, writer.pixels, writer.tail_at - writer.head.size) &&
         output_write(output, writer.tail.bytes, writer.tail.size);
    free(writer.pixels);
    free(writer.strip_offsets);
    free(writer.strip_sizes);
    image_blob_free(&writer.head);
    image_blob_free(&writer.tail);
    return ok;
}
