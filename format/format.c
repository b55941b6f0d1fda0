#include "format/format.h"

#include <string.h>

#include "format/check.h"
#include "format/classes.h"
#include "format/order.h"
#include "format/payload.h"

/* Rows of the list of points: splats, or the words of a codebook. */
static size_t point_rows(const gsf_header *header) {
    return header->splat_count > GSF_MAX_CODEBOOK ? header->splat_count : GSF_MAX_CODEBOOK;
}

/* Bytes behind the workspace.  Sorting and coding use them one after the other. */
static size_t lists_size(const gsf_header *header) {
    const size_t splats = header->splat_count;
    const size_t priors = splats < GSF_MAX_PRIORS ? splats : GSF_MAX_PRIORS;
    const size_t coding = point_rows(header) * sizeof(gsf_point) + priors * sizeof(gsf_prior);
    const size_t sorting = gsf_order_size(header);
    return coding > sorting ? coding : sorting;
}

size_t gsf_scratch_size(const gsf_header *header) {
    return sizeof(gsf_workspace) + lists_size(header);
}

/* The workspace at the start of the scratch memory, with its lists behind it. */
static gsf_workspace *workspace_in(const gsf_header *header, void *scratch) {
    gsf_workspace *workspace = scratch;
    workspace->points = (gsf_point *)(workspace + 1);
    workspace->priors = (gsf_prior *)(workspace->points + point_rows(header));
    return workspace;
}

gsf_result gsf_read_header(const uint8_t *bytes, size_t size, gsf_header *header) {
    size_t header_size;
    return gsf_parse_header(bytes, size, header, &header_size);
}

/* Resets the counters and adds the header. */
static void count_header(const gsf_coded_image *image, size_t size) {
    if (!image->stream_bits256)
        return;
    memset(image->stream_bits256, 0, GSF_STREAM_COUNT * sizeof *image->stream_bits256);
    image->stream_bits256[GSF_STREAM_HEADER] = (uint64_t)size * 8 * 256;
}

/* A payload is valid only if the decoder consumes exactly its bytes. */
static gsf_result read_payload(gsf_coded_image *image, const uint8_t *bytes, size_t size, void *scratch) {
    gsf_coder coder;
    gsf_coder_read_from(&coder, bytes, size, image->stream_bits256);
    const bool valid = gsf_code_payload(&coder, image, workspace_in(&image->header, scratch));
    if (gsf_coder_overrun(&coder))
        return GSF_TRUNCATED;
    return valid && coder.decoder.position == size + GSF_IMPLIED_BYTES ? GSF_OK : GSF_CORRUPT;
}

/* Clears the fields that reading sets.  The arrays and the pointers to them stay. */
static void clear_fields(gsf_coded_image *image) {
    gsf_codebooks *books = &image->codebooks;
    memset(image->background, 0, sizeof image->background);
    memset(&image->steps, 0, sizeof image->steps);
    memset(books->shape, 0, sizeof books->shape);
    memset(books->colour, 0, sizeof books->colour);
    books->position_bits = books->shape_bits = books->colour_bits = 0;
    books->shape_count = books->colour_count = 0;
}

gsf_result gsf_read(const uint8_t *bytes, size_t size, gsf_coded_image *image, void *scratch) {
    size_t start;
    clear_fields(image);
    gsf_result result = gsf_parse_header(bytes, size, &image->header, &start);
    if (result != GSF_OK)
        return result;
    count_header(image, start);
    result = read_payload(image, bytes + start, size - start, scratch);
    if (gsf_file_checksum(bytes, size, start) == gsf_stored_checksum(bytes, start))
        return result == GSF_OK ? GSF_OK : GSF_CORRUPT;
    return result == GSF_TRUNCATED ? GSF_TRUNCATED : GSF_DAMAGED;
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

/* No symbol costs more than 17 bits: a frequency is at least 1 of 2^16, and dividing the range loses less than a bit.
 * The attributes of a splat are at most 13 symbols.  A split of n > 0 splats is one symbol, or two when n > 255. */
size_t gsf_write_bound(const gsf_coded_image *image) {
    const gsf_header *header = &image->header;
    const size_t splat_bits = 17 * (13 + (header->splat_count > 0 ? max_splits(image) : 0));
    const size_t class_bits = 2 * 17 * GSF_MAX_CLASSES;
    const size_t word_bits = GSF_MAX_CODEBOOK * 17 * (16 + GSF_SHAPE_DIMS + 16 + GSF_MAX_COLOUR_DIMS);
    const size_t book_bits = header->coding == GSF_CODING_CODEBOOK ? word_bits : 0;
    return 512 + (header->splat_count * splat_bits + class_bits + book_bits) / 8;
}

void gsf_sort(gsf_coded_image *image, void *scratch) {
    gsf_sort_splats(image, (gsf_workspace *)scratch + 1); /* records need the alignment of the workspace */
}

/* The coder counts the bytes that do not fit, so that a capacity of 0 gives the size alone, without bits by stream. */
static gsf_result write_payload(gsf_coded_image *image, uint8_t *bytes, size_t capacity, size_t *size, void *scratch) {
    gsf_coder coder;
    gsf_coder_write_to(&coder, bytes, capacity, capacity > 0 ? image->stream_bits256 : NULL);
    if (!gsf_code_payload(&coder, image, workspace_in(&image->header, scratch)))
        return GSF_INVALID;
    gsf_range_encoder_finish(&coder.encoder);
    *size = coder.encoder.size;
    return *size <= capacity ? GSF_OK : GSF_NO_SPACE;
}

gsf_result gsf_write(gsf_coded_image *image, uint8_t *bytes, size_t capacity, size_t *size, void *scratch) {
    uint8_t header[GSF_MAX_HEADER_SIZE];
    size_t payload_size;
    *size = 0;
    image->header.version = GSF_VERSION;
    if (!gsf_coded_image_is_valid(image))
        return GSF_INVALID;
    const size_t start = gsf_put_header(&image->header, header);
    if (capacity < start)
        return GSF_NO_SPACE;
    memcpy(bytes, header, start);
    count_header(image, start);
    gsf_sort(image, scratch);
    const gsf_result result = write_payload(image, bytes + start, capacity - start, &payload_size, scratch);
    if (result != GSF_OK)
        return result;
    *size = start + payload_size;
    gsf_store_checksum(bytes, *size, start);
    return GSF_OK;
}

gsf_result gsf_size(gsf_coded_image *image, size_t *size, void *scratch) {
    uint8_t header[GSF_MAX_HEADER_SIZE];
    size_t payload_size;
    *size = 0;
    image->header.version = GSF_VERSION;
    if (!gsf_coded_image_is_valid(image))
        return GSF_INVALID;
    const gsf_result result = write_payload(image, NULL, 0, &payload_size, scratch);
    if (result == GSF_INVALID)
        return result;
    *size = gsf_put_header(&image->header, header) + payload_size;
    return GSF_OK;
}
