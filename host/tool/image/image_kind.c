#include "image/image_kind.h"

#include <stdbool.h>
#include <string.h>

typedef struct signature {
    size_t offset, size;
    const char *bytes;
    image_kind kind;
    const char *name; /* of a format that is not read */
} signature;

#define AT(offset, bytes) (offset), sizeof(bytes) - 1, (bytes)

static const signature signatures[] = {
    {AT(0, "\x89PNG\r\n\x1a\n"), IMAGE_PNG, NULL},
    {AT(0, "\xff\xd8\xff"), IMAGE_JPEG, NULL},
    {AT(0, "\0\0\0\x0cjP  \r\n\x87\n"), IMAGE_JPEG2000, NULL},
    {AT(0, "\xff\x4f\xff\x51"), IMAGE_JPEG2000, NULL},
    {AT(0, "GIF87a"), IMAGE_GIF, NULL},
    {AT(0, "GIF89a"), IMAGE_GIF, NULL},
    {AT(0, "II*\0"), IMAGE_TIFF, NULL},
    {AT(0, "MM\0*"), IMAGE_TIFF, NULL},
    {AT(0, "II+\0"), IMAGE_TIFF, NULL}, /* BigTIFF */
    {AT(0, "MM\0+"), IMAGE_TIFF, NULL},
    {AT(0, "\x76\x2f\x31\x01"), IMAGE_EXR, NULL},
    {AT(0, "#?RADIANCE\n"), IMAGE_HDR, NULL},
    {AT(0, "#?RGBE\n"), IMAGE_HDR, NULL},
    {AT(0, "8BPS"), IMAGE_PSD, NULL},
    {AT(0, "\x01\xda"), IMAGE_SGI, NULL},
    {AT(0, "DDS "), IMAGE_DDS, NULL},
    {AT(0, "BM"), IMAGE_BMP, NULL},
    {AT(0, "\xff\x0a"), IMAGE_UNKNOWN, "JPEG XL"},
    {AT(0, "\0\0\0\x0cJXL \r\n\x87\n"), IMAGE_UNKNOWN, "JPEG XL"},
    {AT(0, "SDPX"), IMAGE_UNKNOWN, "DPX"},
    {AT(0, "XPDS"), IMAGE_UNKNOWN, "DPX"},
    {AT(0, "\x80\x2a\x5f\xd7"), IMAGE_UNKNOWN, "Cineon"},
    {AT(0, "SIMPLE  ="), IMAGE_UNKNOWN, "FITS"},
    {AT(0, "P7\n"), IMAGE_UNKNOWN, "PAM"},
    {AT(0, "%PDF"), IMAGE_UNKNOWN, "PDF"},
    {AT(0, "%!PS"), IMAGE_UNKNOWN, "PostScript"},
    {AT(0, "FOR4"), IMAGE_UNKNOWN, "IFF"},
    {AT(128, "DICM"), IMAGE_UNKNOWN, "DICOM"},
    {AT(0, "\x1a\x45\xdf\xa3"), IMAGE_UNKNOWN, "video"},
    {AT(0, "FUJIFILMCCD-RAW"), IMAGE_UNKNOWN, "camera raw"},
    {AT(0, "IIRO"), IMAGE_UNKNOWN, "camera raw"},
    {AT(0, "IIU\0"), IMAGE_UNKNOWN, "camera raw"},
    {AT(4, "ftypcrx "), IMAGE_UNKNOWN, "camera raw"},
    {AT(4, "ftypisom"), IMAGE_UNKNOWN, "video"},
    {AT(4, "ftypmp4"), IMAGE_UNKNOWN, "video"},
    {AT(4, "ftypqt  "), IMAGE_UNKNOWN, "video"},
};

static const signature *find_signature(const uint8_t *bytes, size_t size) {
    for (size_t i = 0; i < sizeof signatures / sizeof *signatures; i++) {
        const signature *s = &signatures[i];
        if (size >= s->offset + s->size && memcmp(bytes + s->offset, s->bytes, s->size) == 0)
            return s;
    }
    return NULL;
}

static bool is_webp(const uint8_t *bytes, size_t size) {
    return size >= 12 && memcmp(bytes, "RIFF", 4) == 0 && memcmp(bytes + 8, "WEBP", 4) == 0;
}

static bool is_heif(const uint8_t *bytes, size_t size) {
    static const char brands[][5] = {"avif", "avis", "heic", "heim", "heis", "heix", "hevc", "hevx", "mif1", "msf1"};
    for (size_t i = 0; size >= 12 && i < sizeof brands / sizeof *brands; i++) {
        if (memcmp(bytes + 4, "ftyp", 4) == 0 && memcmp(bytes + 8, brands[i], 4) == 0)
            return true;
    }
    return false;
}

static bool is_blank(uint8_t byte) {
    return byte == ' ' || (byte >= '\t' && byte <= '\r');
}

static bool is_pnm(const uint8_t *bytes, size_t size) {
    return size >= 3 && bytes[0] == 'P' && strchr("123456Ff", bytes[1]) && bytes[1] &&
           (is_blank(bytes[2]) || bytes[2] == '#');
}

/* Reserved 0, 1 for icons or 2 for cursors, and at least one image. */
static bool is_ico(const uint8_t *bytes, size_t size) {
    return size >= 6 && bytes[0] == 0 && bytes[1] == 0 && (bytes[2] == 1 || bytes[2] == 2) && bytes[3] == 0 &&
           (bytes[4] || bytes[5]);
}

/* Whether there is a header whose fields fit together. */
static bool is_tga(const uint8_t *bytes, size_t size) {
    if (size < 18)
        return false;
    const int map = bytes[1], kind = bytes[2], map_bits = bytes[7], bits = bytes[16];
    const bool has_size = (bytes[12] | bytes[13]) && (bytes[14] | bytes[15]);
    const bool has_map = map == 1 && (map_bits == 15 || map_bits == 16 || map_bits == 24 || map_bits == 32);
    const bool is_indexed = (kind == 1 || kind == 9) && has_map && (bits == 8 || bits == 16);
    const bool is_colour = (kind == 2 || kind == 10) && (bits == 15 || bits == 16 || bits == 24 || bits == 32);
    const bool is_grey = (kind == 3 || kind == 11) && (bits == 8 || bits == 16);
    return has_size && (map == 0 || has_map) && (is_indexed || is_colour || is_grey) && bytes[17] < 64;
}

image_kind image_kind_of(const uint8_t *bytes, size_t size) {
    const signature *found = find_signature(bytes, size);
    if (found)
        return found->kind;
    if (is_webp(bytes, size))
        return IMAGE_WEBP;
    if (is_heif(bytes, size))
        return IMAGE_HEIF;
    if (is_pnm(bytes, size))
        return IMAGE_PNM;
    if (is_ico(bytes, size))
        return IMAGE_ICO;
    return is_tga(bytes, size) ? IMAGE_TGA : IMAGE_UNKNOWN;
}

const char *image_kind_plugin(image_kind kind) {
    switch (kind) {
    case IMAGE_WEBP:
        return "webp";
    case IMAGE_HEIF:
        return "heif";
    case IMAGE_GIF:
        return "gif";
    case IMAGE_TIFF:
        return "tiff";
    case IMAGE_EXR:
        return "openexr";
    case IMAGE_HDR:
        return "hdr";
    case IMAGE_BMP:
        return "bmp";
    case IMAGE_TGA:
        return "targa";
    case IMAGE_PNM:
        return "pnm";
    case IMAGE_PSD:
        return "psd";
    case IMAGE_SGI:
        return "sgi";
    case IMAGE_DDS:
        return "dds";
    default:
        return NULL;
    }
}

const char *image_foreign_name(const uint8_t *bytes, size_t size) {
    const signature *found = find_signature(bytes, size);
    return found ? found->name : NULL;
}
