#define _DEFAULT_SOURCE /* strdup */
#include "commands/packet_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/message.h"

static bool write_packet(const char *name, const uint8_t *packet, size_t size) {
    output_file output;
    if (!output_open(&output, name))
        return false;
    output_write(&output, packet, size);
    return output_commit(&output);
}

/* Writes the packets under the names that follow from `name`, which is changed. */
static bool write_packets(output_file *first, char *name, const uint8_t *list, size_t size) {
    char *suffix = name + strlen(name) - strlen(FIRST_PACKET_SUFFIX);
    const uint8_t *packet;
    size_t position = 0, packet_size;
    bool ok = true;
    for (unsigned number = 0; ok && gscl_next_packet(list, size, &position, &packet, &packet_size); number++) {
        snprintf(suffix, sizeof FIRST_PACKET_SUFFIX, ".%03u.gsclp", number % 1000);
        ok = number == 0 ? output_write(first, packet, packet_size) : write_packet(name, packet, packet_size);
    }
    return ok;
}

bool packet_files_write(output_file *first, const char *first_name, const uint8_t *list, size_t size) {
    char *name = strdup(first_name);
    if (!name)
        return report_error(first->label, "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
    const bool ok = write_packets(first, name, list, size);
    free(name);
    return ok;
}
