#include "image/image_jpeg.h"

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>

#define QUALITY 95    /* of 100; high, because the decoded image should lose little more */
#define MAX_SCANS 500 /* a file with more takes minutes, and no encoder writes it */

#define EXIF_MARKER (JPEG_APP0 + 1)
#define XMP_MARKER (JPEG_APP0 + 1)
#define ICC_MARKER (JPEG_APP0 + 2)
#define IPTC_MARKER (JPEG_APP0 + 13)
#define MAX_SEGMENT 65533 /* bytes of a segment without marker and length */
#define MAX_ICC_PARTS 255
#define ICC_PREFIX 14 /* identifier, number of the part, number of parts */

/* Identifiers at the start of segments, with their zero bytes. */
static const char exif_identifier[6] = "Exif\0";
static const char xmp_identifier[29] = "http://ns.adobe.com/xap/1.0/";
static const char icc_identifier[12] = "ICC_PROFILE";

/* Second bytes of markers; the first is 0xFF (ITU-T T.81, table B.1). */
enum { STUFFING = 0x00, TEM = 0x01, RST0 = 0xD0, RST7 = 0xD7, SOI = 0xD8, EOI = 0xD9, FILL = 0xFF };

/* ---- Callbacks of libjpeg ------------------------------------------------------------------------ */

/* The error handler, extended by what the callbacks need. */
typedef struct jpeg_errors {
    struct jpeg_error_mgr base;
    jmp_buf escape;
    char *message;
    char *damage; /* receives the first warning about the data; NULL in writing */
} jpeg_errors;

static void fail(j_common_ptr jpeg, const char *text) {
    jpeg_errors *errors = (jpeg_errors *)jpeg->err;
    snprintf(errors->message, IMAGE_MESSAGE_SIZE, "%s", text);
    longjmp(errors->escape, 1);
}

static void on_error(j_common_ptr jpeg) {
    char reason[JMSG_LENGTH_MAX], text[JMSG_LENGTH_MAX + 32];
    jpeg->err->format_message(jpeg, reason);
    snprintf(text, sizeof text, "cannot be %s: %s", jpeg->is_decompressor ? "read" : "written", reason);
    fail(jpeg, text);
}

/* Levels from 0 on are notices, -1 is a fault of the data that libjpeg passes over. */
static void on_warning(j_common_ptr jpeg, int level) {
    jpeg_errors *errors = (jpeg_errors *)jpeg->err;
    char reason[JMSG_LENGTH_MAX];
    if (level >= 0 || !errors->damage || errors->damage[0])
        return;
    jpeg->err->format_message(jpeg, reason);
    snprintf(errors->damage, IMAGE_MESSAGE_SIZE, "%s", reason);
}

static void on_progress(j_common_ptr jpeg) {
    if (((j_decompress_ptr)jpeg)->input_scan_number > MAX_SCANS)
        fail(jpeg, "has more than 500 scans; it is damaged");
}

static struct jpeg_error_mgr *set_errors(jpeg_errors *errors, char *message) {
    struct jpeg_error_mgr *base = jpeg_std_error(&errors->base);
    base->error_exit = on_error;
    base->emit_message = on_warning;
    errors->message = message;
    errors->damage = NULL;
    snprintf(message, IMAGE_MESSAGE_SIZE, "is too large for the available memory");
    return base;
}

/* ---- Completeness ------------------------------------------------------------------------------ */

/* Offset of the second byte of the next marker, or `size`.  Restart markers and stuffed bytes belong to the scan. */
static size_t find_marker(const uint8_t *bytes, size_t size, size_t at) {
    while (at + 1 < size) {
        const uint8_t code = bytes[at + 1];
        if (bytes[at] == 0xFF && code != STUFFING && code != FILL && !(code >= RST0 && code <= RST7))
            return at + 1;
        at++;
    }
    return size;
}

/* Whether the file has its end-of-image marker.  libjpeg fills missing parts with grey and reports no error. */
static bool is_complete(const uint8_t *bytes, size_t size) {
    size_t at = find_marker(bytes, size, 2);
    while (at < size && bytes[at] != EOI) {
        at++;
        if (bytes[at - 1] != TEM) { /* a segment with its length, which counts itself */
            if (size - at < 2)
                return false;
            const size_t length = (size_t)bytes[at] << 8 | bytes[at + 1];
            at = length < size - at ? at + length : size;
        }
        at = find_marker(bytes, size, at);
    }
    return at < size;
}

/* ---- Metadata ---------------------------------------------------------------------------------- */

static bool starts_with(jpeg_saved_marker_ptr marker, const char *identifier, size_t size) {
    return marker->data_length >= size && memcmp(marker->data, identifier, size) == 0;
}

/* Joins the parts of a profile, which may come in any order.  Returns false when some are missing or double. */
static bool join_icc(jpeg_saved_marker_ptr list, image_blob *icc) {
    jpeg_saved_marker_ptr parts[MAX_ICC_PARTS + 1] = {NULL};
    unsigned count = 0;
    for (jpeg_saved_marker_ptr marker = list; marker; marker = marker->next) {
        if (marker->marker != ICC_MARKER || !starts_with(marker, icc_identifier, sizeof icc_identifier))
            continue;
        if (marker->data_length < ICC_PREFIX)
            return false;
        const unsigned part = marker->data[12];
        if (part == 0 || part > marker->data[13] || parts[part] || (count && marker->data[13] != count))
            return false;
        count = marker->data[13];
        parts[part] = marker;
    }
    for (unsigned part = 1; part <= count; part++) {
        if (!parts[part] ||
            !image_blob_append(icc, parts[part]->data + ICC_PREFIX, parts[part]->data_length - ICC_PREFIX))
            return false;
    }
    return count == 0 || icc->size > 0;
}

static void take_metadata(jpeg_saved_marker_ptr list, image_content *content) {
    image_metadata *metadata = &content->metadata;
    for (jpeg_saved_marker_ptr marker = list; marker; marker = marker->next) {
        const size_t size = marker->data_length;
        if (marker->marker == EXIF_MARKER && starts_with(marker, exif_identifier, sizeof exif_identifier)) {
            if (!metadata->exif.size)
                image_blob_set(&metadata->exif, marker->data + sizeof exif_identifier, size - sizeof exif_identifier);
        } else if (marker->marker == XMP_MARKER && starts_with(marker, xmp_identifier, sizeof xmp_identifier)) {
            if (!metadata->xmp.size)
                image_blob_set(&metadata->xmp, marker->data + sizeof xmp_identifier, size - sizeof xmp_identifier);
        } else if (marker->marker != ICC_MARKER || !starts_with(marker, icc_identifier, sizeof icc_identifier)) {
            content->other_bytes += size;
        }
    }
    content->damaged_profile = !join_icc(list, &metadata->icc);
    if (content->damaged_profile)
        image_blob_free(&metadata->icc);
}

/* ---- Reading ----------------------------------------------------------------------------------- */

/* Reads and checks everything before the pixels. */
static void read_header(j_decompress_ptr jpeg, image_content *content) {
    char text[IMAGE_MESSAGE_SIZE];
    const int markers[] = {EXIF_MARKER, ICC_MARKER, IPTC_MARKER, JPEG_COM};
    for (size_t i = 0; i < sizeof markers / sizeof *markers; i++)
        jpeg_save_markers(jpeg, markers[i], 0xFFFF);
    jpeg_read_header(jpeg, TRUE);
    if (jpeg->image_width > GSCL_MAX_DIMENSION || jpeg->image_height > GSCL_MAX_DIMENSION) {
        snprintf(text, sizeof text, IMAGE_SIZE_MESSAGE, (unsigned)jpeg->image_width, (unsigned)jpeg->image_height);
        fail((j_common_ptr)jpeg, text);
    }
    if (jpeg->num_components != 1 && jpeg->num_components != 3 && jpeg->num_components != 4) {
        snprintf(text, sizeof text, "has %d channels; grey, RGB or CMYK is needed", jpeg->num_components);
        fail((j_common_ptr)jpeg, text);
    }
    take_metadata(jpeg->marker_list, content);
}

static void start_pixels(j_decompress_ptr jpeg, image_content *content) {
    const int channels = jpeg->num_components;
    jpeg->out_color_space = channels == 1 ? JCS_GRAYSCALE : channels == 3 ? JCS_RGB : JCS_CMYK;
    jpeg_start_decompress(jpeg);
    content->cmyk = channels == 4;
    content->image = (gscl_image){
        .width = jpeg->output_width,
        .height = jpeg->output_height,
        .channels = (uint32_t)channels,
        .sample = GSCL_SAMPLE_U8,
    };
    content->image.pixels = calloc((size_t)jpeg->output_width * jpeg->output_height, (size_t)channels);
    if (!content->image.pixels)
        fail((j_common_ptr)jpeg, "is too large for the available memory");
}

/* Files that have the marker of Adobe store inks inverted: 255 for none. */
static void invert(const gscl_image *image) {
    uint8_t *samples = image->pixels;
    for (size_t i = 0; i < (size_t)image->width * image->height * image->channels; i++)
        samples[i] = (uint8_t)(255 - samples[i]);
}

/* Returns false after an error of libjpeg (a longjmp). */
static bool read_image(j_decompress_ptr jpeg, const uint8_t *bytes, size_t size, image_content *content) {
    if (setjmp(((jpeg_errors *)jpeg->err)->escape))
        return false;
    jpeg_create_decompress(jpeg);
    struct jpeg_progress_mgr progress = {.progress_monitor = on_progress};
    jpeg->progress = &progress;
    jpeg_mem_src(jpeg, bytes, (unsigned long)size);
    read_header(jpeg, content);
    start_pixels(jpeg, content);
    const size_t row_bytes = (size_t)content->image.width * content->image.channels;
    while (jpeg->output_scanline < jpeg->output_height) {
        JSAMPROW row = (JSAMPROW)content->image.pixels + jpeg->output_scanline * row_bytes;
        jpeg_read_scanlines(jpeg, &row, 1);
    }
    jpeg_finish_decompress(jpeg);
    if (content->cmyk && jpeg->saw_Adobe_marker)
        invert(&content->image);
    return true;
}

bool image_read_jpeg(const uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]) {
    struct jpeg_decompress_struct jpeg = {0};
    jpeg_errors errors;
    jpeg.err = set_errors(&errors, message);
    errors.damage = content->damage;
    if (!is_complete(bytes, size)) {
        snprintf(message, IMAGE_MESSAGE_SIZE, "ends too early; the file is truncated");
        return false;
    }
    const bool ok = read_image(&jpeg, bytes, size, content);
    jpeg_destroy_decompress(&jpeg);
    return ok;
}

/* ---- Writing ----------------------------------------------------------------------------------- */

/* Writes a segment of an identifier and bytes. */
static void write_segment(j_compress_ptr jpeg, int marker, const void *identifier, size_t identifier_size,
                          const uint8_t *bytes, size_t size) {
    uint8_t segment[MAX_SEGMENT];
    memcpy(segment, identifier, identifier_size);
    memcpy(segment + identifier_size, bytes, size);
    jpeg_write_marker(jpeg, marker, segment, (unsigned)(identifier_size + size));
}

static void write_icc(j_compress_ptr jpeg, const image_blob *icc) {
    const size_t part_size = MAX_SEGMENT - ICC_PREFIX;
    const size_t parts = (icc->size + part_size - 1) / part_size;
    for (size_t part = 0; part < parts; part++) {
        uint8_t prefix[ICC_PREFIX];
        const size_t left = icc->size - part * part_size;
        memcpy(prefix, icc_identifier, sizeof icc_identifier);
        prefix[12] = (uint8_t)(part + 1);
        prefix[13] = (uint8_t)parts;
        write_segment(jpeg, ICC_MARKER, prefix, sizeof prefix, icc->bytes + part * part_size,
                      left < part_size ? left : part_size);
    }
}

static void write_metadata(j_compress_ptr jpeg, const image_metadata *metadata) {
    if (metadata->exif.size)
        write_segment(jpeg, EXIF_MARKER, exif_identifier, sizeof exif_identifier, metadata->exif.bytes,
                      metadata->exif.size);
    if (metadata->xmp.size)
        write_segment(jpeg, XMP_MARKER, xmp_identifier, sizeof xmp_identifier, metadata->xmp.bytes, metadata->xmp.size);
    write_icc(jpeg, &metadata->icc);
}

/* Returns false after an error of libjpeg (a longjmp). */
static bool write_image(j_compress_ptr jpeg, const gscl_image *image, const image_metadata *metadata,
                        unsigned char **bytes, unsigned long *size) {
    if (setjmp(((jpeg_errors *)jpeg->err)->escape))
        return false;
    jpeg_create_compress(jpeg);
    jpeg_mem_dest(jpeg, bytes, size);
    jpeg->image_width = image->width;
    jpeg->image_height = image->height;
    jpeg->input_components = (int)image->channels;
    jpeg->in_color_space = image->channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(jpeg);
    jpeg_set_quality(jpeg, QUALITY, TRUE);
    jpeg_start_compress(jpeg, TRUE);
    if (metadata)
        write_metadata(jpeg, metadata);
    const size_t row_bytes = (size_t)image->width * image->channels;
    while (jpeg->next_scanline < jpeg->image_height) {
        JSAMPROW row = (JSAMPROW)image->pixels + jpeg->next_scanline * row_bytes;
        jpeg_write_scanlines(jpeg, &row, 1);
    }
    jpeg_finish_compress(jpeg);
    return true;
}

bool image_write_jpeg(output_file *output, const gscl_image *image, const image_metadata *metadata,
                      char message[IMAGE_MESSAGE_SIZE]) {
    struct jpeg_compress_struct jpeg = {0};
    jpeg_errors errors;
    unsigned char *bytes = NULL;
    unsigned long size = 0;
    jpeg.err = set_errors(&errors, message);
    const bool ok = write_image(&jpeg, image, metadata, &bytes, &size) && output_write(output, bytes, size);
    jpeg_destroy_compress(&jpeg);
    free(bytes);
    return ok;
}
