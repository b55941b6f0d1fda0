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
#include "image/image_jpeg.h"
#include "image/image_module.h"
#include "image/image_png.h"
#include "image/image_pnm.h"

#define SIGNATURE_BYTES 8

/* The module, which is loaded on the first call.  NULL after reporting an error about `label`. */
static const image_module *load_module(const char *label) {
    const image_module *module = module_load(IMAGE_MODULE_FILE, IMAGE_MODULE_SYMBOL);
    if (!module)
        report_error(label, "needs the module gscl-imageio.so, which reads and writes all formats but PNG: %s",
                     dlerror());
    return module;
}

static bool read_through_module(const char *label, const char *path, gscl_image *image) {
    char message[IMAGE_MESSAGE_SIZE];
    const image_module *module = load_module(label);
    return module && (module->read(path, image, message) || report_error(label, "%s", message));
}

/* The module reads files only, so bytes from a pipe go through a temporary file without a name. */
static bool read_bytes_through_module(const char *label, const uint8_t *bytes, size_t size, gscl_image *image) {
    FILE *spool = tmpfile();
    if (!spool)
        return report_error(label, "cannot be stored in a temporary file: %s", strerror(errno));
    char path[32];
    snprintf(path, sizeof path, "/dev/fd/%d", fileno(spool));
    const bool stored = fwrite(bytes, 1, size, spool) == size && fflush(spool) == 0;
    const bool ok = stored ? read_through_module(label, path, image)
                           : report_error(label, "cannot be stored in a temporary file: %s", strerror(errno));
    fclose(spool);
    return ok;
}

static bool is_regular_file(const char *name) {
    struct stat status;
    return stat(name, &status) == 0 && S_ISREG(status.st_mode);
}

/* Decodes the bytes of the input `name`. */
static bool read_bytes(const char *name, const uint8_t *bytes, size_t size, gscl_image *image) {
    char message[IMAGE_MESSAGE_SIZE];
    const char *label = input_label(name);
    if (size == 0)
        return report_error(label, "is empty; an image is expected");
    if (image_is_png(bytes, size))
        return image_read_png(bytes, size, image, message) || report_error(label, "%s", message);
    if (image_is_jpeg(bytes, size) && !image_jpeg_is_complete(bytes, size))
        return report_error(label, "ends too early; the file is truncated");
    if (is_regular_file(name))
        return read_through_module(label, name, image);
    return read_bytes_through_module(label, bytes, size, image);
}

static bool read_in_memory(const char *name, gscl_image *image) {
    uint8_t *bytes;
    size_t size;
    if (!read_file(name, MAX_IMAGE_FILE, &bytes, &size))
        return false;
    const bool ok = read_bytes(name, bytes, size, image);
    free(bytes);
    return ok;
}

bool image_read(const char *name, gscl_image *image) {
    uint8_t start[SIGNATURE_BYTES];
    size_t count;
    if (!is_regular_file(name)) /* a pipe can be read only once; reading reports a missing file */
        return read_in_memory(name, image);
    if (!read_file_start(name, start, sizeof start, &count))
        return false;
    if (count == 0 || image_is_png(start, count) || image_is_jpeg(start, count))
        return read_in_memory(name, image);
    return read_through_module(name, name, image);
}

static bool is_png_output(const output_file *output) {
    return !output->target || strcasecmp(name_suffix(output->label), ".png") == 0;
}

/* Returns false after reporting an error.  A failure of the output itself sets output->error and returns true. */
static bool write_pixels(output_file *output, const gscl_image *image) {
    char message[IMAGE_MESSAGE_SIZE];
    if (is_png_output(output))
        return image_write_png(output, image, message) || output->error || report_error(output->label, "%s", message);
    if (image_is_pnm_name(output->label))
        return image_write_pnm(output, image) || output->error;
    const image_module *module = load_module(output->label);
    return module && (module->write(output->stream, name_suffix(output->label), image, message) ||
                      report_error(output->label, "%s", message));
}

bool image_write(output_file *output, const gscl_image *image) {
    if (write_pixels(output, image))
        return output_commit(output); /* also reports output->error */
    output_discard(output);
    return false;
}
