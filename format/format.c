#include "format/format.h"

#include <string.h>

#include "format/check.h"
#include "format/classes.h"
#include "format/container.h"
#include "format/header.h"
#include "format/order.h"
#include "format/packet.h"
#include "format/payload.h"
#include "format/picture.h"

/* The splats of a list of packets are sorted, too. */
size_t gsf_read_scratch_size(const gsf_header *header) {
    return gsf_header_packets(header) > 0 ? gsf_scratch_size(header) : gsf_workspace_size(header);
}

/* Sorting and coding use the memory one after the other. */
size_t gsf_scratch_size(const gsf_header *header) {
    const size_t coding = gsf_workspace_size(header);
    const size_t sorting = sizeof(gsf_workspace) + gsf_order_size(header);
    return coding > sorting ? coding : sorting;
}

/* The picture of a file of either form.  Without a container there is no check, which is taken to match. */
static gsf_result open_file(const uint8_t *bytes, size_t size, bool bare, gsf_container *container) {
    if (!bare)
        return gsf_open_container(bytes, size, container);
    *container = (gsf_container){.picture = {bytes, size}};
    return GSF_OK;
}

/* The result for a file whose picture gave this result. */
static gsf_result result_of_picture(gsf_result result, const gsf_container *container, bool bare) {
    if (bare)
        return result;
    if (container->is_intact)
        return result == GSF_OK ? GSF_OK : GSF_CORRUPT;
    return result == GSF_TRUNCATED ? GSF_TRUNCATED : GSF_DAMAGED;
}

gsf_result gsf_read_header(const uint8_t *bytes, size_t size, bool bare, gsf_header *header) {
    gsf_container container;
    gsf_coder coder;
    *header = (gsf_header){.width = 0};
    if (!bare && gsf_is_packet_list(bytes, size))
        return gsf_read_list_header(bytes, size, header);
    const gsf_result result = open_file(bytes, size, bare, &container);
    if (result != GSF_OK)
        return result;
    gsf_coder_read_from(&coder, container.picture.data, container.picture.size, NULL);
    gsf_code_fields(&coder, header);
    return gsf_coder_overrun(&coder) ? result_of_picture(GSF_TRUNCATED, &container, bare) : GSF_OK;
}

/* Bytes around a picture without blocks. */
static size_t frame_size(const gsf_coded_image *image) {
    const gsf_bytes none[GSF_BLOCK_COUNT] = {{NULL, 0}};
    if (image->header.packets > 0)
        return GSF_PACKET_FRAME;
    return image->bare ? 0 : gsf_container_size(none);
}

/* Resets the counters and adds the bits of the container. */
static void count_container(const gsf_coded_image *image, size_t size, size_t picture_size) {
    if (!GSF_STREAM_BITS(image))
        return;
    const size_t all = size - picture_size, fixed = all > 0 ? frame_size(image) : 0;
    memset(image->stream_bits256, 0, GSF_STREAM_COUNT * sizeof *image->stream_bits256);
    image->stream_bits256[GSF_STREAM_CONTAINER] = (uint64_t)fixed * 8 * 256;
    image->stream_bits256[GSF_STREAM_BLOCKS] = (uint64_t)(all - fixed) * 8 * 256;
}

/* Clears the fields that reading sets.  The arrays and the pointers to them stay. */
static void clear_fields(gsf_coded_image *image) {
    gsf_codebooks *books = &image->codebooks;
    image->has_mean_background = false;
    memset(image->background, 0, sizeof image->background);
    memset(&image->steps, 0, sizeof image->steps);
    memset(books->shape, 0, sizeof books->shape);
    memset(books->colour, 0, sizeof books->colour);
    books->position_bits = books->shape_bits = books->colour_bits = 0;
    books->shape_count = books->colour_count = 0;
}

/* Reads a list of packets, which takes the bits of the pictures that it reads from those of the container. */
static gsf_result read_list(const uint8_t *list, size_t size, gsf_coded_image *image, void *scratch) {
    count_container(image, 0, 0);
    if (GSF_STREAM_BITS(image))
        image->stream_bits256[GSF_STREAM_CONTAINER] = (uint64_t)size * 8 * 256;
    return gsf_read_list(list, size, image, scratch);
}

gsf_result gsf_read(const uint8_t *bytes, size_t size, gsf_coded_image *image, void *scratch) {
    gsf_container container;
    clear_fields(image);
    if (!image->bare && gsf_is_packet_list(bytes, size))
        return read_list(bytes, size, image, scratch);
    const gsf_result result = open_file(bytes, size, image->bare, &container);
    if (result != GSF_OK)
        return result;
    count_container(image, size, container.picture.size);
    return result_of_picture(gsf_read_picture(image, container.picture, scratch), &container, image->bare);
}

gsf_result gsf_read_prefix(const uint8_t *bytes, size_t size, gsf_coded_image *image, uint32_t *total, void *scratch) {
    gsf_container container = {.picture = {bytes, size}};
    gsf_coder coder;
    if (!image->bare && gsf_is_packet_list(bytes, size)) {
        const gsf_result whole = gsf_read(bytes, size, image, scratch);
        *total = image->header.splat_count;
        return whole;
    }
    clear_fields(image);
    const gsf_result result = image->bare ? GSF_OK : gsf_open_container_prefix(bytes, size, &container);
    if (result != GSF_OK)
        return result;
    if (container.is_intact) {
        const gsf_result whole = gsf_read(bytes, size, image, scratch);
        *total = image->header.splat_count;
        return whole;
    }
    count_container(image, size, container.picture.size);
    gsf_coder_read_from(&coder, container.picture.data, container.picture.size, image->stream_bits256);
    gsf_code_header(&coder, image);
    const bool has_header = gsf_coder_is_certain(&coder);
    if (gsf_coder_overrun(&coder) || (!has_header && !image->bare))
        return GSF_TRUNCATED;
    gsf_workspace *workspace = gsf_workspace_in(&image->header, scratch);
    const bool valid = gsf_code_payload(&coder, image, workspace);
    *total = image->header.splat_count;
    if (image->bare && valid &&
        gsf_picture_is_at_end(&coder)) /* a bare file has no check: that it is whole shows here */
        return GSF_OK;
    if (!has_header)
        return GSF_TRUNCATED;
    image->header.splat_count = workspace->certain;
    return gsf_work_is_bounded(image) ? GSF_OK : GSF_CORRUPT;
}

/* The largest number of splits from the whole grid of a class to one cell. */
static size_t max_splits(const gsf_coded_image *image) {
    size_t splits = 0;
    for (uint32_t i = 0; i < gsf_class_count(image); i++) {
        const gsf_grid grid = gsf_class_grid(image, i);
        size_t own = 2;
        while (grid.cells_x >> own / 2 != 0 || grid.cells_y >> own / 2 != 0)
            own += 2;
        splits = own > splits ? own : splits;
    }
    return splits;
}

/* Bytes around the picture. */
static size_t container_size(const gsf_coded_image *image) {
    if (image->header.packets > 0)
        return GSF_PACKET_FRAME;
    return image->bare ? 0 : gsf_container_size(image->blocks);
}

/* No symbol costs more than 17 bits: a frequency is at least 1 of 2^16, and dividing the range loses less than a bit.
 * The attributes of a splat are at most 15 symbols.  A split of n > 0 splats is one symbol, or two when n > 255. */
size_t gsf_write_bound(const gsf_coded_image *image) {
    const gsf_header *header = &image->header;
    const size_t splat_bits = 17 * (15 + (header->splat_count > 0 ? max_splits(image) : 0));
    const size_t class_bits = 2 * 17 * GSF_MAX_CLASSES;
    const size_t word_bits = GSF_MAX_CODEBOOK * 17 * (16 + GSF_SHAPE_DIMS + 16 + GSF_MAX_COLOUR_DIMS);
    const size_t book_bits = header->coding == GSF_CODING_CODEBOOK ? word_bits : 0;
    return 512 + container_size(image) + (header->splat_count * splat_bits + class_bits + book_bits) / 8;
}

void gsf_sort(gsf_coded_image *image, void *scratch) {
    gsf_sort_splats(image, (gsf_workspace *)scratch + 1); /* records need the alignment of the workspace */
}

/* Bytes before the picture. */
static size_t start_size(const gsf_coded_image *image) {
    if (image->header.packets > 0)
        return 1;
    return image->bare ? 0 : gsf_container_start_size(image->blocks);
}

/* Writes what surrounds the picture. */
static void put_container(const gsf_coded_image *image, uint8_t *bytes, size_t picture_size) {
    if (image->header.packets > 0) {
        gsf_put_packet_frame(bytes, picture_size, image->identity);
    } else if (!image->bare) {
        gsf_put_container_start(bytes, image->blocks);
        gsf_put_container_end(bytes, start_size(image) + picture_size, image->blocks);
    }
}

gsf_result gsf_write(gsf_coded_image *image, uint8_t *bytes, size_t capacity, size_t *size, void *scratch) {
    size_t picture_size;
    *size = 0;
    if (!gsf_coded_image_is_valid(image))
        return GSF_INVALID;
    const size_t around = container_size(image);
    if (capacity < around)
        return GSF_NO_SPACE;
    count_container(image, around, 0);
    gsf_sort(image, scratch);
    const gsf_result result =
        gsf_write_picture(image, bytes + start_size(image), capacity - around, &picture_size, scratch);
    if (result != GSF_OK)
        return result;
    put_container(image, bytes, picture_size);
    *size = around + picture_size;
    return GSF_OK;
}

gsf_result gsf_size(gsf_coded_image *image, size_t *size, void *scratch) {
    size_t picture_size;
    *size = 0;
    if (!gsf_coded_image_is_valid(image))
        return GSF_INVALID;
    const gsf_result result = gsf_write_picture(image, NULL, 0, &picture_size, scratch);
    if (result == GSF_INVALID)
        return result;
    *size = container_size(image) + picture_size;
    return GSF_OK;
}
