#define _DEFAULT_SOURCE /* strcasecmp */
#include "image/image_format.h"

#include <strings.h>

#include "cli/message.h"
#include "cli/output_file.h"
#include "host/system/output_target.h"

static const image_format formats[] = {
    {".png", true, true, true, true, 16},    {".jpg", true, true, false, true, 8},
    {".jpeg", true, true, false, true, 8},   {".tif", true, true, true, true, 16},
    {".tiff", true, true, true, true, 16},   {".exr", true, true, true, false, 32},
    {".pgm", true, false, false, false, 16}, {".ppm", false, true, false, false, 16},
    {".pnm", true, true, false, false, 16},  {".bmp", true, true, false, false, 8},
    {".tga", true, true, true, false, 8},
};

static const image_format *format_of_suffix(const char *suffix) {
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        if (strcasecmp(suffix, formats[i].suffix) == 0)
            return &formats[i];
    }
    return NULL;
}

bool image_format_has_suffix(const char *name) {
    return format_of_suffix(name_suffix(name)) != NULL;
}

const image_format *image_format_of(const char *command, const char *name) {
    const char *suffix = name_suffix(name);
    if (!*suffix && output_is_in_place(name))
        suffix = IMAGE_PIPE_SUFFIX;
    const image_format *format = format_of_suffix(suffix);
    if (!format)
        report_usage(
            command,
            "%s: no image format has the suffix '%s'; choose one of .png .jpg .tif .exr .pgm .ppm .pnm .bmp .tga", name,
            suffix);
    return format;
}

bool image_format_holds(const image_format *format, const char *name, unsigned channels, gscl_sample sample) {
    if (channels < 3 ? !format->grey : !format->colour)
        return report_error(name, "%s cannot hold a %s image; choose .png", format->suffix,
                            channels < 3 ? "grey" : "colour");
    if (sample != GSCL_SAMPLE_F32 && format->bits == 32)
        return report_error(name, "%s holds floating-point samples in linear light; choose .png", format->suffix);
    if (sample == GSCL_SAMPLE_U16 && format->bits < 16)
        return report_error(name, "%s cannot hold 16 bits per sample; add --depth 8, or choose .png", format->suffix);
    return true;
}
