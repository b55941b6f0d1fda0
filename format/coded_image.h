/* The parts that gsf_read and gsf_write are made of. */
#ifndef GSCL_FORMAT_PICTURE_H
#define GSCL_FORMAT_PICTURE_H

#include "workspace.h"

/* payload.c: everything after the header, in either direction.  False when the content breaks a
 * rule of the format or the input ran out. */
bool gsf_code_payload(gsf_coder *coder, gsf_coded_image *picture, gsf_workspace *workspace);

/* check.c: whether the writer may write this picture. */
bool gsf_coded_image_is_valid(const gsf_coded_image *picture);
/* Whether drawing it stays within the format's limit of work. */
bool gsf_work_is_bounded(const gsf_coded_image *picture);

/* Classes, and the class that a splat belongs to. */
uint32_t gsf_class_count(const gsf_coded_image *picture);
uint32_t gsf_class_of(const gsf_coded_image *picture, uint32_t splat);
gsf_grid gsf_class_grid(const gsf_coded_image *picture, uint32_t class_no);

/* order.c: memory that sorting takes. */
size_t gsf_order_size(const gsf_header *header);
/* Sorts into the stored order, and zeroes the fields whose effect is off. */
void gsf_put_in_order(gsf_coded_image *picture, void *memory);

#endif
