#include "image/image_variant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Numbers of a header.  Those beyond its end are 0. */
typedef struct header {
    const uint8_t *bytes;
    size_t size;
} header;

static unsigned get8(const header *h, size_t at) {
    return at < h->size ? h->bytes[at] : 0;
}

static unsigned get16(const header *h, size_t at) { /* the least significant byte first */
    return get8(h, at) | get8(h, at + 1) << 8;
}

static uint32_t get32(const header *h, size_t at) {
    return get16(h, at) | (uint32_t)get16(h, at + 2) << 16;
}

static unsigned get16_big(const header *h, size_t at) { /* the most significant byte first */
    return get8(h, at) << 8 | get8(h, at + 1);
}

/* Sets the message, a phrase that follows "is a FORMAT file". */
static bool refuse(char *message, const char *format, const char *phrase) {
    snprintf(message, IMAGE_MESSAGE_SIZE, "is a %s file %s; convert it to PNG first", format, phrase);
    return false;
}

/* ---- BMP --------------------------------------------------------------------------------------- */

enum { BMP_RGB = 0, BMP_BITFIELDS = 3, BMP_ALPHA_BITFIELDS = 6 };
enum { BMP_INFO_SIZE = 40, BMP_V2_SIZE = 52, BMP_V3_SIZE = 56, BMP_OS2_SIZE = 64, BMP_V5_SIZE = 124 };
#define BMP_DIB 14 /* offset of the second header, which begins with its size */
#define BMP_EMBEDDED_PROFILE 0x4D424544u

static bool are_bgrx(const uint32_t masks[4]) {
    return masks[0] == 0xFF0000u && masks[1] == 0xFF00u && masks[2] == 0xFFu &&
           (masks[3] == 0 || masks[3] == 0xFF000000u);
}

static bool are_565_or_555(const uint32_t masks[4]) {
    return masks[2] == 0x1F && masks[3] == 0 &&
           ((masks[0] == 0xF800 && masks[1] == 0x7E0) || (masks[0] == 0x7C00 && masks[1] == 0x3E0));
}

static void take_bmp_profile(const header *h, uint32_t dib_size, image_content *content) {
    if (dib_size < BMP_V5_SIZE || get32(h, BMP_DIB + 56) != BMP_EMBEDDED_PROFILE)
        return;
    const uint64_t at = BMP_DIB + (uint64_t)get32(h, BMP_DIB + 112), size = get32(h, BMP_DIB + 116);
    content->damaged_profile = size == 0 || at > h->size || size > h->size - at ||
                               !image_blob_set(&content->metadata.icc, h->bytes + at, (size_t)size);
}

static bool check_bmp(const header *h, image_content *content, char *message) {
    const uint32_t dib_size = get32(h, BMP_DIB);
    if (dib_size < BMP_INFO_SIZE) /* of OS/2: palettes and 24 bits */
        return true;
    const unsigned bits = get16(h, BMP_DIB + 14);
    const uint32_t compression = get32(h, BMP_DIB + 16);
    const bool has_masks = compression == BMP_BITFIELDS || compression == BMP_ALPHA_BITFIELDS;
    uint32_t masks[4];
    for (size_t i = 0; i < 4; i++)
        masks[i] = get32(h, BMP_DIB + BMP_INFO_SIZE + 4 * i);
    if (dib_size < BMP_V3_SIZE && compression != BMP_ALPHA_BITFIELDS)
        masks[3] = 0;
    if (compression != BMP_RGB && (!has_masks || dib_size == BMP_OS2_SIZE))
        return refuse(message, "BMP", "of packed pixels");
    if (has_masks && !(bits == 16 ? are_565_or_555(masks) : are_bgrx(masks)))
        return refuse(message, "BMP", "with unusual places of its colours in a pixel");
    content->alpha = has_masks && masks[3] ? IMAGE_ALPHA_STRAIGHT : IMAGE_ALPHA_UNUSED;
    take_bmp_profile(h, dib_size, content);
    return true;
}

/* ---- TGA --------------------------------------------------------------------------------------- */

/* Types of alpha in the area of extensions of version 2. */
enum { TGA_STRAIGHT = 3, TGA_PREMULTIPLIED = 4 };
#define TGA_FOOTER_SIZE 26
#define TGA_ALPHA_TYPE 494 /* offset in the area of extensions */

/* The type of alpha; -1 if the file does not say. */
static int tga_alpha_type(const header *h) {
    static const char signature[] = "TRUEVISION-XFILE.";
    if (h->size < TGA_FOOTER_SIZE || memcmp(h->bytes + h->size - sizeof signature, signature, sizeof signature) != 0)
        return -1;
    const uint32_t extensions = get32(h, h->size - TGA_FOOTER_SIZE);
    return extensions && (uint64_t)extensions + TGA_ALPHA_TYPE < h->size ? (int)get8(h, extensions + TGA_ALPHA_TYPE)
                                                                         : -1;
}

static bool check_tga(const header *h, image_content *content, char *message) {
    const unsigned kind = get8(h, 2) & 7, bits = get8(h, 16), attribute_bits = get8(h, 17) & 15;
    const int alpha_type = tga_alpha_type(h);
    if (kind == 1 && (get16(h, 3) != 0 || get8(h, 7) == 32))
        return refuse(message, "TGA", get16(h, 3) ? "whose palette does not begin at 0" : "whose palette has alpha");
    if (bits == 16 && kind != 1 && attribute_bits > 0)
        return refuse(message, "TGA", "of 16 bits with alpha");
    if (alpha_type >= 0 && alpha_type != TGA_STRAIGHT && alpha_type != TGA_PREMULTIPLIED)
        content->alpha = IMAGE_ALPHA_UNUSED;
    else if (alpha_type < 0 && attribute_bits == 0) /* programs write alpha, too, without saying so */
        content->alpha = IMAGE_ALPHA_UNUSED_IF_CLEAR;
    else
        content->alpha = alpha_type == TGA_PREMULTIPLIED ? IMAGE_ALPHA_PREMULTIPLIED : IMAGE_ALPHA_STRAIGHT;
    return true;
}

/* ---- DDS --------------------------------------------------------------------------------------- */

enum { DDS_ALPHA_PIXELS = 0x1, DDS_FOURCC = 0x4, DDS_RGB = 0x40 };
enum { DDS_CUBE = 0x200, DDS_VOLUME = 0x200000 };

static bool check_dds(const header *h, image_content *content, char *message) {
    static const char codes[][5] = {"DXT1", "DXT2", "DXT3", "DXT4", "DXT5"};
    const uint32_t flags = get32(h, 80);
    if (get32(h, 112) & (DDS_CUBE | DDS_VOLUME))
        return refuse(message, "DDS", "that holds a cube or a volume");
    content->alpha = flags & DDS_FOURCC || flags & DDS_ALPHA_PIXELS ? IMAGE_ALPHA_STRAIGHT : IMAGE_ALPHA_UNUSED;
    if (flags & DDS_FOURCC) {
        for (size_t i = 0; h->size >= 88 && i < sizeof codes / sizeof *codes; i++) {
            if (memcmp(h->bytes + 84, codes[i], 4) == 0)
                return true;
        }
        return refuse(message, "DDS", "of another compression than DXT1 to DXT5");
    }
    if (!(flags & DDS_RGB) && (flags & DDS_ALPHA_PIXELS))
        return refuse(message, "DDS", "of grey and alpha");
    return true;
}

/* ---- PSD --------------------------------------------------------------------------------------- */

static bool check_psd(const header *h, image_content *content, char *message) {
    enum { PSD_BITMAP = 0, PSD_GREY = 1, PSD_RGB = 3 };
    const unsigned depth = get16_big(h, 22), mode = get16_big(h, 24);
    content->alpha = IMAGE_ALPHA_REFUSED; /* its removal of the white behind it overflows */
    if (mode != PSD_BITMAP && mode != PSD_GREY && mode != PSD_RGB)
        return refuse(message, "PSD", "whose mode is neither RGB nor grey");
    return depth <= 16 || refuse(message, "PSD", "of 32 bits a channel");
}

/* ---- Others ------------------------------------------------------------------------------------ */

static bool check_sgi(const header *h, image_content *content, char *message) {
    const bool has_map = get16_big(h, 104) || get16_big(h, 106);
    content->alpha = IMAGE_ALPHA_STRAIGHT;
    return !has_map || refuse(message, "SGI", "with a map of colours");
}

/* Animations whose first frame is smaller than the canvas. */
static bool check_webp(const header *h, char *message) {
    enum { ANIMATION = 0x02, VP8X = 12, ANMF = 16 };
    if (h->size < 30 || memcmp(h->bytes + VP8X, "VP8X", 4) != 0 || !(get8(h, 20) & ANIMATION))
        return true;
    for (size_t at = VP8X; at + 8 + ANMF <= h->size; at += 8 + (size_t)get32(h, at + 4) + get32(h, at + 4) % 2) {
        if (memcmp(h->bytes + at, "ANMF", 4) != 0)
            continue;
        const bool is_whole = get32(h, at + 8) << 8 == 0 && get32(h, at + 11) << 8 == 0 &&
                              get32(h, at + 14) << 8 == get32(h, 24) << 8 &&
                              get32(h, at + 17) << 8 == get32(h, 27) << 8;
        return is_whole || refuse(message, "WebP", "whose first frame is smaller than the image");
    }
    return true;
}

/* The next word of a header of text, from *at on.  Returns false at its end. */
static bool next_word(const header *h, size_t *at, char *word, size_t capacity) {
    size_t length = 0;
    while (*at < h->size && strchr(" \t\r\n", (int)h->bytes[*at]))
        ++*at;
    for (; *at < h->size && h->bytes[*at] > ' ' && length + 1 < capacity; ++*at)
        word[length++] = (char)h->bytes[*at];
    word[length] = '\0';
    return length > 0;
}

/* A PFM file of another scale than 1: readers differ in what they make of it. */
static bool check_pfm(const header *h, char *message) {
    char word[32];
    size_t at = 0;
    for (int words = 0; words < 4; words++) { /* signature, width, height, scale */
        if (!next_word(h, &at, word, sizeof word))
            return true; /* the reader says what is wrong */
    }
    return fabs(fabs(strtod(word, NULL)) - 1.0) < 1e-6 || refuse(message, "PFM", "with another scale than 1 or -1");
}

/* A PBM file of text may have no blanks between its bits.  OpenImageIO then takes them for one number. */
static bool check_plain_pbm(const header *h, char *message) {
    char word[32];
    size_t at = 0;
    for (int words = 0; words < 4;) { /* signature, width, height, first bit */
        if (!next_word(h, &at, word, sizeof word))
            return true;
        if (word[0] != '#')
            words++;
        else
            while (at < h->size && h->bytes[at] != '\n')
                at++;
    }
    return strlen(word) == 1 || refuse(message, "PBM", "of text without blanks");
}

static bool check_pnm(const header *h, char *message) {
    const unsigned kind = get8(h, 1);
    if (kind == '1')
        return check_plain_pbm(h, message);
    return (kind != 'F' && kind != 'f') || check_pfm(h, message);
}

/* The value of a line "NAME=VALUE" of a header of lines that ends with an empty one; NULL if there is none. */
static const char *find_line(const header *h, const char *name, char *line, size_t capacity) {
    const size_t length = strlen(name);
    for (size_t at = 0; at < h->size;) {
        const uint8_t *end = memchr(h->bytes + at, '\n', h->size - at);
        const size_t count = end ? (size_t)(end - h->bytes) - at : 0;
        if (count == 0)
            return NULL;
        if (count > length && count < capacity && memcmp(h->bytes + at, name, length) == 0) {
            memcpy(line, h->bytes + at, count);
            line[count] = '\0';
            return line + length;
        }
        at += count + 1;
    }
    return NULL;
}

/* x and y of red, green, blue and white; in the content white comes first. */
static bool take_primaries(const char *text, image_content *content) {
    for (size_t i = 0; i < 8; i++) {
        char *end;
        content->primaries[(i + 2) % 8] = strtod(text, &end);
        if (end == text)
            return false;
        text = end;
    }
    return content->has_primaries = true;
}

static bool check_hdr(const header *h, image_content *content, char *message) {
    char line[256];
    const char *text = find_line(h, "GAMMA=", line, sizeof line);
    if (text && fabs(strtod(text, NULL) - 1.0) > 1e-3)
        return refuse(message, "HDR", "with a gamma");
    text = find_line(h, "PRIMARIES=", line, sizeof line);
    return !text || take_primaries(text, content) || refuse(message, "HDR", "with damaged primaries");
}

bool image_check_variant(image_kind kind, const uint8_t *bytes, size_t size, image_content *content,
                         char message[IMAGE_MESSAGE_SIZE]) {
    const header h = {bytes, size};
    switch (kind) {
    case IMAGE_BMP:
        return check_bmp(&h, content, message);
    case IMAGE_TGA:
        return check_tga(&h, content, message);
    case IMAGE_DDS:
        return check_dds(&h, content, message);
    case IMAGE_PSD:
        return check_psd(&h, content, message);
    case IMAGE_SGI:
        return check_sgi(&h, content, message);
    case IMAGE_WEBP:
        return check_webp(&h, message);
    case IMAGE_PNM:
        return check_pnm(&h, message);
    case IMAGE_HDR:
        return check_hdr(&h, content, message);
    default:
        return true;
    }
}
