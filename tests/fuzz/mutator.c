#include "mutator.h"

#include "coded_memory.h"
#include "format/coder.h"
#include "format/payload.h"

static uint32_t random_state;

void fuzz_begin_picks(unsigned seed) {
    random_state = seed | 1;
}

/* xorshift */
uint32_t fuzz_pick(uint32_t n) {
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state % n;
}

size_t fuzz_picture_end(const uint8_t *picture, size_t size, bool in_packet) {
    static fuzz_memory memory;
    gsf_header header = {.packets = in_packet};
    gsf_coded_image image;
    gsf_coder coder;
    gsf_coder_read_from(&coder, picture, size, NULL);
    gsf_code_fields(&coder, &header);
    if (gsf_coder_overrun(&coder) || !fuzz_create(&image, &memory, &header))
        return size;
    image.header.packets = in_packet;
    gsf_coder_read_from(&coder, picture, size, NULL);
    gsf_code_header(&coder, &image);
    if (!gsf_code_payload(&coder, &image, gsf_workspace_in(&image.header, fuzz_scratch(&image.header))) ||
        coder.decoder.position < GSF_IMPLIED_BYTES)
        return size;
    const size_t end = coder.decoder.position - GSF_IMPLIED_BYTES;
    return end < size ? end : size;
}
