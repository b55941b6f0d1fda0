/* Image files: PNG by libpng, all others by a module that wraps OpenImageIO.
 *
 * It may use: cli/ and the public headers.
 *
 * In the order in which to read them:
 *   image_file.h: reading and writing
 *   image_format.h: formats by suffix and what they can hold
 *   image_png.h, image_jpeg.h, image_pnm.h: single formats
 *   image_module.h, image_oiio.cpp: the module
 *   synthetic_image.h: an image for benchmarks */
#ifndef GSCL_ROOM_TOOL_IMAGE_H
#define GSCL_ROOM_TOOL_IMAGE_H
#endif
