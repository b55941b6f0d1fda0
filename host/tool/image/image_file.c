#define _DEFAULT_SOURCE /* fileno */
#include "image/image_file.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "cli/message.h"
#include "cli/module.h"
#include "cli/read_file.h"
#include "image/exif.h"
#include "image/image_colours.h"
#include "image/image_heif.h"
#include "image/image_jpeg.h"
#include "image/image_module.h"
#include "image/image_png.h"
#include "image/image_pnm.h"
#include "image/image_tiff.h"
#include "image/image_webp.h"
#include "image/orientation.h"

#define SIGNATURE_BYTES 12

/* ---- Files ------------------------------------------------------------------------------------- */

/* The module, which is loaded on the first call.  NULL after reporting an error about `label`. */
static const image_module *load_module(const char *label) {
    const image_module *module = module_load(IMAGE_MODULE_FILE, IMAGE_MODULE_SYMBOL);
    if (!module)
        report_error(label, "needs the module gscl-imageio.so, which handles all formats but PNG and JPEG: %s",
                     dlerror());
    return module;
}

/* `bytes` may be NULL: then the module reads the file. */
static bool read_through_module(const char *label, const char *path, const uint8_t *bytes, size_t size,
                                image_content *content) {
    char message[IMAGE_MESSAGE_SIZE];
    const image_module *module = load_module(label);
    return module && (module->read(path, bytes, size, content, message) || report_error(label, "%s", message));
}

/* The module reads files of most formats only, so bytes from a pipe go through a temporary file without a name. */
static bool read_spooled(const char *label, const uint8_t *bytes, size_t size, image_content *content) {
    FILE *spool = tmpfile();
    if (!spool)
        return report_error(label, "cannot be stored in a temporary file: %s", strerror(errno));
    char path[32];
    snprintf(path, sizeof path, "/dev/fd/%d", fileno(spool));
    const bool stored = fwrite(bytes, 1, size, spool) == size && fflush(spool) == 0;
    const bool ok = stored ? read_through_module(label, path, NULL, 0, content)
                           : report_error(label, "cannot be stored in a temporary file: %s", strerror(errno));
    fclose(spool);
    return ok;
}

static bool is_regular_file(const char *name) {
    struct stat status;
    return stat(name, &status) == 0 && S_ISREG(status.st_mode);
}

/* Whether a file is TIFF and no format that derives from it. */
static bool is_plain_tiff(const char *name, const uint8_t *bytes, size_t size) {
    const char *suffix = name_suffix(name);
    return image_is_tiff(bytes, size) &&
           (strcasecmp(suffix, ".tif") == 0 || strcasecmp(suffix, ".tiff") == 0 || !image_tiff_is_raw(bytes, size));
}

/* Whether a file is read into memory: its format has a reader here, or its metadata has. */
static bool is_read_in_memory(const uint8_t *start, size_t count) {
    return count == 0 || image_is_png(start, count) || image_is_jpeg(start, count) || image_is_webp(start, count) ||
           image_is_tiff(start, count) || image_is_heif(start, count);
}

/* Refuses a gscl file in place of an image: OpenImageIO may have a plug-in that reads it, which depends on the machine. */
static bool is_no_gscl(const char *label, const uint8_t *start, size_t count) {
    static const uint8_t magic[] = {0xC7, 'g', 's', 'c'};
    return count < sizeof magic || memcmp(start, magic, sizeof magic) != 0 ||
           report_error(label, "is a gscl file, not an image; 'gscl decode' makes an image of it");
}

/* Decodes the bytes of the input `name`, which it may change. */
static bool read_bytes(const char *name, uint8_t *bytes, size_t size, image_content *content) {
    char message[IMAGE_MESSAGE_SIZE];
    const char *label = input_label(name);
    if (size == 0)
        return report_error(label, "is empty; an image is expected");
    if (!is_no_gscl(label, bytes, size))
        return false;
    if (image_is_png(bytes, size))
        return image_read_png(bytes, size, content, message) || report_error(label, "%s", message);
    if (image_is_jpeg(bytes, size))
        return image_read_jpeg(bytes, size, content, message) || report_error(label, "%s", message);
    if (image_is_webp(bytes, size)) {
        image_take_webp_metadata(bytes, size, content);
        return read_through_module(label, "image.webp", bytes, size, content);
    }
    if (is_plain_tiff(name, bytes, size)) {
        if (image_tiff_lacks_bits(bytes, size))
            return report_error(label, "lacks the field BitsPerSample, which then is 1; write it into the file, for "
                                       "example by 'tiffset -s 258 1'");
        image_take_tiff_metadata(bytes, size, content);
        return read_through_module(label, "image.tif", bytes, size, content);
    }
    const bool ok = is_regular_file(name) ? read_through_module(label, name, NULL, 0, content)
                                          : read_spooled(label, bytes, size, content);
    if (ok && image_is_heif(bytes, size))
        image_take_heif_metadata(bytes, size, content);
    return ok;
}

static bool read_in_memory(const char *name, image_content *content) {
    uint8_t *bytes;
    size_t size;
    if (!read_file(name, MAX_IMAGE_FILE, &bytes, &size))
        return false;
    const bool ok = read_bytes(name, bytes, size, content);
    free(bytes);
    return ok;
}

static bool read_content(const char *name, image_content *content) {
    uint8_t start[SIGNATURE_BYTES];
    size_t count;
    if (!is_regular_file(name)) /* a pipe can be read only once; reading reports a missing file */
        return read_in_memory(name, content);
    if (!read_file_start(name, start, sizeof start, &count) || !is_no_gscl(name, start, count))
        return false;
    return is_read_in_memory(start, count) ? read_in_memory(name, content)
                                           : read_through_module(name, name, NULL, 0, content);
}

/* ---- What else a file holds ------------------------------------------------------------------------ */

static bool turn_upright(const char *label, const image_read_options *options, image_content *content) {
    const int own = content->orientation, orientation = own ? own : exif_orientation(&content->metadata.exif);
    if (!orientation_apply(&content->image, orientation))
        return report_error(label, "is too large for the available memory");
    if (orientation > 1 && options->verbose)
        report_note("%s: turned upright (orientation %d)", label, orientation);
    exif_set_upright(&content->metadata.exif);
    xmp_set_upright(&content->metadata.xmp);
    return true;
}

/* Drops a block that is not kept, and says so. */
static void settle_block(const char *label, const image_read_options *options, const char *name, bool keep,
                         image_blob *block) {
    if (keep && block->size > GSCL_MAX_BLOCK_SIZE) {
        keep = false;
        if (!options->quiet)
            report_warning(label, "its %s of %zu bytes is dropped, because a block holds at most %d", name, block->size,
                           GSCL_MAX_BLOCK_SIZE);
    } else if (block->size && options->verbose)
        report_note("%s: %s of %zu bytes %s", label, name, block->size, keep ? "kept" : "dropped");
    if (!keep)
        image_blob_free(block);
}

static void drop_damaged_exif(const char *label, const image_read_options *options, image_blob *exif,
                              const char *instead) {
    image_blob_free(exif);
    if (!options->quiet)
        report_warning(label, "its EXIF is damaged; it is %s", instead);
}

static void settle_metadata(const char *label, const image_read_options *options, image_content *content) {
    image_metadata *metadata = &content->metadata;
    exif_drop_thumbnail(&metadata->exif);
    /* Where directories overlap, the changes have made something else of it. */
    if (metadata->exif.size && (!exif_is_valid(&metadata->exif) || exif_orientation(&metadata->exif) > 1))
        drop_damaged_exif(label, options, &metadata->exif, "dropped");
    settle_block(label, options, "EXIF", options->keep_exif, &metadata->exif);
    settle_block(label, options, "XMP", options->keep_xmp, &metadata->xmp);
    if (content->other_bytes && options->verbose)
        report_note("%s: other metadata of %zu bytes dropped", label, content->other_bytes);
}

/* Warns of what the pixels do not show of the file. */
static void warn_of_losses(const char *label, const image_content *content) {
    if (content->damage[0])
        report_warning(label, "is damaged, and so may be the image: %s", content->damage);
    if (content->has_more_images)
        report_warning(label, "holds more than one image; only the first is read");
    if (content->clamped)
        report_warning(label, "%llu samples lie outside 0..1 and are clamped; scale them first if they matter",
                       (unsigned long long)content->clamped);
}

static bool settle(const char *label, const image_read_options *options, image_content *content) {
    if (!options->quiet)
        warn_of_losses(label, content);
    if (content->metadata.exif.size && !exif_is_valid(&content->metadata.exif))
        drop_damaged_exif(label, options, &content->metadata.exif, "taken as upright");
    if (!turn_upright(label, options, content) || !image_settle_colours(label, options, content))
        return false;
    settle_metadata(label, options, content);
    return true;
}

bool image_read_with(const char *name, const image_read_options *options, gscl_image *image, image_metadata *metadata) {
    image_content content = {0};
    if (!read_content(name, &content) || !settle(input_label(name), options, &content)) {
        image_content_free(&content);
        return false;
    }
    *image = content.image;
    *metadata = content.metadata;
    return true;
}

bool image_read(const char *name, gscl_image *image) {
    const image_read_options options = {.keep_profile = false};
    image_metadata metadata;
    if (!image_read_with(name, &options, image, &metadata))
        return false;
    image_metadata_free(&metadata);
    return true;
}

/* ---- Writing ----------------------------------------------------------------------------------- */

static bool is_named(const output_file *output, const char *suffix) {
    return strcasecmp(name_suffix(output->label), suffix) == 0;
}

static bool is_png_output(const output_file *output) {
    return !output->target || is_named(output, ".png");
}

/* On failure sets either output->error or the message, or leaves it empty after reporting the error. */
static bool write_format(output_file *output, const gscl_image *image, const image_metadata *metadata, char *message) {
    if (is_png_output(output))
        return image_write_png(output, image, metadata, message);
    if (is_named(output, ".jpg") || is_named(output, ".jpeg"))
        return image_write_jpeg(output, image, metadata, message);
    if (is_named(output, ".tif") || is_named(output, ".tiff"))
        return image_write_tiff(output, image, metadata, message);
    if (image_is_pnm_name(output->label))
        return image_write_pnm(output, image);
    const image_module *module = load_module(output->label); /* reports its errors */
    *message = '\0';
    return module && module->write(output->stream, name_suffix(output->label), image, message);
}

bool image_write_with(output_file *output, const gscl_image *image, const image_metadata *metadata) {
    char message[IMAGE_MESSAGE_SIZE] = "";
    if (write_format(output, image, metadata, message) || output->error)
        return output_commit(output); /* also reports output->error */
    if (*message)
        report_error(output->label, "%s", message);
    output_discard(output);
    return false;
}

bool image_write(output_file *output, const gscl_image *image) {
    return image_write_with(output, image, NULL);
}
