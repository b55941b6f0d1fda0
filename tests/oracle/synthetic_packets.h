/* Pictures in packets, from synthetic scenes. */
#ifndef GSCL_SYNTHETIC_PACKETS_H
#define GSCL_SYNTHETIC_PACKETS_H

#include "synthetic_scene.h"

/* Packets, and repair packets behind them. */
typedef struct {
    gsf_bytes packets[GSF_MAX_PACKETS];
    uint32_t count, repairs;
} synthetic_packets;

/* A scene that can be divided: of synthetic_header, with splats of all sizes. */
synthetic_scene *synthetic_divisible_scene(int number, uint32_t width, uint32_t height, uint32_t splats);

/* Writes packets and repair packets of a scene, with each splat in the first packet that may have it.  Returns false when a
 * packet cannot be written.  The caller frees them in any case. */
bool synthetic_packets_write(const gsf_coded_image *image, uint32_t count, uint32_t repairs, uint8_t identity,
                             synthetic_packets *packets);
void synthetic_packets_free(synthetic_packets *packets);

/* A list of the packets with these numbers, which the caller frees; NULL when memory runs out. */
uint8_t *synthetic_list(const synthetic_packets *packets, const uint32_t *numbers, uint32_t count, size_t *size);

#endif
