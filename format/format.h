/* Reading and writing of gscl files as integers, as FORMAT.md describes them.
 *
 * The room format/ holds all that an independent decoder needs.  It is pure C99 and uses nothing outside itself: no
 * OpenCL, no stdio, no allocation, no floating point.  All memory is the caller's.
 *
 * Each pair of files uses only pairs that come before it in this order, which is also the order to read them in:
 *     types.h       the types and limits of a coded image
 *     quantiser     the values of codes in pixels and colour levels
 *     range_coder   symbols to bytes and back
 *     coder         one coder for both directions, which counts the bits of each stream
 *     header        the start of a picture: kind, size, number of splats, steps, background
 *     model         adaptive symbol frequencies
 *     conditional   adaptive symbol frequencies under a condition
 *     tables        the trained tables that those start from
 *     count_split   beta-binomial coding of a count that is split in two
 *     set           splats as a set: class counts and positions
 *     chroma        the two colour differences
 *     attributes    all other codes of a splat
 *     codebooks     the two codebooks of codebook coding
 *     classes       the class and the position grid of each splat
 *     order         the stored order
 *     check         the rules that an image must keep
 *     payload       everything after the header of a picture
 *     picture       the header and all after it, in one stream
 *     container     what surrounds a picture in a file
 *     packet        parts of a picture that can be drawn alone, and lists of them
 *     repair        packets from which others are computed that were lost
 *     format        this public face: whole files */
#ifndef GSCL_FORMAT_FORMAT_H
#define GSCL_FORMAT_FORMAT_H

#include "format/container.h"
#include "format/header.h"
#include "format/quantiser.h"
#include "format/types.h"

/* Reads the fields at the start of a whole file.  It needs no memory and returns GSF_OK also where only the check does
 * not match.  `bare`: the file is a picture without a container.  Call it first to learn coding and splat_count, then
 * provide arrays and call gsf_read. */
gsf_result gsf_read_header(const uint8_t *bytes, size_t size, bool bare, gsf_header *header);

/* Bytes of working memory (aligned for uint64_t) that the functions below need at `scratch`. */
size_t gsf_scratch_size(const gsf_header *header);
/* The same for reading alone, which needs less. */
size_t gsf_read_scratch_size(const gsf_header *header);

/* Reads and checks a whole file, of the form that image->bare says, or a list of packets (packet.h), which need not be all
 * of a picture.  `splats` or `indexed` (and the codebook arrays) must be in place.  Never reads outside bytes[0..size),
 * whatever it holds. */
gsf_result gsf_read(const uint8_t *bytes, size_t size, gsf_coded_image *image, void *scratch);

/* Reads what the first bytes of a file hold, of the form that image->bare says; more may follow.  *total is the number
 * of splats of the image, and image->header.splat_count that of those which no further byte can change: the first in the
 * stored order.  Returns GSF_TRUNCATED where not even the header of the picture has come.  Damage is not detected. */
gsf_result gsf_read_prefix(const uint8_t *bytes, size_t size, gsf_coded_image *image, uint32_t *total, void *scratch);

/* An upper bound of the size of the written file. */
size_t gsf_write_bound(const gsf_coded_image *image);

/* Writes the image, with its blocks unless it is bare, or as a packet where header.packets is not 0, and sets *size to the
 * size of the file.  Sorts image->splats (or ->indexed) into the stored order in place and zeroes the codes of effects that
 * are off, so that afterwards the image equals the one that gsf_read would return.  The file is a function of the image
 * alone.  Returns GSF_INVALID when a value is outside the format's limits, or when the splats together cover more pixels
 * than FORMAT.md's "Limits" allow. */
gsf_result gsf_write(gsf_coded_image *image, uint8_t *bytes, size_t capacity, size_t *size, void *scratch);

/* Counts the exact size of the file that gsf_write would write, without writing it.  The splats must be in the stored
 * order (gsf_sort) and the codes of effects that are off must be zero. */
gsf_result gsf_size(gsf_coded_image *image, size_t *size, void *scratch);

/* Sorts the splats into the stored order without writing: `alpha` depends on it.  Zeroes the codes of
 * effects that are off.  The codes must be within their limits. */
void gsf_sort(gsf_coded_image *image, void *scratch);

#endif
