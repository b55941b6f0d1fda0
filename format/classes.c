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

gsf_grid gsf_class_grid(const gsf_coded_image *image, uint32_t class_no) {
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

gsf_point gsf_class_point(const gsf_coded_image *image, uint32_t splat) {
    if (image->header.coding == GSF_CODING_CODEBOOK)
        return (gsf_point){image->indexed[splat].x, image->indexed[splat].y};
    const gsf_splat *s = &image->splats[splat];
    const gsf_splat_grid grid = gsf_splat_grid_of(&image->header, &image->steps, s);
    return (gsf_point){s->x / grid.parts_x, s->y / grid.parts_y};
}
