/* Writes files from their codes as text, reads files to that text, and decodes them by the library.
 *
 *     codes write TEXT OUT [bare] [unchecked]
 *     codes packets TEXT OUT IDENTITY COUNT REPAIRS [everywhere]
 *                                            writes a list of COUNT packets and REPAIRS repair packets.  A splat that several
 *                                            packets may have goes into one of them, or `everywhere` into all
 *     codes read whole|bare FILE...          prints for each file: file NAME RESULT, then the codes of a valid one
 *     codes prefixes whole|bare FILE...      prints for each valid file: file NAME, then of each prefix:
 *                                            prefix SIZE RESULT CERTAIN TOTAL
 *     codes decode-host|decode-cpu|decode-gpu whole|bare FOLDER FILE...
 *                                            decodes on the device "host", or on the first OpenCL device in the mapping of
 *                                            CPUs or GPUs: writes the samples of the Nth file to FOLDER/N.raw, numbers from
 *                                            0, of 16 bits with the low byte first, and prints:
 *                                            file NAME RESULT WIDTH HEIGHT CHANNELS BITS
 *     codes pixels whole|bare FILE X Y...    decodes single pixels on the device "host", which takes less time than the whole of
 *                                            a large image, and prints for each: BITS SAMPLE...
 *     codes decoders                         prints those of the words decode-host, decode-cpu and decode-gpu for which the
 *                                            library was built
 *
 * README.md describes the text.  RESULT is `valid` or a result of FORMAT.md, with `-` for spaces.  `unchecked` writes
 * files that break the limit of the work, too. */
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "devices.h"
#include "format/classes.h"
#include "format/codebooks.h"
#include "format/coder.h"
#include "format/format.h"
#include "format/header.h"
#include "format/packet.h"
#include "format/payload.h"
#include "format/repair.h"

#define MAX_LINE 100000
#define MAX_NUMBERS 16

static void fail(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    exit(1);
}

static void *allocate(size_t count, size_t size) {
    void *memory = calloc(count > 0 ? count : 1, size);
    if (!memory)
        fail("out of memory");
    return memory;
}

static const char *result_name(gsf_result result) {
    static const char *const names[] = {[GSF_OK] = "valid",
                                        [GSF_NOT_GSCL] = "not-a-gscl-file",
                                        [GSF_NEWER_VERSION] = "newer-version",
                                        [GSF_TRUNCATED] = "truncated",
                                        [GSF_DAMAGED] = "damaged",
                                        [GSF_CORRUPT] = "corrupt",
                                        [GSF_UNKNOWN_BLOCK] = "unknown-block",
                                        [GSF_NO_SPACE] = "no-space",
                                        [GSF_INVALID] = "invalid"};
    return names[result];
}

/* ---- A coded image with memory of its own ---- */

static void allocate_arrays(gsf_coded_image *image) {
    image->splats = allocate(image->header.splat_count, sizeof *image->splats);
    image->indexed = allocate(image->header.splat_count, sizeof *image->indexed);
    image->codebooks.shape_words = allocate(GSF_MAX_CODEBOOK, sizeof *image->codebooks.shape_words);
    image->codebooks.colour_words = allocate(GSF_MAX_CODEBOOK, sizeof *image->codebooks.colour_words);
}

static void free_arrays(gsf_coded_image *image) {
    free(image->splats);
    free(image->indexed);
    free(image->codebooks.shape_words);
    free(image->codebooks.colour_words);
}

/* ---- Files ---- */

static uint8_t *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    if (!file)
        fail("%s: cannot be opened", path);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = allocate(*size, 1);
    if (fread(bytes, 1, *size, file) != *size)
        fail("%s: cannot be read", path);
    fclose(file);
    return bytes;
}

static void write_file(const char *path, const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0)
        fail("%s: cannot be written", path);
}

/* ---- Codes to text ---- */

static const uint8_t BLOCK_TYPES[GSF_BLOCK_COUNT] = {0, 1, 32, 33};

static void print_blocks(const uint8_t *bytes, size_t size) {
    gsf_container container;
    if (gsf_open_container(bytes, size, &container) != GSF_OK)
        fail("the container cannot be read again");
    for (int i = 0; i < GSF_BLOCK_COUNT; i++) {
        if (!container.blocks[i].data)
            continue;
        printf("block %d ", BLOCK_TYPES[i]);
        for (size_t at = 0; at < container.blocks[i].size; at++)
            printf("%02x", container.blocks[i].data[at]);
        puts(container.blocks[i].size == 0 ? "-" : "");
    }
}

static void print_ranges(const gsf_range *ranges, unsigned count) {
    for (unsigned i = 0; i < count; i++)
        printf("range %" PRId32 " %" PRId32 "\n", ranges[i].min, ranges[i].max);
}

static void print_word(const char *name, const uint16_t *word, const bool *used, unsigned dims) {
    fputs(name, stdout);
    for (unsigned i = 0; i < dims; i++)
        if (used[i])
            printf(" %u", word[i]);
    putchar('\n');
}

/* Which of s1, s2 and theta are coded. */
static void used_shape_dims(const gsf_header *header, bool used[GSF_SHAPE_DIMS]) {
    used[0] = true;
    used[1] = header->has_anisotropy;
    used[2] = header->has_rotation;
}

static void print_codebooks(const gsf_coded_image *image) {
    const gsf_codebooks *books = &image->codebooks;
    const unsigned colour_dims = gsf_colour_dims(&image->header);
    const bool all[GSF_MAX_COLOUR_DIMS] = {true, true, true, true, true};
    bool used[GSF_SHAPE_DIMS];
    used_shape_dims(&image->header, used);
    printf("bits %u %u %u\n", books->position_bits, books->shape_bits, books->colour_bits);
    for (unsigned i = 0; i < GSF_SHAPE_DIMS; i++)
        print_ranges(&books->shape[i], used[i]);
    print_ranges(books->colour, colour_dims);
    for (unsigned i = 0; i < books->shape_count; i++)
        print_word("shape", books->shape_words[i], used, GSF_SHAPE_DIMS);
    for (unsigned i = 0; i < books->colour_count; i++)
        print_word("colour", books->colour_words[i], all, colour_dims);
}

static void print_splat(const gsf_splat *s) {
    printf("splat %u %u %u %" PRIu32 " %" PRIu32 " %d %d %d %d %u %u %u %u %u %" PRIu32 "\n", s->major, s->aspect,
           s->angle, s->x, s->y, s->luma, s->co, s->cg, s->alpha, s->opacity, s->texture.amplitude, s->texture.wave,
           s->texture.direction, s->texture.phase, s->layer);
}

static void print_image(const gsf_coded_image *image) {
    const gsf_header *h = &image->header;
    const gsf_steps *s = &image->steps;
    printf("size %" PRIu32 " %" PRIu32 "\n", h->width, h->height);
    printf("kind %d %d %d %d %d %d %d %d %d %d %d\nbackground", h->blend, h->coding, h->layout, h->high_bit_depth,
           h->has_chroma, h->has_alpha, h->has_opacity, h->has_anisotropy, h->has_rotation, h->has_texture,
           h->enhancement_layers + 1);
    for (unsigned i = 0; i < gsf_channel_count(h) && !image->has_mean_background; i++)
        printf(" %u", image->background[i]);
    putchar('\n');
    if (h->coding == GSF_CODING_SCALAR)
        printf("steps %u %u %u %u %u %u %u %u\n", s->scale, s->position, s->angle, s->luma, s->chroma, s->alpha,
               s->opacity, s->pivot);
    else if (h->splat_count > 0)
        print_codebooks(image);
    printf("splats %" PRIu32 "\n", h->splat_count);
    for (uint32_t i = 0; i < h->splat_count; i++) {
        const gsf_indexed_splat *indexed = &image->indexed[i];
        if (h->coding == GSF_CODING_SCALAR)
            print_splat(&image->splats[i]);
        else
            printf("splat %u %u %u %u\n", indexed->shape, indexed->colour, indexed->x, indexed->y);
    }
}

/* Of a list of packets a larger one that has those, too, for which its repair packets make up.  Frees `bytes`. */
static uint8_t *repair(uint8_t *bytes, bool bare, size_t *size) {
    const bool is_list = !bare && gsf_is_packet_list(bytes, *size);
    const size_t room = is_list ? gsf_repair_size(bytes, *size) : 0;
    if (room == 0)
        return bytes;
    size_t end = 0; /* of the packets: what is behind them is none */
    for (gsf_bytes packet; gsf_next_packet(bytes, *size, &end, &packet);)
        continue;
    uint8_t *repaired = allocate(end + room, 1);
    memcpy(repaired, bytes, end);
    *size = end + gsf_repair_list(bytes, *size, repaired + end);
    free(bytes);
    return repaired;
}

static void read_and_print(const char *path, bool bare) {
    size_t size;
    uint8_t *bytes = repair(read_file(path, &size), bare, &size);
    gsf_coded_image image = {.bare = bare};
    gsf_result result = gsf_read_header(bytes, size, bare, &image.header);
    if (result == GSF_OK) {
        allocate_arrays(&image);
        void *scratch = allocate(gsf_scratch_size(&image.header), 1);
        result = gsf_read(bytes, size, &image, scratch);
        free(scratch);
    }
    printf("file %s %s\n", path, result_name(result));
    if (result == GSF_OK && !bare && !gsf_is_packet_list(bytes, size))
        print_blocks(bytes, size);
    if (result == GSF_OK)
        print_image(&image);
    free_arrays(&image);
    free(bytes);
}

/* Reads the first `size` bytes, from memory of that size, so that a sanitizer sees reads beyond them. */
static void print_prefix(const uint8_t *bytes, size_t size, gsf_coded_image image, void *scratch) {
    uint8_t *exact = allocate(size, 1);
    uint32_t total = 0;
    memcpy(exact, bytes, size);
    size_t repaired_size = size;
    exact = repair(exact, image.bare, &repaired_size);
    const gsf_result result = gsf_read_prefix(exact, repaired_size, &image, &total, scratch);
    printf("prefix %zu %s", size, result_name(result));
    if (result == GSF_OK)
        printf(" %" PRIu32 " %" PRIu32, image.header.splat_count, total);
    putchar('\n');
    free(exact);
}

/* The header of the whole file, whose memory is enough for each of its prefixes: of a list of packets with those for which
 * its repair packets make up, because a prefix has them, too. */
static gsf_header whole_header(const char *path, bool bare) {
    size_t size;
    uint8_t *bytes = repair(read_file(path, &size), bare, &size);
    gsf_header header;
    if (gsf_read_header(bytes, size, bare, &header) != GSF_OK)
        fail("%s: not a valid file", path);
    free(bytes);
    return header;
}

static void read_prefixes(const char *path, bool bare) {
    size_t size;
    uint8_t *bytes = read_file(path, &size);
    gsf_coded_image image = {.header = whole_header(path, bare), .bare = bare};
    allocate_arrays(&image);
    void *scratch = allocate(gsf_scratch_size(&image.header), 1);
    printf("file %s\n", path);
    for (size_t i = 0; i <= size; i++) {
        gsf_coded_image cut = image;
        cut.header = (gsf_header){.width = 0};
        print_prefix(bytes, i, cut, scratch);
    }
    free(scratch);
    free_arrays(&image);
    free(bytes);
}

/* ---- Text to codes ---- */

typedef struct text {
    gsf_coded_image image;
    gsf_bytes blocks[GSF_BLOCK_COUNT];
    unsigned ranges; /* read so far */
    uint32_t splats;
} text;

static void parse_block(text *t, const char *line) {
    unsigned type;
    char *hex = allocate(MAX_LINE, 1);
    if (sscanf(line, "block %u %s", &type, hex) != 2)
        fail("%s: not a block", line);
    const size_t size = strcmp(hex, "-") == 0 ? 0 : strlen(hex) / 2;
    uint8_t *data = allocate(size, 1);
    for (size_t i = 0; i < size; i++) {
        unsigned byte;
        sscanf(hex + 2 * i, "%2x", &byte);
        data[i] = (uint8_t)byte;
    }
    for (int i = 0; i < GSF_BLOCK_COUNT; i++)
        if (BLOCK_TYPES[i] == type)
            t->blocks[i] = (gsf_bytes){data, size};
    t->image.blocks = t->blocks;
    free(hex);
}

static void set_kind(gsf_header *h, const int *v) {
    h->blend = (gsf_blend)v[0];
    h->coding = (gsf_coding)v[1];
    h->layout = (gsf_layout)v[2];
    h->high_bit_depth = v[3];
    h->has_chroma = v[4];
    h->has_alpha = v[5];
    h->has_opacity = v[6];
    h->has_anisotropy = v[7];
    h->has_rotation = v[8];
    h->has_texture = v[9];
    h->enhancement_layers = (uint8_t)(v[10] - 1);
}

static gsf_steps steps_of(const int *v) {
    return (gsf_steps){(uint8_t)v[0], (uint8_t)v[1], (uint8_t)v[2], (uint8_t)v[3],
                       (uint8_t)v[4], (uint8_t)v[5], (uint8_t)v[6], (uint8_t)v[7]};
}

/* The ranges stand in the order of the dimensions that are used: first those of shapes. */
static void add_range(text *t, const int *v) {
    bool used[GSF_SHAPE_DIMS];
    unsigned shape_dims = 0, places[GSF_SHAPE_DIMS];
    used_shape_dims(&t->image.header, used);
    for (unsigned i = 0; i < GSF_SHAPE_DIMS; i++)
        if (used[i])
            places[shape_dims++] = i;
    const gsf_range range = {v[0], v[1]};
    if (t->ranges < shape_dims)
        t->image.codebooks.shape[places[t->ranges]] = range;
    else
        t->image.codebooks.colour[t->ranges - shape_dims] = range;
    t->ranges++;
}

static void add_shape(text *t, const int *v) {
    gsf_codebooks *books = &t->image.codebooks;
    bool used[GSF_SHAPE_DIMS];
    used_shape_dims(&t->image.header, used);
    for (unsigned i = 0; i < GSF_SHAPE_DIMS; i++)
        books->shape_words[books->shape_count][i] = used[i] ? (uint16_t)*v++ : 0;
    books->shape_count++;
}

static void add_colour(text *t, const int *v) {
    gsf_codebooks *books = &t->image.codebooks;
    for (unsigned i = 0; i < gsf_colour_dims(&t->image.header); i++)
        books->colour_words[books->colour_count][i] = (uint16_t)v[i];
    books->colour_count++;
}

static void add_splat(text *t, const int *v) {
    if (t->splats == t->image.header.splat_count)
        fail("there are too many splats");
    if (t->image.header.coding == GSF_CODING_SCALAR)
        t->image.splats[t->splats] = (gsf_splat){.major = (uint16_t)v[0],
                                                 .aspect = (uint16_t)v[1],
                                                 .angle = (uint16_t)v[2],
                                                 .x = (uint32_t)v[3],
                                                 .y = (uint32_t)v[4],
                                                 .luma = (int16_t)v[5],
                                                 .co = (int16_t)v[6],
                                                 .cg = (int16_t)v[7],
                                                 .alpha = (int16_t)v[8],
                                                 .opacity = (uint16_t)v[9],
                                                 .texture = {.amplitude = (uint8_t)v[10],
                                                             .wave = (uint8_t)v[11],
                                                             .direction = (uint8_t)v[12],
                                                             .phase = (uint8_t)v[13]},
                                                 .layer = (uint32_t)v[14]};
    else
        t->image.indexed[t->splats] =
            (gsf_indexed_splat){(uint16_t)v[0], (uint16_t)v[1], (uint16_t)v[2], (uint16_t)v[3]};
    t->splats++;
}

static void set_sizes(gsf_coded_image *image, const char *word, const int *v) {
    if (strcmp(word, "size") == 0) {
        image->header.width = (uint32_t)v[0];
        image->header.height = (uint32_t)v[1];
    } else if (strcmp(word, "bits") == 0) {
        image->codebooks.position_bits = (uint8_t)v[0];
        image->codebooks.shape_bits = (uint8_t)v[1];
        image->codebooks.colour_bits = (uint8_t)v[2];
    } else {
        fail("%s: not known", word);
    }
}

static void set_background(gsf_coded_image *image, const int *v, int count) {
    image->has_mean_background = count == 0;
    for (int i = 0; i < GSF_MAX_CHANNELS; i++)
        image->background[i] = (uint16_t)v[i];
}

/* The line with the number of splats comes before the words of codebooks, so that there is memory for them. */
static void parse_numbers(text *t, const char *word, const int *v, int count) {
    if (strcmp(word, "kind") == 0)
        set_kind(&t->image.header, v);
    else if (strcmp(word, "background") == 0)
        set_background(&t->image, v, count);
    else if (strcmp(word, "steps") == 0)
        t->image.steps = steps_of(v);
    else if (strcmp(word, "range") == 0)
        add_range(t, v);
    else if (strcmp(word, "shape") == 0)
        add_shape(t, v);
    else if (strcmp(word, "colour") == 0)
        add_colour(t, v);
    else if (strcmp(word, "splat") == 0)
        add_splat(t, v);
    else
        set_sizes(&t->image, word, v);
}

static void parse_line(text *t, const char *line) {
    char word[20];
    int v[MAX_NUMBERS] = {0}, count = 0, at = 0, used = 0;
    if (sscanf(line, "%19s%n", word, &at) != 1 || strcmp(word, "splats") == 0)
        return;
    if (strcmp(word, "block") == 0) {
        parse_block(t, line);
        return;
    }
    for (; count < MAX_NUMBERS && sscanf(line + at, "%d%n", &v[count], &used) == 1; count++)
        at += used;
    parse_numbers(t, word, v, count);
}

/* The number of splats is needed first, for the memory. */
static void parse_file(text *t, const char *path) {
    static char line[MAX_LINE];
    FILE *file = fopen(path, "r");
    if (!file)
        fail("%s: cannot be opened", path);
    while (fgets(line, sizeof line, file))
        sscanf(line, "splats %" SCNu32, &t->image.header.splat_count);
    rewind(file);
    allocate_arrays(&t->image);
    while (fgets(line, sizeof line, file))
        parse_line(t, line);
    fclose(file);
    if (t->splats != t->image.header.splat_count)
        fail("%s: %" PRIu32 " splats are missing", path, t->image.header.splat_count - t->splats);
}

/* Writes a bare file whose work may be above the limit. */
static size_t write_unchecked(gsf_coded_image *image, uint8_t *bytes, size_t capacity, void *scratch) {
    gsf_coder coder;
    gsf_sort(image, scratch);
    gsf_coder_write_to(&coder, bytes, capacity, NULL);
    gsf_code_header(&coder, image);
    if (gsf_code_payload(&coder, image, gsf_workspace_in(&image->header, scratch)))
        fail("the file keeps all limits");
    gsf_range_encoder_finish(&coder.encoder);
    return coder.encoder.size;
}

static void write_codes(const char *text_path, const char *path, bool bare, bool unchecked) {
    text t = {.splats = 0};
    size_t size = 0;
    t.image.bare = bare || unchecked;
    parse_file(&t, text_path);
    const size_t capacity = gsf_write_bound(&t.image);
    uint8_t *bytes = allocate(capacity, 1);
    void *scratch = allocate(gsf_scratch_size(&t.image.header), 1);
    if (unchecked)
        size = write_unchecked(&t.image, bytes, capacity, scratch);
    else if (gsf_write(&t.image, bytes, capacity, &size, scratch) != GSF_OK)
        fail("%s: not a valid image", text_path);
    write_file(path, bytes, size);
    free(scratch);
    free(bytes);
    free_arrays(&t.image);
    for (int i = 0; i < GSF_BLOCK_COUNT; i++)
        free((void *)t.blocks[i].data);
}

/* ---- Packets ---- */

/* Whether packet k gets a splat.  Those of one that several may have take turns. */
static bool takes_splat(const gsf_coded_image *image, uint32_t splat, uint32_t count, uint32_t k, bool everywhere) {
    if (!gsf_packet_may_hold(image, splat, count, k))
        return false;
    for (uint32_t turn = 0; !everywhere && turn < count; turn++) {
        const uint32_t first = (splat + turn) % count;
        if (gsf_packet_may_hold(image, splat, count, first))
            return first == k;
    }
    return true;
}

/* Puts a packet into memory of its own. */
static gsf_bytes make_packet(const gsf_coded_image *image, uint32_t count, uint32_t k, bool everywhere) {
    gsf_coded_image part = *image;
    size_t size;
    part.splats = allocate(image->header.splat_count, sizeof *part.splats);
    part.header.packets = (uint16_t)count;
    part.header.packet = (uint8_t)k;
    part.header.splat_count = 0;
    for (uint32_t i = 0; i < image->header.splat_count; i++)
        if (takes_splat(image, i, count, k, everywhere))
            part.splats[part.header.splat_count++] = image->splats[i];
    const size_t capacity = gsf_write_bound(&part);
    uint8_t *bytes = allocate(capacity, 1);
    void *scratch = allocate(gsf_scratch_size(&part.header), 1);
    if (gsf_write(&part, bytes, capacity, &size, scratch) != GSF_OK)
        fail("packet %" PRIu32 " of %" PRIu32 " cannot be written", k, count);
    free(scratch);
    free(part.splats);
    return (gsf_bytes){bytes, size};
}

static gsf_bytes make_repair(const gsf_bytes *packets, uint32_t count, uint32_t number) {
    size_t longest = 0;
    for (uint32_t i = 0; i < count; i++)
        longest = packets[i].size > longest ? packets[i].size : longest;
    const size_t size = longest - 1 + GSF_REPAIR_FRAME;
    uint8_t *bytes = allocate(size, 1);
    gsf_write_repair(packets, count, longest, number, bytes);
    return (gsf_bytes){bytes, size};
}

static void write_packet_list(const char *path, const gsf_bytes *packets, uint32_t count) {
    FILE *file = fopen(path, "wb");
    uint8_t start[GSF_PACKET_LIST_START], field[4];
    gsf_put_packet_list_start(start);
    bool written = file && fwrite(start, 1, sizeof start, file) == sizeof start;
    for (uint32_t i = 0; i < count && written; i++) {
        const size_t field_size = gsf_packet_size_field(packets[i].size);
        gsf_put_packet_size(field, packets[i].size);
        written = fwrite(field, 1, field_size, file) == field_size &&
                  fwrite(packets[i].data, 1, packets[i].size, file) == packets[i].size;
    }
    if (!written || fclose(file) != 0)
        fail("%s: cannot be written", path);
}

static void write_packets(const char *text_path, const char *path, const char *const *numbers, bool everywhere) {
    text t = {.splats = 0};
    gsf_bytes packets[GSF_MAX_PACKETS];
    const uint32_t count = (uint32_t)atoi(numbers[1]), all = count + (uint32_t)atoi(numbers[2]);
    parse_file(&t, text_path);
    t.image.identity = (uint8_t)atoi(numbers[0]);
    for (uint32_t i = 0; i < all; i++)
        packets[i] = i < count ? make_packet(&t.image, count, i, everywhere) : make_repair(packets, count, i);
    write_packet_list(path, packets, all);
    for (uint32_t i = 0; i < all; i++)
        free((void *)packets[i].data);
    free_arrays(&t.image);
}

/* ---- Decoding ---- */

static gsf_result format_result(gscl_context *context, gscl_result result, const char *path) {
    switch (result) {
    case GSCL_OK:
        return GSF_OK;
    case GSCL_ERROR_NOT_GSCL:
        return GSF_NOT_GSCL;
    case GSCL_ERROR_NEWER_VERSION:
        return GSF_NEWER_VERSION;
    case GSCL_ERROR_TRUNCATED:
        return GSF_TRUNCATED;
    case GSCL_ERROR_DAMAGED:
        return GSF_DAMAGED;
    case GSCL_ERROR_CORRUPT:
        return GSF_CORRUPT;
    case GSCL_ERROR_UNKNOWN_BLOCK:
        return GSF_UNKNOWN_BLOCK;
    default:
        fail("%s: %s", path, gscl_context_message(context));
        return GSF_INVALID;
    }
}

/* Puts the low byte of each sample first. */
static void order_bytes(uint16_t *samples, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const uint8_t bytes[2] = {(uint8_t)samples[i], (uint8_t)(samples[i] >> 8)};
        memcpy(&samples[i], bytes, sizeof bytes);
    }
}

static void write_samples(const char *path, const gscl_image *image) {
    const size_t count = (size_t)image->width * image->height * image->channels;
    const bool wide = image->sample == GSCL_SAMPLE_U16;
    if (wide)
        order_bytes(image->pixels, count);
    write_file(path, image->pixels, count * (wide ? 2 : 1));
}

static void decode_file(gscl_context *context, const char *path, bool bare, const char *folder, int number) {
    size_t size;
    uint8_t *bytes = read_file(path, &size);
    gscl_image image = {0};
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.bare = bare;
    const gscl_result result = gscl_decode(context, bytes, size, &settings, &image);
    printf("file %s %s", path, result_name(format_result(context, result, path)));
    if (result == GSCL_OK) {
        char out[1000];
        snprintf(out, sizeof out, "%s/%d.raw", folder, number);
        write_samples(out, &image);
        printf(" %u %u %u %u", (unsigned)image.width, (unsigned)image.height, (unsigned)image.channels,
               image.sample == GSCL_SAMPLE_U8 ? 8u : 16u);
    }
    putchar('\n');
    gscl_free(image.pixels);
    free(bytes);
}

/* Sets device and mapping by a word: `decode-host`, or `decode-cpu` or `decode-gpu` of the first OpenCL device. */
static gscl_context_settings decode_settings(const char *word) {
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    const bool is_host = strcmp(word, "decode-host") == 0;
    settings.device = is_host ? GSCL_HOST_DEVICE : first_opencl_device();
    if (strcmp(word, "decode-cpu") == 0)
        settings.mapping = GSCL_MAPPING_CPU;
    else if (strcmp(word, "decode-gpu") == 0)
        settings.mapping = GSCL_MAPPING_GPU;
    else if (!is_host)
        fail("%s: not known", word);
    return settings;
}

static void decode_files(const char *word, bool bare, const char *folder, char **paths, int count) {
    gscl_context *context;
    const gscl_context_settings settings = decode_settings(word);
    if (gscl_context_create(&context, &settings) != GSCL_OK)
        fail("%s", gscl_context_message(context));
    for (int i = 0; i < count; i++)
        decode_file(context, paths[i], bare, folder, i);
    gscl_context_free(&context);
}

static void print_pixel(gscl_context *context, const uint8_t *bytes, size_t size,
                        const gscl_decode_settings *settings) {
    gscl_image image = {0};
    if (gscl_decode(context, bytes, size, settings, &image) != GSCL_OK)
        fail("%s", gscl_context_message(context));
    const bool wide = image.sample == GSCL_SAMPLE_U16;
    printf("%d", wide ? 16 : 8);
    for (uint32_t k = 0; k < image.channels; k++)
        printf(" %u", wide ? (unsigned)((const uint16_t *)image.pixels)[k] : ((const uint8_t *)image.pixels)[k]);
    putchar('\n');
    gscl_free(image.pixels);
}

static void print_pixels(bool bare, const char *path, char **places, int count) {
    size_t size;
    uint8_t *bytes = read_file(path, &size);
    gscl_context *context;
    const gscl_context_settings device = decode_settings("decode-host");
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.bare = bare;
    settings.crop_width = settings.crop_height = 1;
    if (gscl_context_create(&context, &device) != GSCL_OK)
        fail("%s", gscl_context_message(context));
    for (int i = 0; i + 1 < count; i += 2) {
        settings.crop_x = (uint32_t)strtoul(places[i], NULL, 10);
        settings.crop_y = (uint32_t)strtoul(places[i + 1], NULL, 10);
        print_pixel(context, bytes, size, &settings);
    }
    gscl_context_free(&context);
    free(bytes);
}

static void print_decoders(void) {
    puts("decode-host");
    if (has_opencl())
        puts("decode-cpu\ndecode-gpu");
}

static bool has_word(char **words, int count, const char *word) {
    bool found = false;
    for (int i = 0; i < count; i++)
        found = found || strcmp(words[i], word) == 0;
    return found;
}

int main(int count, char **words) {
    if (count == 2 && strcmp(words[1], "decoders") == 0) {
        print_decoders();
        return 0;
    }
    if (count < 4)
        fail("codes write TEXT OUT [bare] [unchecked], codes packets TEXT OUT IDENTITY COUNT REPAIRS [everywhere], "
             "codes read whole|bare FILE..., codes prefixes whole|bare "
             "FILE..., codes decode-host whole|bare FOLDER FILE..., codes pixels whole|bare FILE X Y... or codes "
             "decoders");
    const bool bare = strcmp(words[2], "bare") == 0;
    if (strcmp(words[1], "write") == 0)
        write_codes(words[2], words[3], has_word(words + 4, count - 4, "bare"),
                    has_word(words + 4, count - 4, "unchecked"));
    else if (strcmp(words[1], "packets") == 0 && count >= 7)
        write_packets(words[2], words[3], (const char *const *)words + 4, has_word(words + 7, count - 7, "everywhere"));
    else if (strcmp(words[1], "read") == 0)
        for (int i = 3; i < count; i++)
            read_and_print(words[i], bare);
    else if (strcmp(words[1], "prefixes") == 0)
        for (int i = 3; i < count; i++)
            read_prefixes(words[i], bare);
    else if (strcmp(words[1], "pixels") == 0)
        print_pixels(bare, words[3], words + 4, count - 4);
    else
        decode_files(words[1], bare, words[3], words + 4, count - 4);
    return 0;
}
