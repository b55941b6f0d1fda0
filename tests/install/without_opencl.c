/* Uses a library that only decodes: decodes tests/conformance/files/example.gscl and asks for what the library lacks. */
#include <stdio.h>
#include <string.h>

#include <gscl/gscl.h>
#include <gscl/measure.h>

static int failures;

static void expect(int fulfilled, const char *what) {
    if (!fulfilled) {
        printf("not so: %s\n", what);
        failures++;
    }
}

/* Samples of FORMAT.md, "Example". */
static void check_picture(const gscl_image *image) {
    static const uint8_t samples[][5] = {
        {0, 0, 123, 65, 54}, {3, 3, 126, 78, 66}, {6, 4, 141, 135, 120}, {8, 5, 154, 183, 167}, {11, 7, 161, 209, 191}};
    expect(image->width == 12 && image->height == 8 && image->channels == 3, "the picture has 12x8 pixels");
    for (size_t i = 0; i < sizeof samples / sizeof *samples && failures == 0; i++)
        for (int k = 0; k < 3; k++) {
            const int found = ((const uint8_t *)image->pixels)[(samples[i][1] * 12 + samples[i][0]) * 3 + k];
            expect(found - samples[i][2 + k] >= -1 && found - samples[i][2 + k] <= 1, "a sample is that of FORMAT.md");
        }
}

static void check_refusals(const uint8_t *bytes, size_t size) {
    gscl_context *context = NULL;
    gscl_image image = {0};
    gscl_context_settings settings;
    gscl_device_info *devices;
    gscl_context_settings_default(&settings);
    settings.device = "0.0";
    expect(gscl_context_create(&context, &settings) == GSCL_ERROR_NO_ENCODER, "another device is refused");
    expect(strstr(gscl_context_message(context), "built without OpenCL") != NULL, "the message says why");
    expect(gscl_decode(context, bytes, size, NULL, &image) == GSCL_ERROR_INVALID_ARGUMENT,
           "its context does not decode");
    expect(image.pixels == NULL, "there are no pixels");
    expect(gscl_list_devices(&devices) == GSCL_ERROR_NO_ENCODER, "there is no list of devices");
    gscl_context_free(&context);
}

int main(int count, char **words) {
    uint8_t bytes[1024], *encoded = NULL;
    FILE *file = count > 1 ? fopen(words[1], "rb") : NULL;
    size_t size = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    const size_t file_size = size;
    gscl_context *context = NULL;
    gscl_image image = {0};
    gscl_info info = {.struct_size = sizeof info};
    expect(gscl_context_create(&context, NULL) == GSCL_OK, "a context can be created");
    expect(strcmp(gscl_context_device(context)->id, GSCL_HOST_DEVICE) == 0, "its device is host");
    expect(gscl_probe(bytes, size, NULL, &info) == GSCL_OK && info.width == 12, "the file can be probed");
    expect(gscl_inspect(bytes, size, NULL, &info) == GSCL_OK && info.splats == 2, "the file can be inspected");
    expect(gscl_decode(context, bytes, size, NULL, &image) == GSCL_OK, "the file can be decoded");
    if (failures == 0)
        check_picture(&image);
    expect(gscl_encode(context, &image, NULL, &encoded, &size, NULL) == GSCL_ERROR_NO_ENCODER, "encoding is refused");
    expect(strstr(gscl_context_message(context), "encoding needs") != NULL,
           "the message says that encoding needs kernels");
    check_refusals(bytes, file_size);
    gscl_free(image.pixels);
    gscl_context_free(&context);
    if (file)
        fclose(file);
    return failures > 0;
}
