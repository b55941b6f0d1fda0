/* Image files: PNG by libpng, JPEG by libjpeg, all others by a module that wraps OpenImageIO and OpenJPEG; colours by
 * LittleCMS.
 *
 * It may use: cli/, the public headers, and host/colours.
 *
 * In the order in which to read them:
 *   image_file.h: reading and writing
 *   image_content.h: pixels, colours and metadata of a file
 *   image_kind.h, image_variant.h: formats that are read, and variants that are refused
 *   image_format.h: formats that are written, and what they can hold
 *   image_png.h, image_jpeg.h, image_pnm.h, image_tiff.h, image_ico.h: single formats
 *   image_module.h, image_oiio.cpp, image_jpeg2000.h: the module
 *   image_samples.h: changes of samples
 *   image_webp.h, image_heif.h, png_chunks.h: metadata of formats
 *   tiff_tags.h, exif.h, orientation.h: EXIF, and turning an image upright
 *   image_colours.h, colour_profile.h, colour_convert.h: colours other than those of sRGB
 *   image_output.h, image_alpha.h: what of them and of alpha an output can hold
 *   synthetic_image.h: an image for benchmarks */
#ifndef GSCL_ROOM_TOOL_IMAGE_H
#define GSCL_ROOM_TOOL_IMAGE_H
#endif
