#include "image/image_png.h"

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <png.h>
#include <zlib.h>

#include "image/png_chunks.h"

/* Upper bound of the compression ratio of deflate.  A file that declares more pixels is truncated or damaged. */
#define MAX_DEFLATE_RATIO 1032
#define MAX_CHUNK_BYTES ((png_alloc_size_t)16 << 20) /* of other chunks: text, profiles */

/* On photographs, the fastest setting whose files are not much larger than those of slow settings. */
#define WRITE_LEVEL 1
#define WRITE_FILTER PNG_FILTER_AVG

#define TRUNCATED "ends too early; the file is truncated"

typedef struct png_source {
    const uint8_t *bytes;
    size_t size, position;
} png_source;

/* ---- Callbacks of libpng ------------------------------------------------------------------------- */

static void on_error(png_structp png, png_const_charp text) {
    snprintf(png_get_error_ptr(png), IMAGE_MESSAGE_SIZE, "%s", text);
    longjmp(png_jmpbuf(png), 1);
}

static void on_warning(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

static void on_read(png_structp png, png_bytep bytes, size_t count) {
    png_source *source = png_get_io_ptr(png);
    if (count > source->size - source->position)
        png_error(png, TRUNCATED);
    memcpy(bytes, source->bytes + source->position, count);
    source->position += count;
}

static void on_write(png_structp png, png_bytep bytes, size_t count) {
    if (!output_write(png_get_io_ptr(png), bytes, count))
        png_error(png, "cannot be written");
}

static void on_flush(png_structp png) {
    (void)png; /* output_commit flushes */
}

/* ---- Reading ----------------------------------------------------------------------------------- */

static gscl_sample png_sample(png_structp png, png_infop info) {
    return png_get_bit_depth(png, info) == 16 ? GSCL_SAMPLE_U16 : GSCL_SAMPLE_U8;
}

static void swap_if_little_endian(png_structp png) {
    const uint16_t one = 1;
    if (*(const uint8_t *)&one == 1)
        png_set_swap(png);
}

/* Reads and checks everything before the pixels. */
static void read_header(png_structp png, png_infop info, const png_source *source) {
    char text[IMAGE_MESSAGE_SIZE];
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); /* the check below has the better message */
    png_set_chunk_malloc_max(png, MAX_CHUNK_BYTES);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, png_metadata_chunks, PNG_METADATA_CHUNK_COUNT);
    png_read_info(png, info);
    const png_uint_32 width = png_get_image_width(png, info), height = png_get_image_height(png, info);
    if (width > GSCL_MAX_DIMENSION || height > GSCL_MAX_DIMENSION) {
        snprintf(text, sizeof text, IMAGE_SIZE_MESSAGE, (unsigned)width, (unsigned)height);
        png_error(png, text);
    }
    if ((uint64_t)png_get_rowbytes(png, info) * height > (uint64_t)source->size * MAX_DEFLATE_RATIO)
        png_error(png, "is too short for its size in pixels; the file is truncated");
}

/* Sets libpng to convert to grey or RGB, with or without alpha, of 8 bits or native 16. */
static void expand_pixels(png_structp png, png_infop info) {
    png_set_expand(png);
    swap_if_little_endian(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
}

static void allocate_pixels(png_structp png, png_infop info, gscl_image *image) {
    *image = (gscl_image){
        .width = png_get_image_width(png, info),
        .height = png_get_image_height(png, info),
        .channels = png_get_channels(png, info),
        .sample = png_sample(png, info),
    };
    image->pixels = malloc(png_get_rowbytes(png, info) * image->height);
    if (!image->pixels)
        png_error(png, "is too large for the available memory");
}

/* Interlaced passes visit all rows again, and each fills in more pixels. */
static void read_rows(png_structp png, png_infop info, const gscl_image *image) {
    const size_t row_bytes = png_get_rowbytes(png, info);
    const int passes = png_get_interlace_type(png, info) == PNG_INTERLACE_NONE ? 1 : PNG_INTERLACE_ADAM7_PASSES;
    for (int pass = 0; pass < passes; pass++) {
        for (uint32_t y = 0; y < image->height; y++)
            png_read_row(png, (png_bytep)image->pixels + y * row_bytes, NULL);
    }
    png_read_end(png, NULL); /* detects a truncated file and a wrong checksum */
}

/* Returns false after an error of libpng (a longjmp). */
static bool read_image(png_structp png, png_infop info, png_source *source, gscl_image *image) {
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_set_read_fn(png, source, on_read);
    read_header(png, info, source);
    expand_pixels(png, info);
    allocate_pixels(png, info, image);
    read_rows(png, info, image);
    return true;
}

bool image_read_png(const uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]) {
    png_source source = {bytes, size, 0};
    if (!png_chunks_fit(bytes, size)) { /* libpng would first allocate what a chunk claims to hold */
        snprintf(message, IMAGE_MESSAGE_SIZE, TRUNCATED);
        return false;
    }
    snprintf(message, IMAGE_MESSAGE_SIZE, "is too large for the available memory");
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, message, on_error, on_warning);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    const bool ok = info && read_image(png, info, &source, &content->image);
    png_destroy_read_struct(&png, &info, NULL);
    if (ok)
        png_take_metadata(bytes, size, content);
    return ok;
}

/* ---- Writing ----------------------------------------------------------------------------------- */

static int png_colour_type(uint32_t channels) {
    static const int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                PNG_COLOR_TYPE_RGB_ALPHA};
    return types[channels - 1];
}

/* Name, zero, method of compression, zlib stream. */
static void write_icc(png_structp png, const image_blob *icc) {
    static const uint8_t head[] = "ICC profile\0";
    image_blob chunk = {0};
    uLongf packed_size = compressBound((uLong)icc->size);
    uint8_t *packed = malloc(packed_size);
    const bool ok = packed && compress2(packed, &packed_size, icc->bytes, (uLong)icc->size, 9) == Z_OK &&
                    image_blob_append(&chunk, head, sizeof head) && image_blob_append(&chunk, packed, packed_size);
    free(packed);
    if (ok)
        png_write_chunk(png, (png_const_bytep) "iCCP", chunk.bytes, chunk.size);
    image_blob_free(&chunk);
    if (!ok)
        png_error(png, "is too large for the available memory");
}

/* Keyword, zero, not compressed, method, no language, zero, no translated keyword, zero, text. */
static void write_xmp(png_structp png, const image_blob *xmp) {
    static const uint8_t head[] = "XML:com.adobe.xmp\0\0\0\0";
    png_write_chunk_start(png, (png_const_bytep) "iTXt", (png_uint_32)(sizeof head + xmp->size));
    png_write_chunk_data(png, head, sizeof head);
    png_write_chunk_data(png, xmp->bytes, xmp->size);
    png_write_chunk_end(png);
}

/* Writes the chunks of metadata, which stand before the pixels. */
static void write_metadata(png_structp png, const image_metadata *metadata) {
    if (metadata->has_cicp) {
        const uint8_t chunk[4] = {metadata->cicp[0], metadata->cicp[1], 0 /* RGB */, 1 /* full range */};
        png_write_chunk(png, (png_const_bytep) "cICP", chunk, sizeof chunk);
    }
    if (metadata->icc.size)
        write_icc(png, &metadata->icc);
    if (metadata->exif.size)
        png_write_chunk(png, (png_const_bytep) "eXIf", metadata->exif.bytes, metadata->exif.size);
    if (metadata->xmp.size)
        write_xmp(png, &metadata->xmp);
}

static bool write_image(png_structp png, png_infop info, output_file *output, const gscl_image *image,
                        const image_metadata *metadata) {
    const int bytes_per_sample = image->sample == GSCL_SAMPLE_U16 ? 2 : 1;
    const size_t row_bytes = (size_t)image->width * image->channels * (size_t)bytes_per_sample;
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_set_write_fn(png, output, on_write, on_flush);
    png_set_compression_level(png, WRITE_LEVEL);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, WRITE_FILTER);
    png_set_IHDR(png, info, image->width, image->height, 8 * bytes_per_sample, png_colour_type(image->channels),
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    if (metadata)
        write_metadata(png, metadata);
    if (bytes_per_sample == 2)
        swap_if_little_endian(png);
    for (uint32_t y = 0; y < image->height; y++)
        png_write_row(png, (png_const_bytep)image->pixels + y * row_bytes);
    png_write_end(png, NULL);
    return true;
}

bool image_write_png(output_file *output, const gscl_image *image, const image_metadata *metadata,
                     char message[IMAGE_MESSAGE_SIZE]) {
    snprintf(message, IMAGE_MESSAGE_SIZE, "is too large for the available memory");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, message, on_error, on_warning);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    const bool ok = info && write_image(png, info, output, image, metadata);
    png_destroy_write_struct(&png, &info);
    return ok;
}
