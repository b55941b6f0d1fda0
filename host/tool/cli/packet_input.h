/* Packets as inputs of a command: files with one packet each, lists, and text with a packet on each line. */
#ifndef GSCL_TOOL_PACKET_INPUT_H
#define GSCL_TOOL_PACKET_INPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gscl/gscl.h>

/* The packets of one picture, as they are found. */
typedef struct packet_collection {
    gscl_decoder *decoder; /* which knows what belongs together */
    uint8_t *list;         /* of the packets that were taken, to be released with gscl_free; NULL: none */
    size_t size;
} packet_collection;

/* Whether these bytes are a list of packets or a packet. */
bool is_packet_input(const uint8_t *bytes, size_t size);

/* Whether text has a packet on each line, and not a file. */
bool is_packet_text(const uint8_t *text, size_t size);

/* Adds what is in a packet or a list; `label` names it in messages.  A packet that is damaged, repeated or of another
 * picture is left out with a warning.  Returns false, after reporting it, when out of memory. */
bool packets_collect(packet_collection *packets, const char *label, const uint8_t *bytes, size_t size);
/* The same for text, which is changed. */
bool packets_collect_text(packet_collection *packets, const char *label, uint8_t *text, size_t size);

/* Whether there is anything to draw. */
bool packets_can_draw(const packet_collection *packets);

/* Frees all but the list. */
void packets_end(packet_collection *packets);

#endif
