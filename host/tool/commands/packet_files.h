/* Packets as files of their own. */
#ifndef GSCL_TOOL_PACKET_FILES_H
#define GSCL_TOOL_PACKET_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cli/output_file.h"

#define FIRST_PACKET_SUFFIX ".000.gsclp" /* of the first packet; those of the others count on */

/* Writes the packets of a list.  `first` is the open output of the first packet, whose name `first_name` has this suffix; it
 * is written last, so that where it exists all others do.  Returns false when another output failed, which is reported;
 * `first` is still open. */
bool packet_files_write(output_file *first, const char *first_name, const uint8_t *list, size_t size);

#endif
