#include "format/order.h"

#include <string.h>

#include "format/classes.h"

typedef struct record {
    uint64_t key; /* class and path through the splits */
    uint32_t splat;
} record;

#define PATH_BITS 40 /* at most 19 splits along each axis */

/* The path to a cell: one bit for each split, the first split in the highest bit.  No path is a prefix of another. */
static uint64_t path_to(const gsf_grid *grid, uint32_t x, uint32_t y) {
    uint64_t path = 0;
    unsigned bits = PATH_BITS;
    gsf_rect rect = {0, 0, grid->cells_x, grid->cells_y};
    while (bits > 0 && (rect.width > 1 || rect.height > 1)) {
        const gsf_split split = gsf_split_rect(grid, rect);
        const bool second = (split.along_x ? x : y) >= split.at;
        path |= (uint64_t)second << --bits;
        rect = gsf_half(rect, &split, second);
    }
    return path;
}

static uint64_t key_of(const gsf_coded_image *image, uint32_t splat) {
    const uint32_t class_no = gsf_class_of(image, splat);
    const gsf_grid grid = gsf_class_grid(image, class_no);
    const gsf_point point = gsf_class_point(image, splat);
    return (uint64_t)class_no << PATH_BITS | path_to(&grid, point.x, point.y);
}

static int compare(int a, int b) {
    return (a > b) - (a < b);
}

/* The order of splats in the same cell: by the attributes in the order of the file. */
static int compare_codes(const gsf_splat *a, const gsf_splat *b) {
    const gsf_texture *s = &a->texture, *t = &b->texture;
    const int order[] = {compare(a->aspect, b->aspect),   compare(a->angle, b->angle),
                         compare((int)a->x, (int)b->x),   compare((int)a->y, (int)b->y),
                         compare(a->luma, b->luma),       compare(a->co, b->co),
                         compare(a->cg, b->cg),           compare(a->alpha, b->alpha),
                         compare(a->opacity, b->opacity), compare(s->amplitude, t->amplitude),
                         compare(s->wave, t->wave),       compare(s->direction, t->direction),
                         compare(s->phase, t->phase)};
    for (size_t i = 0; i < sizeof order / sizeof *order; i++)
        if (order[i] != 0)
            return order[i];
    return 0;
}

static bool precedes(const gsf_coded_image *image, const record *a, const record *b) {
    if (a->key != b->key)
        return a->key < b->key;
    if (image->header.coding == GSF_CODING_SCALAR)
        return compare_codes(&image->splats[a->splat], &image->splats[b->splat]) < 0;
    return image->indexed[a->splat].colour < image->indexed[b->splat].colour;
}

/* Merges the sorted runs from[0..middle) and from[middle..n) into to[0..n). */
static void merge(const gsf_coded_image *image, const record *from, uint32_t middle, uint32_t n, record *to) {
    uint32_t left = 0, right = middle;
    for (uint32_t i = 0; i < n; i++) {
        const bool take_right = left == middle || (right < n && precedes(image, &from[right], &from[left]));
        to[i] = take_right ? from[right++] : from[left++];
    }
}

static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Bottom-up merge sort.  Returns the one of the two lists that holds the result. */
static record *merge_sort(const gsf_coded_image *image, record *list, record *other, uint32_t n) {
    for (uint32_t run = 1; run < n; run *= 2) {
        for (uint32_t first = 0; first < n; first += 2 * run) {
            const uint32_t length = smaller(2 * run, n - first);
            merge(image, list + first, smaller(run, length), length, other + first);
        }
        record *const sorted = other;
        other = list;
        list = sorted;
    }
    return list;
}

/* Puts the splats in the order of the list.  `copy` is memory for all of them. */
static void reorder(gsf_coded_image *image, const record *list, void *copy) {
    const uint32_t n = image->header.splat_count;
    if (image->header.coding == GSF_CODING_SCALAR) {
        const gsf_splat *old = memcpy(copy, image->splats, n * sizeof *old);
        for (uint32_t i = 0; i < n; i++)
            image->splats[i] = old[list[i].splat];
    } else {
        const gsf_indexed_splat *old = memcpy(copy, image->indexed, n * sizeof *old);
        for (uint32_t i = 0; i < n; i++)
            image->indexed[i] = old[list[i].splat];
    }
}

/* Codes whose effect is off must not influence the order. */
static void clear_unused(gsf_coded_image *image) {
    const gsf_header *header = &image->header;
    for (uint32_t i = 0; i < header->splat_count; i++) {
        gsf_splat *splat = &image->splats[i];
        splat->layer = header->enhancement_layers > 0 ? splat->layer : 0;
        splat->aspect = header->has_anisotropy ? splat->aspect : 0;
        splat->angle = header->has_rotation ? splat->angle : 0;
        splat->co = header->has_chroma ? splat->co : 0;
        splat->cg = header->has_chroma ? splat->cg : 0;
        splat->alpha = header->has_alpha ? splat->alpha : 0;
        splat->opacity = header->has_opacity ? splat->opacity : 0;
        if (!header->has_texture)
            splat->texture = (gsf_texture){0};
    }
}

/* A list of records, and space for another list or for a copy of the splats. */
size_t gsf_order_size(const gsf_header *header) {
    const size_t larger = sizeof(gsf_splat) > sizeof(record) ? sizeof(gsf_splat) : sizeof(record);
    return header->splat_count * (sizeof(record) + larger);
}

void gsf_sort_splats(gsf_coded_image *image, void *memory) {
    const uint32_t n = image->header.splat_count;
    record *list = memory, *other = list + n;
    if (n == 0) /* the arrays may be NULL */
        return;
    if (image->header.coding == GSF_CODING_SCALAR)
        clear_unused(image);
    for (uint32_t i = 0; i < n; i++)
        list[i] = (record){key_of(image, i), i};
    if (merge_sort(image, list, other, n) == other)
        memcpy(list, other, n * sizeof *list);
    reorder(image, list, other);
}
