/* Default settings of an encode, which a library without OpenCL has, too. */
#include "runtime/struct_size.h"

void gscl_encode_settings_init(gscl_encode_settings *settings, size_t struct_size) {
    const gscl_encode_settings defaults = {.effort = GSCL_DEFAULT_EFFORT, .seed = 1};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}
