/* Gives hostile packets, of a list as in the target `packets`, to a decoder one by one, and draws what it takes; then the bytes of
 * the list or file in two pieces, of which it draws what a decode of a prefix draws. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "mutator.h"
#include "sample.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What is drawn: most of what takes long is left to a sample of the inputs. */
#define USUAL_PIXELS 200u
#define USUAL_WORK 20000u
#define USUAL_SPLATS 40u
#define MAX_PIXELS 3000u
#define MAX_WORK 200000u
#define MAX_SPLATS 3000u

static gscl_context *context;
static bool is_sampled; /* this input */

static void require(bool condition, const char *message) {
    if (!condition) {
        fprintf(stderr, "fuzz: %s\n", message);
        abort();
    }
}

static void open_context(void) {
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = GSCL_HOST_DEVICE;
    if (!context)
        require(gscl_context_create(&context, &settings) == GSCL_OK, "there is no context");
}

static gscl_decode_settings limited(void) {
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    settings.max_pixels = is_sampled ? MAX_PIXELS : USUAL_PIXELS;
    settings.max_work = is_sampled ? MAX_WORK : USUAL_WORK;
    settings.partial = true;
    return settings;
}

static uint32_t max_splats(void) {
    return is_sampled ? MAX_SPLATS : USUAL_SPLATS;
}

static gscl_decoder *new_decoder(void) {
    gscl_decoder *decoder = NULL;
    const gscl_decode_settings settings = limited();
    require(gscl_decoder_create(&decoder, &settings) == GSCL_OK, "a decoder cannot be created");
    return decoder;
}

/* What a refused packet leaves as it is. */
static void require_unchanged(const gscl_decoder_state *before, const gscl_decoder *decoder) {
    gscl_decoder_state after = {.struct_size = sizeof after};
    const gscl_result result = gscl_decoder_inspect(decoder, &after);
    require(result == GSCL_OK ? before->drawn == after.drawn && before->received == after.received &&
                                    before->splats == after.splats && before->bytes == after.bytes
                              : before->received == 0,
            "a refused packet changes the picture");
}

/* Draws a picture that is small enough. */
static void draw(gscl_decoder *decoder, const gscl_decoder_state *state) {
    gscl_image image = {0};
    const gscl_result result = gscl_decoder_draw(decoder, context, &image);
    require(result == (state->drawn == 0 ? GSCL_ERROR_TRUNCATED : GSCL_OK) || result == GSCL_ERROR_LIMIT,
            "packets cannot be drawn");
    gscl_free(image.pixels);
}

static void add_packets(const uint8_t *list, size_t size) {
    gscl_decoder *decoder = new_decoder();
    gscl_decoder_state state = {.struct_size = sizeof state};
    const uint8_t *packet;
    size_t position = 0, packet_size;
    while (gscl_next_packet(list, size, &position, &packet, &packet_size)) {
        gscl_packet_info info = {.struct_size = sizeof info};
        const gscl_result probed = gscl_packet_probe(packet, packet_size, &info);
        const gscl_result result = probed == GSCL_OK && info.splats > max_splats()
                                       ? GSCL_ERROR_CORRUPT
                                       : gscl_decoder_add_packet(decoder, packet, packet_size);
        require(probed == GSCL_OK || result == probed, "a packet is taken whose header cannot be read");
        if (result != GSCL_OK)
            require_unchanged(&state, decoder);
        else
            require(gscl_decoder_inspect(decoder, &state) == GSCL_OK, "what was taken cannot be inspected");
    }
    if (state.received > 0)
        draw(decoder, &state);
    gscl_decoder_free(&decoder);
}

/* Draws what has come of a file, as a decode does. */
static void compare_with_decode(gscl_decoder *decoder, const uint8_t *bytes, size_t size) {
    const gscl_decode_settings settings = limited();
    gscl_image drawn = {0}, decoded = {0};
    const gscl_result result = gscl_decoder_draw(decoder, context, &drawn);
    require(result == gscl_decode(context, bytes, size, &settings, &decoded), "a decoder has another result");
    if (result == GSCL_OK)
        require(memcmp(drawn.pixels, decoded.pixels, (size_t)drawn.width * drawn.height * drawn.channels) == 0,
                "a decoder draws another picture");
    gscl_free(drawn.pixels);
    gscl_free(decoded.pixels);
}

static void add_bytes(const uint8_t *bytes, size_t size) {
    gscl_decoder *decoder = new_decoder();
    const size_t half = size / 2;
    require(gscl_decoder_add_bytes(decoder, bytes, half) == GSCL_OK, "bytes cannot be added");
    compare_with_decode(decoder, bytes, half);
    require(gscl_decoder_add_bytes(decoder, bytes + half, size - half) == GSCL_OK, "bytes cannot be added");
    compare_with_decode(decoder, bytes, size);
    gscl_decoder_free(&decoder);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    gscl_info info = {.struct_size = sizeof info};
    open_context();
    is_sampled = fuzz_is_sampled(data, size, 32);
    add_packets(data, size);
    if (size > 1 && fuzz_is_sampled(data, size, 8) &&
        (gscl_probe(data, size, NULL, &info) != GSCL_OK || info.splats <= max_splats()))
        add_bytes(data, size);
    return 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    return fuzz_mutate_packets(data, size, max_size, seed);
}
