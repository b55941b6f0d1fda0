#include "cli/gscl_input.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "cli/base64.h"
#include "cli/message.h"
#include "cli/output_file.h"
#include "cli/packet_input.h"
#include "cli/read_file.h"

static bool is_named_packet(const char *name) {
    return strcmp(name_suffix(name), ".gsclp") == 0;
}

/* Takes what was read of an input; *bytes stay those of a file, where the only input is one.  Otherwise its packets are added,
 * and *has_packets is set.  Reports errors. */
static bool take_input(const char *name, const gscl_form *form, bool is_only, uint8_t *bytes, size_t *size,
                       packet_collection *packets, bool *has_packets) {
    const char *label = input_label(name);
    const bool is_text = form->base64 && !form->bare && is_packet_text(bytes, *size);
    const char *error = form->base64 && !is_text ? base64_decode(bytes, size) : NULL;
    *has_packets = is_text || (!form->bare && (!is_only || is_packet_input(bytes, *size)));
    if (error)
        return report_error(label, "%s", error);
    if (!*has_packets)
        return form->bare || !is_named_packet(name) || report_error(label, "is damaged, or no packet of a picture");
    return is_text ? packets_collect_text(packets, label, bytes, *size) : packets_collect(packets, label, bytes, *size);
}

/* Reads an input; *bytes is NULL afterwards where it had packets. */
static bool read_input(const char *name, const gscl_form *form, bool is_only, uint8_t **bytes, size_t *size,
                       packet_collection *packets) {
    bool has_packets;
    if (!read_file(name, MAX_GSCL_FILE, bytes, size))
        return false;
    const bool ok = take_input(name, form, is_only, *bytes, size, packets, &has_packets);
    if (ok && !has_packets)
        return true;
    free(*bytes);
    *bytes = NULL;
    return ok;
}

/* Reports that no packet of the inputs can be drawn. */
static bool fail_packets(char *const *names, int count, const packet_collection *packets) {
    return report_error(input_label(names[0]), "%s%s", count > 1 ? "and the others " : "",
                        packets->list ? "hold repair packets only, which draw nothing by themselves"
                                      : "hold no packet of a picture");
}

bool read_gscl_files(char *const *names, int count, const gscl_form *form, uint8_t **bytes, size_t *size) {
    packet_collection packets = {0};
    bool ok = true;
    *bytes = NULL;
    for (int i = 0; i < count && ok; i++)
        ok = read_input(names[i], form, count == 1, bytes, size, &packets);
    if (ok && !*bytes)
        ok = packets_can_draw(&packets) || fail_packets(names, count, &packets);
    packets_end(&packets);
    if (ok && !*bytes) {
        *bytes = packets.list;
        *size = packets.size;
    } else {
        gscl_free(packets.list);
    }
    return ok;
}

bool read_gscl_file(const char *name, const gscl_form *form, uint8_t **bytes, size_t *size) {
    char *names[] = {(char *)name};
    return read_gscl_files(names, 1, form, bytes, size);
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
