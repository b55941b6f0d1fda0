#include "decode/coded_size.h"

#include "decode/format_result.h"
#include "decode/packet_split.h"

gscl_result gscl_coded_image_size(gscl_coded_image *p, size_t *size) {
    GSCL_TRY(gscl_coded_image_reserve(p, p->file.header.splat_count));
    if (p->packets > 0)
        return gscl_packets_size(&p->file, p->packets, size);
    return gscl_result_of_format(gsf_size(&p->file, size, p->scratch));
}
