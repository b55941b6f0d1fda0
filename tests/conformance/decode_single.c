/* Decodes files by rows in single precision, with the words and the output of codes.c:
 *
 *     decode_single decode-single whole|bare FOLDER FILE...
 *     decode_single decoders
 *
 * It is not linked with the library, but with the sources of such a decoder, compiled with GSCL_SINGLE_PRECISION. */
#include <gscl/gscl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_FILE (1u << 24) /* bytes */
#define STRIP_ROWS 16

static const char *result_name(gscl_result result) {
    switch (result) {
    case GSCL_OK:
        return "valid";
    case GSCL_ERROR_NOT_GSCL:
        return "not-a-gscl-file";
    case GSCL_ERROR_NEWER_VERSION:
        return "newer-version";
    case GSCL_ERROR_TRUNCATED:
        return "truncated";
    case GSCL_ERROR_DAMAGED:
        return "damaged";
    case GSCL_ERROR_CORRUPT:
        return "corrupt";
    case GSCL_ERROR_UNKNOWN_BLOCK:
        return "unknown-block";
    default:
        return gscl_result_text(result);
    }
}

/* Writes samples, those of 16 bits with the low byte first. */
static bool write_strip(void *out, uint32_t y, const gscl_image *strip) {
    const size_t samples = (size_t)strip->width * strip->height * strip->channels;
    (void)y;
    for (size_t i = 0; i < samples; i++) {
        uint16_t sample = ((const uint8_t *)strip->pixels)[i];
        if (strip->sample == GSCL_SAMPLE_U16)
            memcpy(&sample, (const uint8_t *)strip->pixels + 2 * i, sizeof sample);
        putc(sample & 255, out);
        if (strip->sample == GSCL_SAMPLE_U16)
            putc(sample >> 8, out);
    }
    return true;
}

/* `image` receives the kind of the picture. */
static gscl_result decode(const uint8_t *bytes, size_t size, bool bare, FILE *out, gscl_image *image) {
    gscl_decode_settings settings;
    size_t needed;
    gscl_decode_settings_default(&settings);
    settings.bare = bare;
    gscl_result result = gscl_rows_memory(bytes, size, &settings, STRIP_ROWS, image, &needed);
    if (result != GSCL_OK)
        return result;
    void *memory = malloc(needed);
    result = memory ? gscl_decode_rows(bytes, size, &settings, STRIP_ROWS, memory, needed, write_strip, out)
                    : GSCL_ERROR_OUT_OF_MEMORY;
    free(memory);
    return result;
}

static void decode_file(const char *path, bool bare, const char *folder, int number) {
    static uint8_t bytes[MAX_FILE];
    char name[1000];
    gscl_image image;
    snprintf(name, sizeof name, "%s/%d.raw", folder, number);
    FILE *in = fopen(path, "rb"), *out = fopen(name, "wb");
    if (!in || !out) {
        perror(path);
        exit(EXIT_FAILURE);
    }
    const size_t size = fread(bytes, 1, sizeof bytes, in);
    const gscl_result result = decode(bytes, size, bare, out, &image);
    printf("file %s %s", path, result_name(result));
    if (result == GSCL_OK)
        printf(" %u %u %u %u", (unsigned)image.width, (unsigned)image.height, (unsigned)image.channels,
               image.sample == GSCL_SAMPLE_U8 ? 8u : 16u);
    putchar('\n');
    fclose(in);
    fclose(out);
}

int main(int count, char **words) {
    if (count == 2 && strcmp(words[1], "decoders") == 0)
        puts("decode-single");
    for (int i = 4; i < count; i++)
        decode_file(words[i], strcmp(words[2], "bare") == 0, words[3], i - 4);
    return 0;
}
