#define _DEFAULT_SOURCE /* fileno */
#include "image/image_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cli/message.h"
#include "cli/module.h"
#include "cli/read_file.h"
#include "host/system/files.h"
#include "image/exif.h"
#include "image/image_colours.h"
#include "image/image_format.h"
#include "image/image_heif.h"
#include "image/image_ico.h"
#include "image/image_jpeg.h"
#include "image/image_kind.h"
#include "image/image_module.h"
#include "image/image_png.h"
#include "image/image_pnm.h"
#include "image/image_samples.h"
#include "image/image_tiff.h"
#include "image/image_variant.h"
#include "image/image_webp.h"
#include "image/orientation.h"

/* ---- Files ------------------------------------------------------------------------------------- */

/* The module, which is loaded on the first call.  NULL after reporting an error about `label`. */
#ifdef GSCL_WITH_IMAGE_MODULE
static const image_module *load_module(const char *label) {
    const image_module *module = module_load(IMAGE_MODULE_FILE, IMAGE_MODULE_SYMBOL);
    if (!module)
        report_error(label, "needs the module gscl-imageio.so, which handles all formats but PNG and JPEG: %s",
                     module_error());
    return module;
}
#else
static const image_module *load_module(const char *label) {
    report_error(label, "is of a format that this gscl was built without; it reads PNG and JPEG, and writes PNM and "
                        "TIFF, too");
    return NULL;
}
#endif

/* An input whose bytes are in memory. */
typedef struct source {
    const char *name, *label;
    uint8_t *bytes; /* which a reader may change */
    size_t size;
    image_kind kind;
} source;

static bool read_with_plugin(const source *s, const char *path, const uint8_t *bytes, size_t size,
                             image_content *content) {
    char message[IMAGE_MESSAGE_SIZE];
    const image_module *module = load_module(s->label);
    const char *plugin = image_kind_plugin(s->kind == IMAGE_ICO ? IMAGE_BMP : s->kind);
    return module &&
           (module->read(plugin, path, bytes, size, content, message) || report_error(s->label, "%s", message));
}

static bool read_from_memory(const source *s, image_content *content) {
    return read_with_plugin(s, "image", s->bytes, s->size, content);
}

static bool is_regular_file(const char *name) {
    system_status status;
    return system_status_of(name, &status) && status.is_regular;
}

/* For plug-ins that read no bytes.  Those of a pipe go through a temporary file without a name. */
static bool read_from_path(const source *s, image_content *content) {
    if (is_regular_file(s->name))
        return read_with_plugin(s, s->name, NULL, 0, content);
    FILE *spool = tmpfile();
    if (!spool)
        return report_error(s->label, "cannot be stored in a temporary file: %s", system_error_text(errno));
    char path[32];
    snprintf(path, sizeof path, "/dev/fd/%d", fileno(spool));
    const bool stored = fwrite(s->bytes, 1, s->size, spool) == s->size && fflush(spool) == 0;
    const bool ok = stored
                        ? read_with_plugin(s, path, NULL, 0, content)
                        : report_error(s->label, "cannot be stored in a temporary file: %s", system_error_text(errno));
    fclose(spool);
    return ok;
}

/* ---- Formats ------------------------------------------------------------------------------------ */

static bool read_heif(const source *s, image_content *content) {
    if (!read_from_path(s, content))
        return false;
    image_take_heif_metadata(s->bytes, s->size, content);
    return true;
}

static bool read_tiff(const source *s, image_content *content) {
    char message[IMAGE_MESSAGE_SIZE];
    if (!image_prepare_tiff(s->bytes, s->size, content, message))
        return report_error(s->label, "%s", message);
    return read_from_memory(s, content);
}

static bool read_jpeg2000(const source *s, image_content *content) {
    char message[IMAGE_MESSAGE_SIZE];
    const image_module *module = load_module(s->label);
    return module &&
           (module->read_jpeg2000(s->bytes, s->size, content, message) || report_error(s->label, "%s", message));
}

static bool read_bitmap_of_ico(const source *s, const ico_image *icon, image_content *content) {
    content->alpha = IMAGE_ALPHA_STRAIGHT;
    return read_with_plugin(s, "image", icon->bytes, icon->size, content) &&
           (ico_apply_mask(icon, &content->image) || report_error(s->label, "cannot be read: its bitmap is damaged"));
}

static bool read_ico(const source *s, image_content *content) {
    char message[IMAGE_MESSAGE_SIZE];
    ico_image icon;
    if (!ico_find_image(s->bytes, s->size, &icon, message))
        return report_error(s->label, "%s", message);
    const bool ok =
        icon.is_png ? image_read_png(icon.bytes, icon.size, content, message) || report_error(s->label, "%s", message)
                    : read_bitmap_of_ico(s, &icon, content);
    free(icon.bytes);
    return ok;
}

/* Refuses what is no image of a known format, a gscl file above all. */
static bool refuse_unknown(const source *s) {
    static const uint8_t magic[] = {0xC7, 'g', 's', 'c'};
    const char *foreign = image_foreign_name(s->bytes, s->size);
    if (s->size >= sizeof magic && memcmp(s->bytes, magic, sizeof magic) == 0)
        return report_error(s->label, "is a gscl file, not an image; 'gscl decode' makes an image of it");
    if (foreign)
        return report_error(s->label, "is a %s file, which is not read; convert it to PNG first", foreign);
    return report_error(s->label, "is not an image that can be read; %s can be", IMAGE_KIND_NAMES);
}

static bool read_kind(const source *s, image_content *content) {
    char message[IMAGE_MESSAGE_SIZE];
    switch (s->kind) {
    case IMAGE_UNKNOWN:
        return refuse_unknown(s);
    case IMAGE_PNG:
        return image_read_png(s->bytes, s->size, content, message) || report_error(s->label, "%s", message);
    case IMAGE_JPEG:
        return image_read_jpeg(s->bytes, s->size, content, message) || report_error(s->label, "%s", message);
    case IMAGE_JPEG2000:
        return read_jpeg2000(s, content);
    case IMAGE_ICO:
        return read_ico(s, content);
    case IMAGE_TIFF:
        return read_tiff(s, content);
    case IMAGE_HEIF:
        return read_heif(s, content);
    case IMAGE_SGI:
        return read_from_path(s, content);
    case IMAGE_WEBP:
        image_take_webp_metadata(s->bytes, s->size, content);
        return read_from_memory(s, content);
    default:
        return read_from_memory(s, content);
    }
}

/* Makes of the samples what the header of the file says. */
static void settle_samples(image_content *content) {
    gscl_image *image = &content->image;
    if (content->white_is_zero)
        image_invert_colours(image);
    if (content->alpha == IMAGE_ALPHA_UNUSED_IF_CLEAR && image->channels % 2 == 0 && image_alpha_is_clear(image))
        image_drop_alpha(image);
}

static bool read_content(const char *name, image_content *content) {
    char message[IMAGE_MESSAGE_SIZE];
    source s = {.name = name, .label = input_label(name)};
    if (!read_file(name, MAX_IMAGE_FILE, &s.bytes, &s.size))
        return false;
    s.kind = image_kind_of(s.bytes, s.size);
    bool ok = s.size > 0 || report_error(s.label, "is empty; an image is expected");
    if (ok)
        ok = image_check_variant(s.kind, s.bytes, s.size, content, message) || report_error(s.label, "%s", message);
    ok = ok && read_kind(&s, content);
    free(s.bytes);
    if (ok)
        settle_samples(content);
    return ok;
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

/* The suffix that names the format. */
static const char *suffix_of(const output_file *output) {
    const char *suffix = name_suffix(output->label);
    return *suffix ? suffix : IMAGE_PIPE_SUFFIX;
}

/* Appends what a file holds to the output. */
static bool copy_spool(FILE *spool, output_file *output) {
    uint8_t bytes[16384];
    size_t count = 0;
    rewind(spool);
    while ((count = fread(bytes, 1, sizeof bytes, spool)) > 0 && output_write(output, bytes, count))
        continue;
    if (ferror(spool) && !output->error)
        output->error = errno ? errno : EIO;
    return !output->error;
}

/* The module writes files of some formats out of order, which what is written in place may not allow. */
static bool write_spooled(const image_module *module, output_file *output, const gscl_image *image, char *message) {
    FILE *spool = tmpfile();
    if (!spool) {
        snprintf(message, IMAGE_MESSAGE_SIZE, "cannot be stored in a temporary file: %s", system_error_text(errno));
        return false;
    }
    const bool ok = module->write(spool, suffix_of(output), image, message) && copy_spool(spool, output);
    fclose(spool);
    return ok;
}

static bool write_through_module(output_file *output, const gscl_image *image, char *message) {
    const image_module *module = load_module(output->label); /* reports its errors */
    *message = '\0';
    if (!module)
        return false;
    return output->temporary ? module->write(output->stream, suffix_of(output), image, message)
                             : write_spooled(module, output, image, message);
}

/* On failure sets either output->error or the message, or leaves it empty after reporting the error. */
static bool write_format(output_file *output, const gscl_image *image, const image_metadata *metadata, char *message) {
    const char *suffix = suffix_of(output);
    if (strcasecmp(suffix, ".png") == 0)
        return image_write_png(output, image, metadata, message);
    if (strcasecmp(suffix, ".jpg") == 0 || strcasecmp(suffix, ".jpeg") == 0)
        return image_write_jpeg(output, image, metadata, message);
    if (strcasecmp(suffix, ".tif") == 0 || strcasecmp(suffix, ".tiff") == 0)
        return image_write_tiff(output, image, metadata, message);
    if (image_is_pnm_name(output->label))
        return image_write_pnm(output, image);
    return write_through_module(output, image, message);
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
