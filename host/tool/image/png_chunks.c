#include "image/png_chunks.h"

#include <string.h>

#include <zlib.h>

#include "image/exif.h"

const uint8_t png_metadata_chunks[] = "cICP\0iCCP\0sRGB\0gAMA\0cHRM\0eXIf";

#define SIGNATURE_SIZE 8
#define CHUNK_OVERHEAD 12 /* length, name, checksum */
#define UNIT 100000.0     /* of the integers of gAMA and cHRM */
#define SRGB_GAMMA 45455  /* of gAMA: 1 / 2.2, by which encoders approximate the curve of sRGB */

static const char xmp_keyword[] = "XML:com.adobe.xmp";
/* Keywords of EXIF or XMP as digits, from before PNG had a chunk for EXIF; several programs still write them. */
static const char *const raw_keywords[] = {"Raw profile type exif", "Raw profile type APP1", "Raw profile type xmp"};
static const char app1_xmp[] = "http://ns.adobe.com/xap/1.0/"; /* before XMP in APP1; its NUL belongs to it */

/* What the chunks about colours say, before one of them is chosen. */
typedef struct png_colours {
    bool srgb;
    uint32_t gamma; /* 0: none */
} png_colours;

/* Metadata in texts, which that in chunks of its own precedes. */
typedef struct png_texts {
    image_blob exif, xmp;
} png_texts;

typedef struct png_chunk {
    const uint8_t *name, *bytes;
    size_t size;
    bool intact; /* the checksum matches */
} png_chunk;

static uint32_t big_endian(const uint8_t *b) {
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static bool is_named(const png_chunk *chunk, const char *name) {
    return memcmp(chunk->name, name, 4) == 0;
}

/* Unpacks a zlib stream.  Returns false if it is damaged or too long. */
static bool unpack(const uint8_t *bytes, size_t size, image_blob *blob) {
    uint8_t part[16384];
    z_stream stream = {.next_in = (Bytef *)(uintptr_t)bytes, .avail_in = (uInt)size};
    int status = inflateInit(&stream);
    bool ok = status == Z_OK;
    while (ok && status != Z_STREAM_END) {
        stream.next_out = part;
        stream.avail_out = sizeof part;
        status = inflate(&stream, Z_NO_FLUSH);
        ok =
            (status == Z_OK || status == Z_STREAM_END) && image_blob_append(blob, part, sizeof part - stream.avail_out);
    }
    inflateEnd(&stream);
    if (!ok)
        image_blob_free(blob);
    return ok;
}

/* ---- Single chunks ----------------------------------------------------------------------------- */

/* Primaries, transfer characteristics, matrix coefficients (0), full range (1). */
static void take_cicp(const png_chunk *chunk, image_content *content) {
    image_metadata *metadata = &content->metadata;
    metadata->has_cicp = chunk->intact && chunk->size == 4 && chunk->bytes[2] == 0 && chunk->bytes[3] == 1;
    if (metadata->has_cicp)
        memcpy(metadata->cicp, chunk->bytes, sizeof metadata->cicp);
    else
        content->damaged_profile = true;
}

/* Name, zero, method of compression (0), zlib stream. */
static void take_icc(const png_chunk *chunk, image_content *content) {
    const uint8_t *end = memchr(chunk->bytes, 0, chunk->size);
    const size_t name = end ? (size_t)(end - chunk->bytes) : chunk->size;
    if (content->metadata.icc.size)
        return;
    if (!chunk->intact || name + 2 > chunk->size || chunk->bytes[name + 1] != 0 ||
        !unpack(chunk->bytes + name + 2, chunk->size - name - 2, &content->metadata.icc))
        content->damaged_profile = true;
}

static void take_primaries(const png_chunk *chunk, image_content *content) {
    if (!chunk->intact || chunk->size != 32)
        return;
    content->has_primaries = true;
    for (int i = 0; i < 8; i++)
        content->primaries[i] = big_endian(chunk->bytes + 4 * i) / UNIT;
}

/* The text of an iTXt chunk with a keyword: compressed or not, method, language, zero, translated keyword, zero, text. */
static bool take_text(const png_chunk *chunk, const char *keyword, size_t keyword_size, image_blob *text) {
    if (!chunk->intact || chunk->size < keyword_size + 2 || memcmp(chunk->bytes, keyword, keyword_size) != 0)
        return false;
    const uint8_t *at = chunk->bytes + keyword_size + 2, *end = chunk->bytes + chunk->size;
    const bool packed = at[-2] != 0;
    for (int zeros = 0; zeros < 2; zeros++) {
        at = memchr(at, 0, (size_t)(end - at));
        if (!at)
            return false;
        at++;
    }
    return packed ? unpack(at, (size_t)(end - at), text) : image_blob_set(text, at, (size_t)(end - at));
}

/* The text of a tEXt or zTXt chunk with a keyword: zero, in the second method of compression (0), text. */
static bool take_plain_text(const png_chunk *chunk, const char *keyword, image_blob *text) {
    const size_t head = strlen(keyword) + 1, packed_head = head + 1;
    if (!chunk->intact || chunk->size < packed_head || memcmp(chunk->bytes, keyword, head) != 0)
        return false;
    if (is_named(chunk, "tEXt"))
        return image_blob_set(text, chunk->bytes + head, chunk->size - head);
    return is_named(chunk, "zTXt") && chunk->bytes[head] == 0 &&
           unpack(chunk->bytes + packed_head, chunk->size - packed_head, text);
}

static int digit_value(uint8_t c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* Replaces a text of four lines (empty, a name, the number of bytes, digits in several lines) by the bytes.  Returns false
 * if it is not one. */
static bool undo_digits(image_blob *text) {
    size_t at = 0, size = 0;
    int high = -1;
    for (int lines = 0; lines < 3; at++) {
        if (at == text->size)
            return false;
        lines += text->bytes[at] == '\n';
    }
    for (; at < text->size; at++) {
        const int value = digit_value(text->bytes[at]);
        if (value < 0 && text->bytes[at] != '\n')
            return false;
        if (value >= 0 && high >= 0)
            text->bytes[size++] = (uint8_t)(high << 4 | value);
        if (value >= 0)
            high = high >= 0 ? -1 : value;
    }
    text->size = size;
    return size > 0 && high < 0;
}

/* Moves bytes to where they belong: EXIF, or XMP with the prefix that it has in a JPEG. */
static void sort_raw_profile(image_blob *bytes, bool is_xmp, png_texts *texts) {
    const bool is_app1_xmp = bytes->size > sizeof app1_xmp && memcmp(bytes->bytes, app1_xmp, sizeof app1_xmp) == 0;
    if (is_app1_xmp)
        image_blob_set(&texts->xmp, bytes->bytes + sizeof app1_xmp, bytes->size - sizeof app1_xmp);
    else
        image_blob_set(is_xmp ? &texts->xmp : &texts->exif, bytes->bytes, bytes->size);
}

static bool take_raw_profile(const png_chunk *chunk, png_texts *texts) {
    for (size_t i = 0; i < sizeof raw_keywords / sizeof *raw_keywords; i++) {
        image_blob text = {0};
        const bool ok = take_plain_text(chunk, raw_keywords[i], &text) && undo_digits(&text);
        if (ok)
            sort_raw_profile(&text, i == 2, texts);
        image_blob_free(&text);
        if (ok)
            return true;
    }
    return false;
}

/* Uses what stands in texts where no chunk has it. */
static void settle_texts(image_metadata *metadata, png_texts *texts) {
    if (!metadata->exif.size) {
        metadata->exif = texts->exif;
        texts->exif = (image_blob){0};
    }
    if (!metadata->xmp.size) {
        metadata->xmp = texts->xmp;
        texts->xmp = (image_blob){0};
    }
    image_blob_free(&texts->exif);
    image_blob_free(&texts->xmp);
}

/* ---- All chunks -------------------------------------------------------------------------------- */

static void take_chunk(const png_chunk *chunk, image_content *content, png_colours *colours, png_texts *texts) {
    image_metadata *metadata = &content->metadata;
    if (is_named(chunk, "cICP"))
        take_cicp(chunk, content);
    else if (is_named(chunk, "iCCP"))
        take_icc(chunk, content);
    else if (is_named(chunk, "acTL") && chunk->intact && chunk->size == 8) /* number of frames, of repetitions */
        content->has_more_images = big_endian(chunk->bytes) > 1;
    else if (is_named(chunk, "sRGB"))
        colours->srgb = chunk->intact;
    else if (is_named(chunk, "gAMA") && chunk->intact && chunk->size == 4)
        colours->gamma = big_endian(chunk->bytes);
    else if (is_named(chunk, "cHRM"))
        take_primaries(chunk, content);
    else if (is_named(chunk, "eXIf") && chunk->intact)
        image_blob_set(&metadata->exif, chunk->bytes, chunk->size);
    else if ((is_named(chunk, "iTXt") && take_text(chunk, xmp_keyword, sizeof xmp_keyword, &metadata->xmp)) ||
             take_raw_profile(chunk, texts))
        return;
    else if (is_named(chunk, "tEXt") || is_named(chunk, "zTXt") || is_named(chunk, "iTXt"))
        content->other_bytes += chunk->size;
}

/* cICP precedes iCCP, which precedes sRGB, which precedes gAMA and cHRM. */
static void choose_colours(image_content *content, const png_colours *colours) {
    image_metadata *metadata = &content->metadata;
    if (metadata->has_cicp)
        image_blob_free(&metadata->icc);
    if (metadata->has_cicp || metadata->icc.size)
        content->damaged_profile = false;
    if (metadata->has_cicp || metadata->icc.size || colours->srgb)
        content->has_primaries = false;
    else if (colours->gamma && colours->gamma != SRGB_GAMMA)
        content->gamma = UNIT / colours->gamma;
}

bool png_chunks_fit(const uint8_t *bytes, size_t size) {
    size_t at = SIGNATURE_SIZE;
    while (at < size && size - at >= CHUNK_OVERHEAD && memcmp(bytes + at + 4, "IEND", 4) != 0) {
        const uint32_t length = big_endian(bytes + at);
        if (length > size - at - CHUNK_OVERHEAD)
            return false;
        at += CHUNK_OVERHEAD + (size_t)length;
    }
    return true;
}

void png_take_metadata(const uint8_t *bytes, size_t size, image_content *content) {
    png_colours colours = {0};
    png_texts texts = {0};
    size_t at = SIGNATURE_SIZE;
    while (at < size && size - at >= CHUNK_OVERHEAD) {
        const uint32_t length = big_endian(bytes + at);
        if (length > size - at - CHUNK_OVERHEAD)
            break;
        const png_chunk chunk = {.name = bytes + at + 4, .bytes = bytes + at + 8, .size = length};
        png_chunk checked = chunk;
        if (!is_named(&chunk, "IDAT"))
            checked.intact = crc32(0, chunk.name, (uInt)(length + 4)) == big_endian(chunk.bytes + length);
        take_chunk(&checked, content, &colours, &texts);
        at += CHUNK_OVERHEAD + (size_t)length;
    }
    settle_texts(&content->metadata, &texts);
    exif_trim(&content->metadata.exif);
    choose_colours(content, &colours);
}
