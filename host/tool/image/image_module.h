/* Interface of the image module: OpenImageIO and OpenJPEG behind C functions.
 *
 * The module is a shared object that is loaded on first use, because OpenImageIO links hundreds of libraries and takes
 * longer to load than a file takes to decode. */
#ifndef GSCL_TOOL_IMAGE_MODULE_H
#define GSCL_TOOL_IMAGE_MODULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <gscl/gscl.h>

#include "image/image_content.h"

typedef struct image_module {
    /* Reads the first image of a file with a plug-in of OpenImageIO: of bytes, or of the file `path`, which
     * for plug-ins that read no bytes (HEIF, SGI).  content->cmyk says on entry whether four channels are inks; a file of inks is
     * refused otherwise.  content->alpha says what the last of an even number of channels is.  Of what lies beside the
     * pixels, the module takes the profile, the primaries and the orientation.  The caller frees the content in any case. */
    bool (*read)(const char *plugin, const char *path, const uint8_t *bytes, size_t size, image_content *content,
                 char message[IMAGE_MESSAGE_SIZE]);
    /* image_read_jpeg2000. */
    bool (*read_jpeg2000)(const uint8_t *bytes, size_t size, image_content *content, char message[IMAGE_MESSAGE_SIZE]);
    /* Writes an image to a stream, in the format that the suffix (".tif") names. */
    bool (*write)(FILE *stream, const char *suffix, const gscl_image *image, char message[IMAGE_MESSAGE_SIZE]);
} image_module;

#define IMAGE_MODULE_FILE "gscl-imageio.so"
#define IMAGE_MODULE_SYMBOL "gscl_image_module" /* of type image_module */

#endif
