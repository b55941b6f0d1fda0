/* Encodes an image made in memory, decodes it again and prints its PSNR.
 *     cc -std=c99 encode_decode.c $(pkg-config --cflags --libs gscl) */
#include <stdio.h>
#include <stdlib.h>

#include <gscl/gscl.h>
#include <gscl/measure.h>

static void require(gscl_context *context, gscl_result result) {
    if (result != GSCL_OK) {
        fprintf(stderr, "%s %s\n", gscl_result_text(result), context ? gscl_context_message(context) : "");
        exit(EXIT_FAILURE);
    }
}

int main(void) {
    static unsigned char pixels[64][96][3]; /* a red disc on a blue gradient */
    for (int y = 0; y < 64; y++)
        for (int x = 0; x < 96; x++) {
            const int inside = (x - 48) * (x - 48) + (y - 32) * (y - 32) < 400;
            pixels[y][x][0] = inside ? 220 : 20;
            pixels[y][x][1] = (unsigned char)(40 + y);
            pixels[y][x][2] = (unsigned char)(inside ? 60 : 100 + x);
        }
    const gscl_image image = {.width = 96, .height = 64, .channels = 3, .sample = GSCL_SAMPLE_U8, .pixels = pixels};

    gscl_context *context = NULL;
    require(context, gscl_context_create(&context, NULL));
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.target = GSCL_TARGET_BYTES;
    settings.target_value = 400;
    uint8_t *bytes = NULL;
    size_t size = 0;
    require(context, gscl_encode(context, &image, &settings, &bytes, &size, NULL));
    gscl_image decoded = {0};
    require(context, gscl_decode(context, bytes, size, NULL, &decoded));
    gscl_comparison comparison = {.struct_size = sizeof comparison};
    require(context, gscl_compare(&image, &decoded, &comparison));
    printf("%zu bytes, %.2f dB\n", size, comparison.psnr);

    gscl_free(decoded.pixels);
    gscl_free(bytes);
    gscl_context_free(&context);
    return size <= 400 && comparison.psnr > 20 ? EXIT_SUCCESS : EXIT_FAILURE;
}
