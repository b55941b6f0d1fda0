/* YCoCg, the colours in which a file stores splats (FORMAT.md, "Dequantisation"); cl/project.cl has the same in single
 * precision. */
#ifndef GSCL_LIB_YCOCG_H
#define GSCL_LIB_YCOCG_H

#include "runtime/real.h"

typedef struct gscl_ycocg {
    gscl_real y, co, cg;
} gscl_ycocg;

static inline gscl_ycocg gscl_ycocg_from_rgb(const float rgb[3]) {
    return (gscl_ycocg){(rgb[0] + GSCL_REAL(2) * rgb[1] + rgb[2]) / 4, rgb[0] - rgb[2],
                        rgb[1] - (rgb[0] + rgb[2]) / GSCL_REAL(2)};
}

static inline void gscl_ycocg_to_rgb(gscl_ycocg c, float rgb[3]) {
    rgb[0] = (float)(c.y - c.cg / 2 + c.co / 2);
    rgb[1] = (float)(c.y + c.cg / 2);
    rgb[2] = (float)(c.y - c.cg / 2 - c.co / 2);
}

#endif
