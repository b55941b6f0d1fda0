/* The classes in which splats are coded as sets, and the position grid of each class (FORMAT.md, "Set coding"). */
#ifndef GSCL_FORMAT_CLASSES_H
#define GSCL_FORMAT_CLASSES_H

#include "format/set.h"
#include "format/types.h"

#define GSF_MAX_CLASSES GSF_MAX_CODEBOOK
#define GSF_SCALE_CLASSES (GSF_MAX_SCALE_CODE + 1u) /* of a layer, scalar coding */

uint32_t gsf_class_count(const gsf_coded_image *image);
/* The code of the major axis in a class of scalar coding. */
unsigned gsf_class_major(uint32_t class_no);
uint32_t gsf_class_of(const gsf_coded_image *image, uint32_t splat);
/* Its grid; in a packet, that of the cells of the packet (FORMAT.md, "Packets"). */
gsf_grid gsf_class_grid(const gsf_coded_image *image, uint32_t class_no);
/* The cell of this grid in which a splat lies. */
gsf_point gsf_class_point(const gsf_coded_image *image, uint32_t splat);
/* The cell of the whole picture's grid of the class for a cell of gsf_class_grid. */
gsf_point gsf_class_cell(const gsf_coded_image *image, uint32_t class_no, gsf_point point);

/* What decides which of a number of packets may hold a splat. */
typedef struct gsf_packet_choice {
    uint32_t packets; /* 0: any may, and the splat may be in several */
    uint32_t shift;   /* packet k has the cells k + shift and on, each time `packets` further, up to the last one */
    uint32_t cell;    /* of the splat, less multiples of `packets` */
    bool is_last;
} gsf_packet_choice;

gsf_packet_choice gsf_packet_choice_of(const gsf_coded_image *image, uint32_t splat, uint32_t packets);
/* Whether this packet may. */
bool gsf_packet_is_allowed(const gsf_packet_choice *choice, uint32_t packet);
/* The same for one packet alone. */
bool gsf_packet_may_hold(const gsf_coded_image *image, uint32_t splat, uint32_t packets, uint32_t packet);

#endif
