/* Default settings of the measurements, which a library without OpenCL has, too. */
#include <gscl/measure.h>

#include "runtime/struct_size.h"

void gscl_benchmark_settings_init(gscl_benchmark_settings *settings, size_t struct_size) {
    const gscl_benchmark_settings defaults = {.width = 768, .height = 512, .splats = 2500, .repetitions = 20};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}

void gscl_accuracy_settings_init(gscl_accuracy_settings *settings, size_t struct_size) {
    const gscl_accuracy_settings defaults = {.repetitions = 20, .splats = 48};
    gscl_struct_init(settings, struct_size, &defaults, sizeof defaults);
}
