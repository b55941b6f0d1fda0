/* Default settings of gscl_pack, which a library without an encoder has, too. */
#include <gscl/gscl.h>

#include "runtime/struct_size.h"

void gscl_pack_settings_init(gscl_pack_settings *settings, size_t struct_size) {
    const gscl_pack_settings defaults = {.passes = true, .tolerance = 0.01};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}
