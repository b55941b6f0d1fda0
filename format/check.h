/* The rules that an image must keep: all of them for the writer, and the limit of work for both directions. */
#ifndef GSCL_FORMAT_CHECK_H
#define GSCL_FORMAT_CHECK_H

#include "format/types.h"

/* Whether all values are within the limits of the format, so that the writer may write the image. */
bool gsf_coded_image_is_valid(const gsf_coded_image *image);
/* Whether drawing the image stays within the format's limit of work (FORMAT.md, "Limits"). */
bool gsf_work_is_bounded(const gsf_coded_image *image);

#endif
