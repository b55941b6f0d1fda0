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

bool packet_files_write(output_file *first, const char *first_name, const uint8_t *list, size_t size) {
    char *name = strdup(first_name);
    const uint8_t *packet;
    size_t position = 0, packet_size;
    bool ok = name || report_error(first->label, "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
    for (unsigned number = 0; ok && gscl_next_packet(list, size, &position, &packet, &packet_size); number++) {
        char *suffix = name + strlen(name) - strlen(FIRST_PACKET_SUFFIX);
        snprintf(suffix, sizeof FIRST_PACKET_SUFFIX, ".%03u.gsclp", number % 1000);
        ok = number == 0 ? output_write(first, packet, packet_size) : write_packet(name, packet, packet_size);
    }
    free(name);
    return ok;
}
