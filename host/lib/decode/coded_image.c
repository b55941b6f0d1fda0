#include "decode/coded_image.h"

#include <stdlib.h>
#include <string.h>

#include "cl/constants.h"
#include "decode/blend.h"
#include "decode/dequantise.h"
#include "decode/format_result.h"
#include "format/packet.h"

void gscl_coded_image_free(gscl_coded_image *p) {
    free(p->file.splats);
    free(p->file.indexed);
    free(p->file.codebooks.shape_words);
    free(p->file.codebooks.colour_words);
    free(p->scratch);
    memset(p, 0, sizeof *p);
}

static gscl_result reserve_codebooks(gsf_codebooks *books) {
    if (!books->shape_words)
        books->shape_words = calloc(GSF_MAX_CODEBOOK, sizeof *books->shape_words);
    if (!books->colour_words)
        books->colour_words = calloc(GSF_MAX_CODEBOOK, sizeof *books->colour_words);
    return books->shape_words && books->colour_words ? GSCL_OK : GSCL_ERROR_OUT_OF_MEMORY;
}

gscl_result gscl_coded_image_reserve(gscl_coded_image *p, size_t splats) {
    bool indexed = p->file.header.coding == GSF_CODING_CODEBOOK;
    if (indexed)
        GSCL_TRY(reserve_codebooks(&p->file.codebooks));
    if (p->scratch && splats <= p->capacity)
        return GSCL_OK;
    gsf_header largest = p->file.header;
    largest.splat_count = (uint32_t)splats;
    largest.enhancement_layers = GSF_MAX_LAYERS - 1; /* an encoder adds layers later */
    free(p->scratch);
    p->scratch = malloc(gsf_scratch_size(&largest) + 8);
    size_t row = indexed ? sizeof(gsf_indexed_splat) : sizeof(gsf_splat);
    void *grown = realloc(indexed ? (void *)p->file.indexed : (void *)p->file.splats, (splats + 1) * row);
    if (grown && indexed)
        p->file.indexed = grown;
    if (grown && !indexed)
        p->file.splats = grown;
    if (!grown || !p->scratch)
        return GSCL_ERROR_OUT_OF_MEMORY;
    p->capacity = splats;
    return GSCL_OK;
}

gscl_result gscl_coded_image_read(gscl_coded_image *p, const uint8_t *bytes, size_t size, bool bare) {
    return gscl_coded_image_read_counted(p, bytes, size, bare, NULL);
}

static gscl_result read_file(gscl_coded_image *p, const uint8_t *bytes, size_t size, bool bare,
                             uint64_t *stream_bits256) {
    memset(p, 0, sizeof *p);
    p->file.bare = bare;
    p->file.stream_bits256 = stream_bits256;
    GSCL_TRY(gscl_result_of_format(gsf_read_header(bytes, size, bare, &p->file.header)));
    gscl_result result = gscl_coded_image_reserve(p, p->file.header.splat_count);
    if (result == GSCL_OK)
        result = gscl_result_of_format(gsf_read(bytes, size, &p->file, p->scratch));
    if (result != GSCL_OK)
        gscl_coded_image_free(p);
    return result;
}

gscl_result gscl_repair_list(const uint8_t *list, size_t size, uint8_t **repaired, size_t *repaired_size) {
    const size_t needed = gscl_repair_memory(list, size);
    *repaired = NULL;
    if (needed == 0)
        return GSCL_OK;
    *repaired = malloc(needed);
    return *repaired ? gscl_repair_packets(list, size, *repaired, needed, repaired_size) : GSCL_ERROR_OUT_OF_MEMORY;
}

/* Reads a list of packets, which may lack some. */
static gscl_result read_list(gscl_coded_image *p, const uint8_t *list, size_t size, uint64_t *stream_bits256) {
    uint8_t *repaired;
    size_t repaired_size;
    GSCL_TRY(gscl_repair_list(list, size, &repaired, &repaired_size));
    const gscl_result result = repaired ? read_file(p, repaired, repaired_size, false, stream_bits256)
                                        : read_file(p, list, size, false, stream_bits256);
    if (result == GSCL_OK && repaired && stream_bits256) /* what was computed is not in the list */
        stream_bits256[GSF_STREAM_CONTAINER] -= ((uint64_t)repaired_size - size) * 8 * 256;
    free(repaired);
    return result;
}

gscl_result gscl_coded_image_read_counted(gscl_coded_image *p, const uint8_t *bytes, size_t size, bool bare,
                                          uint64_t *stream_bits256) {
    return !bare && gsf_is_packet_list(bytes, size) ? read_list(p, bytes, size, stream_bits256)
                                                    : read_file(p, bytes, size, bare, stream_bits256);
}

gscl_result gscl_coded_image_read_prefix(gscl_coded_image *p, const uint8_t *bytes, size_t size, bool bare,
                                         uint32_t *total) {
    if (!bare && gsf_is_packet_list(bytes, size)) {
        GSCL_TRY(read_list(p, bytes, size, NULL));
        *total = p->file.header.splat_count;
        return GSCL_OK;
    }
    memset(p, 0, sizeof *p);
    p->file.bare = bare;
    GSCL_TRY(gscl_result_of_format(gsf_read_header(bytes, size, bare, &p->file.header)));
    gscl_result result = gscl_coded_image_reserve(p, p->file.header.splat_count);
    if (result == GSCL_OK)
        result = gscl_result_of_format(gsf_read_prefix(bytes, size, &p->file, total, p->scratch));
    if (result != GSCL_OK)
        gscl_coded_image_free(p);
    return result;
}

gscl_result gscl_coded_image_write(gscl_coded_image *p, uint8_t **bytes, size_t *size) {
    GSCL_TRY(gscl_coded_image_reserve(p, p->file.header.splat_count));
    size_t bound = gsf_write_bound(&p->file);
    uint8_t *buffer = malloc(bound);
    if (!buffer)
        return GSCL_ERROR_OUT_OF_MEMORY;
    gsf_result result = gsf_write(&p->file, buffer, bound, size, p->scratch);
    if (result != GSF_OK) {
        free(buffer);
        return gscl_result_of_format(result);
    }
    uint8_t *shrunk = realloc(buffer, *size);
    *bytes = shrunk ? shrunk : buffer;
    return GSCL_OK;
}

/* A splat's codes as bytes, and its place. */
typedef struct tagged_splat {
    unsigned char codes[sizeof(gsf_splat) > sizeof(gsf_indexed_splat) ? sizeof(gsf_splat) : sizeof(gsf_indexed_splat)];
    size_t place;
} tagged_splat;

static int compare_tagged(const void *a, const void *b) {
    const tagged_splat *p = a, *q = b;
    int order = memcmp(p->codes, q->codes, sizeof p->codes);
    return order ? order : p->place < q->place ? -1 : p->place > q->place;
}

static void tag_splats(const gsf_coded_image *file, tagged_splat *tags) {
    bool indexed = file->header.coding == GSF_CODING_CODEBOOK;
    for (size_t i = 0; i < file->header.splat_count; i++) {
        if (indexed)
            memcpy(tags[i].codes, &file->indexed[i], sizeof file->indexed[i]);
        else
            memcpy(tags[i].codes, &file->splats[i], sizeof file->splats[i]);
        tags[i].place = i;
    }
    qsort(tags, file->header.splat_count, sizeof *tags, compare_tagged);
}

/* Pairs codes before and after sorting: both are listed in the order of their bytes, so that equals keep their
 * order. */
static gscl_result sort_with_order(gscl_coded_image *p, size_t *order) {
    size_t count = p->file.header.splat_count;
    tagged_splat *before = calloc(2 * count + 1, sizeof *before), *after = before + count;
    if (!before)
        return GSCL_ERROR_OUT_OF_MEMORY;
    tag_splats(&p->file, before);
    gsf_sort(&p->file, p->scratch);
    tag_splats(&p->file, after);
    for (size_t i = 0; i < count; i++)
        order[after[i].place] = before[i].place;
    free(before);
    return GSCL_OK;
}

gscl_result gscl_coded_image_sort(gscl_coded_image *p, size_t *order) {
    GSCL_TRY(gscl_coded_image_reserve(p, p->file.header.splat_count));
    if (order)
        return sort_with_order(p, order);
    gsf_sort(&p->file, p->scratch);
    return GSCL_OK;
}

gscl_result gscl_coded_image_fail(gscl_context *context, gscl_result result, const uint8_t *bytes, size_t size) {
    if (result == GSCL_ERROR_NEWER_VERSION && size > 4)
        return gscl_fail(context, result, "written in format version %u; this program reads up to version %d",
                         bytes[4] & 15, GSF_VERSION);
    if (result == GSCL_ERROR_TRUNCATED)
        return gscl_fail(context, result, "the file is incomplete: %zu bytes are there and more are needed", size);
    return gscl_fail(context, result, "%s", gscl_result_text(result));
}

gscl_kernel_options gscl_coded_image_options(const gsf_header *header) {
    return (gscl_kernel_options){.blend = gscl_blend_to_kernels(gscl_blend_from_format(header->blend)),
                                 .colours = header->has_chroma ? 3 : 1,
                                 .alpha_channel = header->has_alpha,
                                 .opacity = header->has_opacity,
                                 .texture = header->has_texture,
                                 .shape = header->has_rotation     ? GSCL_SHAPE_ROTATED
                                          : header->has_anisotropy ? GSCL_SHAPE_AXIS_ALIGNED
                                                                   : GSCL_SHAPE_ISOTROPIC};
}

void gscl_forget_effects_without_splats(gsf_header *header) {
    if (header->splat_count == 0)
        header->enhancement_layers = header->has_opacity = header->has_rotation = header->has_anisotropy =
            header->has_texture = false;
}

uint32_t gscl_coded_image_channels(const gsf_header *header) {
    static const uint32_t channels[] = {[GSF_GREY] = 1, [GSF_GREY_ALPHA] = 2, [GSF_RGB] = 3, [GSF_RGBA] = 4};
    return channels[header->layout];
}

void gscl_coded_image_params(const gscl_coded_image *p, float *params, float background[4]) {
    const unsigned channels = gsf_channel_count(&p->file.header);
    gscl_real sums[4] = {0};
    for (uint32_t i = 0; i < p->file.header.splat_count; i++, params += GSCL_PARAMS) {
        gscl_dequantise_splat(&p->file, i, params);
        for (unsigned k = 0; k < channels; k++)
            sums[k] += params[GSCL_COLOUR + k];
    }
    gscl_dequantise_background(&p->file, sums, background);
}
