/* The packets into which a coded image is divided. */
#ifndef GSCL_LIB_PACKET_TARGET_H
#define GSCL_LIB_PACKET_TARGET_H

#include <stddef.h>
#include <stdint.h>

typedef struct gscl_packet_target {
    uint32_t count;   /* that have splats; 0: it becomes a file */
    uint32_t repairs; /* repair packets besides (FORMAT.md, "Repair packets") */
    size_t limit;     /* bytes of each that has splats */
    uint8_t identity; /* of the picture; 0: one that follows from its splats */
} gscl_packet_target;

#endif
