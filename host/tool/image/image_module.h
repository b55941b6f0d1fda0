/* Interface of the image module: OpenImageIO behind two C functions.
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
    /* Reads the first image of a file: of the file `path`, or of bytes, whose format the suffix of `path` names
     * then.  content->cmyk says on entry whether four channels are inks; a file of inks is refused otherwise.  Bytes
     * come with their metadata taken; of that of a path, the module takes the profile, the primaries and the
     * orientation.  The caller frees the content in any case. */
    bool (*read)(const char *path, const uint8_t *bytes, size_t size, image_content *content,
                 char message[IMAGE_MESSAGE_SIZE]);
    /* Writes an image to a stream, in the format that the suffix (".tif") names. */
    bool (*write)(FILE *stream, const char *suffix, const gscl_image *image, char message[IMAGE_MESSAGE_SIZE]);
} image_module;

#define IMAGE_MODULE_FILE "gscl-imageio.so"
#define IMAGE_MODULE_SYMBOL "gscl_image_module" /* of type image_module */

#endif
