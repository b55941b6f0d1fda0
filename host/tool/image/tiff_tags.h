/* Checked access to the directories of a TIFF structure: a TIFF file, a BigTIFF file, whose numbers are wider, or a block of
 * EXIF, which has the structure of the first.  Nothing is read or written outside the bytes, whatever they hold. */
#ifndef GSCL_TOOL_TIFF_TAGS_H
#define GSCL_TOOL_TIFF_TAGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    TIFF_BYTE = 1,
    TIFF_ASCII = 2,
    TIFF_SHORT = 3,
    TIFF_LONG = 4,
    TIFF_UNDEFINED = 7,
    TIFF_IFD = 13,
    TIFF_LONG8 = 16,
    TIFF_IFD8 = 18
};

#define TIFF_ENTRY_SIZE 12 /* bytes of an entry of a directory, not of BigTIFF */

typedef struct tiff_view {
    uint8_t *bytes;
    size_t size;
    bool big_endian, is_big_tiff;
    uint64_t directory; /* offset of the first directory */
} tiff_view;

/* An entry whose value lies inside the bytes. */
typedef struct tiff_entry {
    uint16_t tag, type;
    uint64_t count;
    size_t at;                /* offset of the entry */
    size_t value, value_size; /* offset and bytes of the value, inside the entry or elsewhere */
} tiff_entry;

/* Opens a structure of at least one directory.  Returns false if the bytes hold none. */
bool tiff_open(tiff_view *view, uint8_t *bytes, size_t size);

/* Number of the entries of a directory; 0 if it does not lie inside the bytes. */
size_t tiff_entry_count(const tiff_view *view, uint64_t directory);
/* Reads an entry.  Returns false if its type is unknown or its value does not lie inside the bytes. */
bool tiff_entry_read(const tiff_view *view, uint64_t directory, size_t index, tiff_entry *entry);
/* Finds the first entry with a tag. */
bool tiff_find(const tiff_view *view, uint64_t directory, uint16_t tag, tiff_entry *entry);
/* Offset of the directory after `directory`, as the structure holds it; 0 for none. */
uint64_t tiff_next_directory(const tiff_view *view, uint64_t directory);

/* A number of an entry of type SHORT, LONG or IFD, or of their wider forms in BigTIFF: the first, or that of an index below
 * entry->count.  0 for other types. */
uint64_t tiff_number(const tiff_view *view, const tiff_entry *entry);
uint64_t tiff_number_at(const tiff_view *view, const tiff_entry *entry, size_t index);
/* The first number of the entry with a tag, or `otherwise`. */
uint64_t tiff_find_number(const tiff_view *view, uint64_t directory, uint16_t tag, uint64_t otherwise);

/* Whether a tag of the first directory describes the image (its maker, date, author) and not how it is stored. */
bool tiff_tag_describes_image(uint16_t tag);

/* Numbers in the byte order of the structure, at an offset that lies inside. */
uint16_t tiff_get16(const tiff_view *view, size_t at);
uint32_t tiff_get32(const tiff_view *view, size_t at);
uint64_t tiff_get64(const tiff_view *view, size_t at);
void tiff_put16(const tiff_view *view, size_t at, uint16_t value);
void tiff_put32(const tiff_view *view, size_t at, uint32_t value);

#endif
