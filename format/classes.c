#include "format/classes.h"

#include "format/quantiser.h"

uint32_t gsf_class_count(const gsf_coded_image *image) {
    return image->header.coding == GSF_CODING_SCALAR ? GSF_SCALE_CLASSES * (image->header.enhancement_layers + 1u)
                                                     : image->codebooks.shape_count;
}

unsigned gsf_class_major(uint32_t class_no) {
    return GSF_MAX_SCALE_CODE - class_no % GSF_SCALE_CLASSES;
}

uint32_t gsf_class_of(const gsf_coded_image *image, uint32_t splat) {
    if (image->header.coding == GSF_CODING_CODEBOOK)
        return image->indexed[splat].shape;
    const gsf_splat *s = &image->splats[splat];
    return GSF_SCALE_CLASSES * s->layer + GSF_MAX_SCALE_CODE - s->major;
}

/* The grid of a class in the whole picture. */
static gsf_grid whole_grid(const gsf_coded_image *image, uint32_t class_no) {
    const gsf_header *header = &image->header;
    if (header->coding == GSF_CODING_CODEBOOK) {
        const uint32_t cells = UINT32_C(1) << image->codebooks.position_bits;
        return (gsf_grid){cells, cells, header->width, header->height};
    }
    const unsigned major = gsf_class_major(class_no);
    const uint32_t step = gsf_position_step_q8(&image->steps, major);
    return (gsf_grid){gsf_position_cells(&image->steps, major, header->width),
                      gsf_position_cells(&image->steps, major, header->height), step, step};
}

/* ---- The cells of a packet ---- */

/* Whether a packet has a part of the cells only: not where they are few, and each may be needed in several packets. */
static bool is_thinned(const gsf_grid *grid, uint32_t packets) {
    return packets > 1 && (grid->cells_x >= 2 * packets || grid->cells_y >= 2 * packets);
}

static bool is_thinned_in_x(const gsf_grid *grid) {
    return grid->cells_x >= grid->cells_y;
}

/* By how many cells the next row (column) of a packet's cells lies further on, so that they spread evenly. */
static uint32_t packet_skew(uint32_t packets) {
    uint32_t skew = 1;
    while (skew * (skew + 1) < packets)
        skew++;
    return skew;
}

/* The first cell of a packet in this row (column). */
static uint32_t first_cell(uint32_t packets, uint32_t packet, uint32_t row) {
    return (packet + packet_skew(packets) * row) % packets;
}

gsf_grid gsf_class_grid(const gsf_coded_image *image, uint32_t class_no) {
    gsf_grid grid = whole_grid(image, class_no);
    const uint32_t packets = gsf_header_packets(&image->header);
    if (!is_thinned(&grid, packets))
        return grid;
    const bool in_x = is_thinned_in_x(&grid);
    uint32_t *cells = in_x ? &grid.cells_x : &grid.cells_y;
    *cells = (*cells + packets - 1) / packets;
    *(in_x ? &grid.pitch_x : &grid.pitch_y) *= packets;
    return grid;
}

gsf_point gsf_class_cell(const gsf_coded_image *image, uint32_t class_no, gsf_point point) {
    const gsf_grid grid = whole_grid(image, class_no);
    const uint32_t packets = gsf_header_packets(&image->header);
    if (!is_thinned(&grid, packets))
        return point;
    const bool in_x = is_thinned_in_x(&grid);
    uint32_t *thinned = in_x ? &point.x : &point.y;
    const uint32_t last = (in_x ? grid.cells_x : grid.cells_y) - 1;
    const uint32_t cell = *thinned * packets + first_cell(packets, image->header.packet, in_x ? point.y : point.x);
    *thinned = cell < last ? cell : last;
    return point;
}

static gsf_point whole_point(const gsf_coded_image *image, uint32_t splat) {
    if (image->header.coding == GSF_CODING_CODEBOOK)
        return (gsf_point){image->indexed[splat].x, image->indexed[splat].y};
    const gsf_splat *s = &image->splats[splat];
    const gsf_splat_grid grid = gsf_splat_grid_of(&image->header, &image->steps, s);
    return (gsf_point){s->x / grid.parts_x, s->y / grid.parts_y};
}

gsf_point gsf_class_point(const gsf_coded_image *image, uint32_t splat) {
    gsf_point point = whole_point(image, splat);
    const uint32_t packets = gsf_header_packets(&image->header);
    if (packets <= 1)
        return point;
    const gsf_grid grid = whole_grid(image, gsf_class_of(image, splat));
    if (is_thinned(&grid, packets))
        *(is_thinned_in_x(&grid) ? &point.x : &point.y) /= packets;
    return point;
}

gsf_packet_choice gsf_packet_choice_of(const gsf_coded_image *image, uint32_t splat, uint32_t packets) {
    const gsf_grid grid = whole_grid(image, gsf_class_of(image, splat));
    if (!is_thinned(&grid, packets))
        return (gsf_packet_choice){.packets = 0};
    const gsf_point point = whole_point(image, splat);
    const bool in_x = is_thinned_in_x(&grid);
    const uint32_t cell = in_x ? point.x : point.y, last = (in_x ? grid.cells_x : grid.cells_y) - 1;
    return (gsf_packet_choice){.packets = packets,
                               .shift = first_cell(packets, 0, in_x ? point.y : point.x),
                               .cell = cell % packets,
                               .is_last = cell == last};
}

bool gsf_packet_is_allowed(const gsf_packet_choice *choice, uint32_t packet) {
    if (choice->packets == 0)
        return true;
    const uint32_t first = (packet + choice->shift) % choice->packets;
    return first == choice->cell || (choice->is_last && first > choice->cell);
}

bool gsf_packet_may_hold(const gsf_coded_image *image, uint32_t splat, uint32_t packets, uint32_t packet) {
    const gsf_packet_choice choice = gsf_packet_choice_of(image, splat, packets);
    return gsf_packet_is_allowed(&choice, packet);
}
