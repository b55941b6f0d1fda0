/* Between the tool and its image module: OpenImageIO behind two C functions.
 *
 * The module is a shared object of its own, loaded when it is first needed, because OpenImageIO pulls in
 * hundreds of libraries and takes longer to load than a picture takes to decode. */
#ifndef GSCL_TOOL_IMAGE_MODULE_H
#define GSCL_TOOL_IMAGE_MODULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include <gscl/gscl.h>

#define IMAGE_MESSAGE_SIZE 512 /* bytes for what went wrong, a phrase that follows the file's name */

/* What an image outside the library's limits is refused with; takes width and height as unsigned. */
#define IMAGE_SIZE_MESSAGE "is %u x %u pixels; 1 x 1 to 16384 x 16384 are possible"

typedef struct image_module {
    /* Reads the first image of a file; image->pixels is released with free. */
    bool (*read)(const char *path, gscl_image *image, char message[IMAGE_MESSAGE_SIZE]);
    /* Writes an image to a stream, in the format that the suffix (".tif") names. */
    bool (*write)(FILE *stream, const char *suffix, const gscl_image *image, char message[IMAGE_MESSAGE_SIZE]);
} image_module;

#define IMAGE_MODULE_FILE "gscl-imageio.so"
#define IMAGE_MODULE_SYMBOL "gscl_image_module" /* an image_module */

#endif
