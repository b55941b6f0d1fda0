#include "cli/packet_input.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/base64.h"
#include "cli/message.h"

static bool is_packet(const uint8_t *bytes, size_t size) {
    gscl_packet_info info = {.struct_size = sizeof info};
    return gscl_packet_probe(bytes, size, &info) == GSCL_OK;
}

static bool is_list(const uint8_t *bytes, size_t size) {
    const uint8_t *packet;
    size_t position = 0, packet_size;
    return gscl_next_packet(bytes, size, &position, &packet, &packet_size);
}

bool is_packet_input(const uint8_t *bytes, size_t size) {
    return is_list(bytes, size) || is_packet(bytes, size);
}

static size_t line_length(const uint8_t *text, size_t size) {
    const uint8_t *end = memchr(text, '\n', size);
    return end ? (size_t)(end - text) : size;
}

bool is_packet_text(const uint8_t *text, size_t size) {
    bool found = false;
    for (size_t at = 0, length; at < size && !found; at += length + 1) {
        length = line_length(text + at, size - at);
        uint8_t *line = malloc(length + 1);
        size_t line_size = length;
        if (!line)
            return false;
        memcpy(line, text + at, length);
        found = !base64_decode(line, &line_size) && is_packet(line, line_size);
        free(line);
    }
    return found;
}

static bool fail_memory(const char *label) {
    return report_error(label, "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
}

/* What the decoder has taken. */
static gscl_decoder_state state_of(const packet_collection *packets) {
    gscl_decoder_state state = {.struct_size = sizeof state};
    if (!packets->decoder || gscl_decoder_inspect(packets->decoder, &state) != GSCL_OK)
        return (gscl_decoder_state){0};
    return state;
}

static bool collect_packet(packet_collection *packets, const char *label, const uint8_t *packet, size_t size) {
    if (!packets->decoder && gscl_decoder_create(&packets->decoder, NULL) != GSCL_OK)
        return fail_memory(label);
    const uint32_t before = state_of(packets).received;
    gscl_result result = gscl_decoder_add_packet(packets->decoder, packet, size);
    const bool is_repeated = result == GSCL_OK && state_of(packets).received == before;
    if (result == GSCL_OK && !is_repeated)
        result = gscl_append_packet(&packets->list, &packets->size, packet, size);
    if (result == GSCL_ERROR_OUT_OF_MEMORY)
        return fail_memory(label);
    if (is_repeated)
        report_warning(label, "skipped a packet that has come before");
    else if (result == GSCL_ERROR_OTHER_PICTURE)
        report_warning(label, "skipped a packet of another picture");
    else if (result != GSCL_OK)
        report_warning(label, "skipped a packet that is damaged or none");
    return true;
}

bool packets_collect(packet_collection *packets, const char *label, const uint8_t *bytes, size_t size) {
    const uint8_t *packet;
    size_t position = 0, packet_size;
    if (!is_list(bytes, size))
        return collect_packet(packets, label, bytes, size);
    while (gscl_next_packet(bytes, size, &position, &packet, &packet_size))
        if (!collect_packet(packets, label, packet, packet_size))
            return false;
    if (position < size)
        report_warning(label, "is cut off: its last %zu bytes were skipped", size - position);
    return true;
}

bool packets_collect_text(packet_collection *packets, const char *label, uint8_t *text, size_t size) {
    for (size_t at = 0, length; at < size; at += length + 1) {
        length = line_length(text + at, size - at);
        size_t line_size = length;
        const char *problem = base64_decode(text + at, &line_size);
        if (problem)
            report_warning(label, "skipped a line that %s", problem);
        else if (line_size > 0 && !packets_collect(packets, label, text + at, line_size))
            return false;
    }
    return true;
}

bool packets_can_draw(const packet_collection *packets) {
    return state_of(packets).drawn > 0;
}

void packets_end(packet_collection *packets) {
    gscl_decoder_free(&packets->decoder);
}
