/* Meanings and costs of codes in a rate-distortion pass. */
#ifndef GSCL_LIB_RDO_TABLES_H
#define GSCL_LIB_RDO_TABLES_H

#include "cl/structs.h"
#include "format/format.h"

/* A splat's codes as the kernels take them, and back. */
gscl_codes gscl_rdo_codes_of(const gsf_splat *splat);
gsf_splat gscl_rdo_splat_of(const gscl_codes *codes, uint32_t layer);

/* Steps and ranges of the codes; lambda and `scan` are left 0. */
gscl_rdo_settings gscl_rdo_settings_of(const gsf_coded_image *image);

/* Estimates the bits of each code from what the entropy coder expects over the `count` splats of the image, which are in
 * the stored order; those of waves and opacities from their occurrences. */
void gscl_rdo_tables_make(gscl_rdo_tables *tables, const gsf_coded_image *image, const gscl_rdo_settings *settings,
                          const gscl_codes *codes, size_t count);

#endif
