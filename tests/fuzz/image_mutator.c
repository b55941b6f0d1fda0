#include "mutator.h"

#include <string.h>

#include <zlib.h>

#define SIGNATURE_SIZE 8u
#define CHUNK_OVERHEAD 12u /* length, name, checksum */

static const uint8_t SIGNATURE[SIGNATURE_SIZE] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

static uint32_t get32(const uint8_t *b) {
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static void put32(uint8_t *b, uint32_t value) {
    for (int i = 0; i < 4; i++)
        b[i] = (uint8_t)(value >> (24 - 8 * i));
}

/* The size of the chunk at a place; 0 where it does not fit. */
static size_t chunk_size(const uint8_t *data, size_t size, size_t at) {
    if (size - at < CHUNK_OVERHEAD)
        return 0;
    const size_t length = get32(data + at);
    return length <= size - at - CHUNK_OVERHEAD ? length + CHUNK_OVERHEAD : 0;
}

static void seal_chunks(uint8_t *data, size_t size) {
    for (size_t at = SIGNATURE_SIZE, whole; (whole = chunk_size(data, size, at)) > 0; at += whole) {
        const size_t named = whole - CHUNK_OVERHEAD + 4;
        put32(data + at + 4 + named, (uint32_t)crc32(0, data + at + 4, (uInt)named));
    }
}

/* Changes the content of one chunk, the `index`th, whose length is adjusted. */
static size_t mutate_chunk(uint8_t *data, size_t size, size_t max_size, unsigned index) {
    static uint8_t after[1u << 16];
    size_t at = SIGNATURE_SIZE, whole = chunk_size(data, size, at);
    for (unsigned i = 0; i < index && whole > 0 && chunk_size(data, size, at + whole) > 0; i++) {
        at += whole;
        whole = chunk_size(data, size, at);
    }
    const size_t rest = whole > 0 ? size - at - whole + 4 : sizeof after + 1; /* with the checksum */
    if (rest > sizeof after || max_size < size + 1)
        return LLVMFuzzerMutate(data, size, max_size);
    memcpy(after, data + size - rest, rest);
    const size_t room = max_size - (at + 8) - rest;
    const size_t now = LLVMFuzzerMutate(data + at + 8, whole - CHUNK_OVERHEAD, room);
    put32(data + at, (uint32_t)now);
    memcpy(data + at + 8 + now, after, rest);
    return at + 8 + now + rest;
}

size_t fuzz_mutate_image(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    if (size < SIGNATURE_SIZE || memcmp(data, SIGNATURE, SIGNATURE_SIZE) != 0)
        return LLVMFuzzerMutate(data, size, max_size);
    size = seed % 4 ? mutate_chunk(data, size, max_size, seed / 4 % 8) : LLVMFuzzerMutate(data, size, max_size);
    if (size >= SIGNATURE_SIZE && memcmp(data, SIGNATURE, SIGNATURE_SIZE) == 0 && seed / 32 % 16)
        seal_chunks(data, size);
    return size;
}
