/* Interface of the image module: OpenImageIO behind two C functions.
 *
 * The module is a shared object that is loaded on first use, because OpenImageIO links hundreds of libraries and takes
 * longer to load than a file takes to decode. */
#ifndef GSCL_TOOL_IMAGE_MODULE_H
#define GSCL_TOOL_IMAGE_MODULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include <gscl/gscl.h>

#define IMAGE_MESSAGE_SIZE 512 /* bytes of an error message, a phrase that follows the name of the file */

/* Format of the message about an image outside the limits of the library; takes width and height as unsigned. */
#define IMAGE_SIZE_MESSAGE "is %u x %u pixels; 1 x 1 to 16384 x 16384 are possible"

typedef struct image_module {
    /* Reads the first image of a file; image->pixels is released with free. */
    bool (*read)(const char *path, gscl_image *image, char message[IMAGE_MESSAGE_SIZE]);
    /* Writes an image to a stream, in the format that the suffix (".tif") names. */
    bool (*write)(FILE *stream, const char *suffix, const gscl_image *image, char message[IMAGE_MESSAGE_SIZE]);
} image_module;

#define IMAGE_MODULE_FILE "gscl-imageio.so"
#define IMAGE_MODULE_SYMBOL "gscl_image_module" /* of type image_module */

#endif
