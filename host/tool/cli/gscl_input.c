#include "cli/gscl_input.h"

#include <inttypes.h>
#include <stdlib.h>

#include "cli/base64.h"
#include "cli/message.h"
#include "cli/read_file.h"

bool read_gscl_file(const char *name, const gscl_form *form, uint8_t **bytes, size_t *size) {
    if (!read_file(name, MAX_GSCL_FILE, bytes, size))
        return false;
    const char *error = form->base64 ? base64_decode(*bytes, size) : NULL;
    if (!error)
        return true;
    free(*bytes);
    return report_error(input_label(name), "%s", error);
}

bool is_within_limits(const char *name, const gscl_info *info, const gscl_limits *limits) {
    if (info->pixels > limits->max_pixels)
        return report_error(name, "has %" PRIu64 " pixels (%ux%u), more than --max-pixels %" PRIu64 " allows",
                            info->pixels, info->width, info->height, limits->max_pixels);
    if (info->work > limits->max_work)
        return report_error(name, "takes %" PRIu64 " evaluations to draw, more than --max-work %" PRIu64 " allows",
                            info->work, limits->max_work);
    return true;
}

gscl_read_settings read_settings_of(const gscl_form *form) {
    gscl_read_settings settings;
    gscl_read_settings_default(&settings);
    settings.bare = form->bare;
    return settings;
}
