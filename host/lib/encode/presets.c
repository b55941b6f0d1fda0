/* Presets of encode settings, which a library without kernels has, too. */
#include "runtime/struct_size.h"

typedef struct preset {
    const char *name;
    gscl_target target;
    double value;
    int effort;
} preset;

static const preset presets[] = {
    [GSCL_PRESET_TINY] = {"tiny", GSCL_TARGET_BYTES, 250, 3},
    [GSCL_PRESET_PREVIEW] = {"preview", GSCL_TARGET_RATE, 0.06, 3},
    [GSCL_PRESET_SMALL] = {"small", GSCL_TARGET_AUTO, 0, GSCL_DEFAULT_EFFORT},
    [GSCL_PRESET_GOOD] = {"good", GSCL_TARGET_QUALITY, 50, GSCL_DEFAULT_EFFORT},
};

static bool is_known(gscl_preset number) {
    return (size_t)number < sizeof presets / sizeof *presets;
}

const char *gscl_preset_name(gscl_preset number) {
    return is_known(number) ? presets[number].name : NULL;
}

gscl_result gscl_encode_settings_preset(gscl_encode_settings *settings, gscl_preset number) {
    if (!settings || !is_known(number))
        return GSCL_ERROR_INVALID_ARGUMENT;
    if (!GSCL_STRUCT_FITS(gscl_encode_settings, trace, settings))
        return GSCL_ERROR_STRUCT_SIZE;
    settings->target = presets[number].target;
    settings->target_value = presets[number].value;
    settings->effort = presets[number].effort;
    return GSCL_OK;
}
