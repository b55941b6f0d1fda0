/* The public function of the settings of a decode. */
#include <gscl/gscl.h>

#include "runtime/struct_size.h"

void gscl_decode_settings_init(gscl_decode_settings *settings, size_t struct_size) {
    const gscl_decode_settings defaults = {0};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}
