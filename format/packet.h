/* Packets: parts of a picture of which each can be drawn by itself, and lists of them (FORMAT.md, "Packets"). */
#ifndef GSCL_FORMAT_PACKET_H
#define GSCL_FORMAT_PACKET_H

#include "format/types.h"

#define GSF_PACKET_FRAME 3u                  /* bytes of a packet besides its picture */
#define GSF_PACKET_LIST_START 4u             /* bytes before the first packet of a list */
#define GSF_MAX_PACKET_SIZE ((1u << 21) - 1) /* bytes, in a list */

/* ---- One packet ---- */

/* Finds the picture in a packet.  GSF_NOT_GSCL for an identity that none has, GSF_TRUNCATED for too few bytes, GSF_DAMAGED
 * where the check does not match. */
gsf_result gsf_open_packet(gsf_bytes packet, uint8_t *identity, gsf_bytes *picture);
/* Reads the header's fields of a packet. */
gsf_result gsf_read_packet_header(gsf_bytes packet, uint8_t *identity, gsf_header *header);
/* Writes what surrounds the picture, which has `size` bytes and begins at packet + 1.  Returns the size of the packet. */
size_t gsf_put_packet_frame(uint8_t *packet, size_t size, uint8_t identity);

/* ---- Lists ---- */

bool gsf_is_packet_list(const uint8_t *bytes, size_t size);
/* Writes the start of a list: GSF_PACKET_LIST_START bytes. */
void gsf_put_packet_list_start(uint8_t *list);
/* Bytes of the field with a packet's size, and the field itself. */
size_t gsf_packet_size_field(size_t packet_size);
void gsf_put_packet_size(uint8_t *list, size_t packet_size);
/* Takes the next packet from a list; *position is 0 at first.  False at the end, and where the list is cut off. */
bool gsf_next_packet(const uint8_t *list, size_t size, size_t *position, gsf_bytes *packet);

/* Sorts the packets of a list's picture by their numbers; data is NULL where one is missing.  Returns how many the picture
 * has; 0: the list has none with a header. */
uint32_t gsf_list_packets(const uint8_t *list, size_t size, gsf_bytes packets[GSF_MAX_PACKETS], uint8_t *identity);

/* The header's fields of the picture whose packets a list holds: those of its first packet that has a matching check and a
 * header.  splat_count is an upper bound of the splats of all packets of that picture.  GSF_TRUNCATED: there is no
 * packet; GSF_DAMAGED: there are only others. */
gsf_result gsf_read_list_header(const uint8_t *list, size_t size, gsf_header *header);
/* Reads the splats of all packets of that picture, in the stored order of a whole picture and each once.  Skips packets
 * that are damaged, repeated or of another picture.  `image` and `scratch` as for gsf_read. */
gsf_result gsf_read_list(const uint8_t *list, size_t size, gsf_coded_image *image, void *scratch);

/* Removes splats that equal the one before them.  In the stored order equal ones are neighbours, of which a list has one. */
void gsf_remove_repeated(gsf_coded_image *image);

#endif
