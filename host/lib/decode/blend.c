#include "decode/blend.h"

#include "cl/constants.h"

typedef struct blend_numbers {
    gscl_blend blend;
    gsf_blend format;
    int kernels;
} blend_numbers;

static const blend_numbers blends[] = {{GSCL_BLEND_NORMALIZED, GSF_BLEND_NORMALIZED, GSCL_NORMALIZED},
                                       {GSCL_BLEND_ALPHA, GSF_BLEND_ALPHA, GSCL_ALPHA},
                                       {GSCL_BLEND_SUM, GSF_BLEND_SUM, GSCL_SUM}};
enum { BLENDS = sizeof blends / sizeof blends[0] };

static const blend_numbers *find_blend(gscl_blend blend) {
    int i = BLENDS - 1;
    while (i > 0 && blends[i].blend != blend)
        i--;
    return &blends[i];
}

gsf_blend gscl_blend_to_format(gscl_blend blend) {
    return find_blend(blend)->format;
}

int gscl_blend_to_kernels(gscl_blend blend) {
    return find_blend(blend)->kernels;
}

gscl_blend gscl_blend_from_format(gsf_blend blend) {
    int i = BLENDS - 1;
    while (i > 0 && blends[i].format != blend)
        i--;
    return blends[i].blend;
}

gscl_blend gscl_blend_from_kernels(int blend) {
    int i = BLENDS - 1;
    while (i > 0 && blends[i].kernels != blend)
        i--;
    return blends[i].blend;
}
