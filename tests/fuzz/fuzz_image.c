/* Reads hostile images as the tool does: pixels by libpng and libjpeg, and by the tool's own code chunks, segments, tags and
 * boxes, EXIF, XMP, profiles and orientation.  What is read must be an image within the limits with the metadata that was
 * asked for, and can be written in each format whose writer is the tool's own.
 *
 * The last byte of the input chooses what is kept.  What OpenImageIO reads is replaced by pixels of this file. */
#define _GNU_SOURCE /* memfd_create */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <gscl/gscl.h>

#include "cli/module.h"
#include "image/exif.h"
#include "image/image_alpha.h"
#include "image/image_file.h"
#include "image/image_format.h"
#include "image/image_jpeg.h"
#include "image/image_kind.h"
#include "image/image_module.h"
#include "image/image_output.h"
#include "image/image_png.h"
#include "image/image_tiff.h"
#include "mutator.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MAX_PIXELS (1u << 16) /* of a JPEG; larger ones take most of the time of fuzzing */

static void require(bool condition, const char *message) {
    if (!condition) {
        fprintf(stderr, "fuzz: %s\n", message);
        abort();
    }
}

/* ---- In place of the image module ---------------------------------------------------------------- */

static bool read_pixels(const char *plugin, const char *path, const uint8_t *bytes, size_t size, image_content *content,
                        char message[IMAGE_MESSAGE_SIZE]) {
    static const uint16_t samples[3 * 2 * 4] = {0, 1, 2, 65535, 60000, 3, 9, 30000};
    (void)path;
    require(plugin != NULL, "a format without a plug-in is read by one");
    if (size > 0 && bytes[size - 1] == 255) {
        snprintf(message, IMAGE_MESSAGE_SIZE, "is damaged");
        return false;
    }
    content->image =
        (gscl_image){.width = 3, .height = 2, .channels = content->cmyk ? 4 : 3, .sample = GSCL_SAMPLE_U16};
    content->image.pixels = malloc(sizeof samples);
    require(content->image.pixels != NULL, "no memory");
    memcpy(content->image.pixels, samples, sizeof samples);
    return true;
}

static bool read_jpeg2000(const uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]) {
    return read_pixels("jpeg2000", NULL, bytes, size, content, message);
}

const void *module_load(const char *file, const char *symbol) {
    static const image_module module = {.read = read_pixels, .read_jpeg2000 = read_jpeg2000};
    require(strcmp(file, IMAGE_MODULE_FILE) == 0 && strcmp(symbol, IMAGE_MODULE_SYMBOL) == 0,
            "another module is loaded");
    return &module;
}

const char *module_error(void) {
    return "none here";
}

/* ---- Checks ------------------------------------------------------------------------------------ */

static size_t sample_bytes(const gscl_image *image) {
    return image->sample == GSCL_SAMPLE_U8 ? 1 : image->sample == GSCL_SAMPLE_U16 ? 2 : sizeof(float);
}

/* Touches every pixel. */
static void check_pixels(const gscl_image *image) {
    const uint8_t *bytes = image->pixels;
    unsigned sum = 0;
    require(image->width >= 1 && image->width <= GSCL_MAX_DIMENSION && image->height >= 1 &&
                image->height <= GSCL_MAX_DIMENSION && image->channels >= 1 && image->channels <= 4,
            "an image is outside the limits");
    for (size_t i = 0; i < (size_t)image->width * image->height * image->channels * sample_bytes(image); i++)
        sum += bytes[i];
    require(sum < UINT_MAX, "a sum is too large");
}

static void check_blob(const image_blob *blob, bool kept) {
    unsigned sum = 0;
    require(kept || blob->size == 0, "metadata is kept that was not asked for");
    require(blob->size <= GSCL_MAX_BLOCK_SIZE, "a block of metadata is too long");
    for (size_t i = 0; i < blob->size; i++)
        sum += blob->bytes[i];
    require(sum < UINT_MAX, "a sum is too large");
}

static void check_metadata(const image_read_options *options, const image_metadata *metadata) {
    check_blob(&metadata->icc, options->keep_profile);
    check_blob(&metadata->exif, options->keep_exif);
    check_blob(&metadata->xmp, options->keep_xmp);
    require(options->keep_profile || !metadata->has_cicp, "colours are kept that were to be converted");
    require(metadata->exif.size == 0 || exif_is_valid(&metadata->exif), "EXIF is kept that cannot be read");
    require(exif_orientation(&metadata->exif) <= 1, "EXIF turns an image that is upright");
}

/* ---- Writing ----------------------------------------------------------------------------------- */

static bool write_as(const char *suffix, output_file *output, const gscl_image *image, const image_metadata *metadata,
                     char *message) {
    if (strcmp(suffix, ".png") == 0)
        return image_write_png(output, image, metadata, message);
    return strcmp(suffix, ".jpg") == 0 ? image_write_jpeg(output, image, metadata, message)
                                       : image_write_tiff(output, image, metadata, message);
}

static gscl_image copy_of(const gscl_image *image) {
    const size_t size = (size_t)image->width * image->height * image->channels * sample_bytes(image);
    gscl_image copy = *image;
    copy.pixels = malloc(size);
    require(copy.pixels != NULL, "no memory");
    memcpy(copy.pixels, image->pixels, size);
    return copy;
}

static image_metadata copy_of_metadata(const image_metadata *metadata) {
    image_metadata copy = *metadata;
    copy.icc = copy.exif = copy.xmp = (image_blob){0};
    require((metadata->icc.size == 0 || image_blob_set(&copy.icc, metadata->icc.bytes, metadata->icc.size)) &&
                (metadata->exif.size == 0 || image_blob_set(&copy.exif, metadata->exif.bytes, metadata->exif.size)) &&
                (metadata->xmp.size == 0 || image_blob_set(&copy.xmp, metadata->xmp.bytes, metadata->xmp.size)),
            "no memory");
    return copy;
}

/* Writes a copy into memory, over a background where the format holds no alpha.  A format may refuse an image, such as one
 * of 16 bits as JPEG. */
static void check_writing(const char *suffix, const gscl_image *image, const image_metadata *metadata) {
    char message[IMAGE_MESSAGE_SIZE] = "", name[16];
    char *bytes = NULL;
    size_t size = 0;
    snprintf(name, sizeof name, "out%s", suffix);
    const image_format *format = image_format_of("fuzz", name);
    const option_colour violet = {{0xEE, 0x82, 0xEE}}, *background = !format || format->alpha ? NULL : &violet;
    if (!format ||
        !image_format_holds(format, name, image_written_channels(image->channels, format, background), image->sample))
        return;
    const bool on_background = background && image->channels % 2 == 0;
    gscl_image pixels = copy_of(image), flat;
    image_metadata kept = copy_of_metadata(metadata);
    output_file output = {.label = name, .stream = open_memstream(&bytes, &size)};
    require(output.stream != NULL, "no memory");
    if (image_prepare_output(name, format, on_background, false, &pixels, &kept)) {
        require(image_flatten(name, format, background, &pixels, &flat), "no memory");
        require(write_as(suffix, &output, flat.pixels ? &flat : &pixels, &kept, message),
                "an image that was read cannot be written");
        free(flat.pixels);
    }
    fclose(output.stream);
    free(bytes);
    free(pixels.pixels);
    image_metadata_free(&kept);
}

/* ---- The target -------------------------------------------------------------------------------- */

/* A file in memory with this content.  Returns its name. */
static const char *store(const uint8_t *data, size_t size) {
    static char name[32];
    static int file;
    if (!name[0]) {
        file = memfd_create("image", MFD_CLOEXEC);
        snprintf(name, sizeof name, "/proc/self/fd/%d", file);
    }
    require(ftruncate(file, 0) == 0 && pwrite(file, data, size, 0) == (ssize_t)size, "no memory for a file");
    return name;
}

/* Whether some bytes look like the frame header of a JPEG with many pixels. */
static bool is_large_jpeg(const uint8_t *data, size_t size) {
    for (size_t i = 0; image_kind_of(data, size) == IMAGE_JPEG && i + 9 < size; i++) {
        const uint32_t height = (uint32_t)data[i + 5] << 8 | data[i + 6],
                       width = (uint32_t)data[i + 7] << 8 | data[i + 8];
        if (data[i] == 0xFF && data[i + 1] >= 0xC0 && data[i + 1] <= 0xCF && data[i + 1] != 0xC4 &&
            width * height > MAX_PIXELS)
            return true;
    }
    return false;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    gscl_image image;
    image_metadata metadata;
    const unsigned kept = size > 0 ? data[size - 1] : 0;
    const image_read_options options = {
        .keep_profile = kept & 1, .keep_exif = kept & 2, .keep_xmp = kept & 4, .quiet = kept & 8, .verbose = kept & 16};
    if (is_large_jpeg(data, size) || !image_read_with(store(data, size), &options, &image, &metadata))
        return 0;
    check_pixels(&image);
    check_metadata(&options, &metadata);
    if (kept & 32) {
        check_writing(".png", &image, &metadata);
        check_writing(".jpg", &image, &metadata);
        check_writing(".tif", &image, &metadata);
    }
    free(image.pixels);
    image_metadata_free(&metadata);
    return 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    return fuzz_mutate_image(data, size, max_size, seed);
}
