/* Writes what the encoder for web pages is to write: golden_files FOLDER
 *
 * For each case of unit/golden_cases.h that the module can encode, and that takes it no more than seconds: NAME.raw, the samples,
 * NAME.gscl, the file of the library on a processor without a fused multiply-add, and a line of JSON with the settings on standard
 * output.  Writes nothing where the library has no kernels for such a processor, or this is none that runs them. */
#include <stdio.h>
#include <stdlib.h>

#include <gscl/gscl.h>

#include "native/processor.h"
#include "unit/golden_cases.h"

#define PROCESSOR "x86_64_v2"
#define MAX_PIXELS 100000

/* The module has the kernels of these. */
static bool can_encode(const golden_case *c) {
    return c->profile == GSCL_PROFILE_DEFAULT && c->blend == GSCL_BLEND_AUTO && c->loss == GSCL_LOSS_AUTO &&
           c->tune != GSCL_TUNE_SSIM && !c->effects_on && !c->effects_off && !(c->step_factor > 0) &&
           c->width * c->height <= MAX_PIXELS;
}

static bool write_file(const char *folder, const char *name, const char *end, const void *bytes, size_t size) {
    char path[4096];
    const int length = snprintf(path, sizeof path, "%s/%s%s", folder, name, end);
    FILE *file = length > 0 && (size_t)length < sizeof path ? fopen(path, "wb") : NULL;
    const bool good = file && fwrite(bytes, 1, size, file) == size;
    return file && fclose(file) == 0 && good;
}

static size_t sample_size(gscl_sample sample) {
    return sample == GSCL_SAMPLE_F32 ? sizeof(float) : sample == GSCL_SAMPLE_U16 ? sizeof(uint16_t) : 1;
}

static bool write_case(gscl_context *context, const char *folder, const golden_case *c) {
    golden_file file;
    gscl_image image = golden_picture(c);
    const size_t size = (size_t)c->width * c->height * c->channels * sample_size(image.sample);
    bool good = image.pixels && golden_encode(context, c, &file) == GSCL_OK;
    if (good) {
        good = write_file(folder, c->name, ".raw", image.pixels, size) &&
               write_file(folder, c->name, ".gscl", file.bytes, file.size);
        gscl_free(file.bytes);
    }
    free(image.pixels);
    printf("{\"name\": \"%s\", \"width\": %u, \"height\": %u, \"channels\": %u, \"sample\": %d, \"effort\": %d, "
           "\"target\": %d, "
           "\"value\": %g, \"tune\": %d, \"bare\": %s, \"progressive\": %s, \"packetSize\": %u}\n",
           c->name, c->width, c->height, c->channels, (int)image.sample, c->effort, (int)c->target, c->value,
           (int)c->tune, c->bare ? "true" : "false", c->progressive ? "true" : "false", c->packet_size);
    return good;
}

int main(int argc, char **argv) {
    gscl_context *context;
    if (argc != 2) {
        fprintf(stderr, "usage: golden_files FOLDER\n");
        return 2;
    }
    if (!gscl_native_processor_force(PROCESSOR))
        return 0;
    bool good = golden_open(&context, 1) == GSCL_OK;
    for (size_t i = 0; i < golden_case_count && good; i++)
        good = !can_encode(&golden_cases[i]) || write_case(context, argv[1], &golden_cases[i]);
    if (!good)
        fprintf(stderr, "golden_files: %s\n", gscl_context_message(context));
    gscl_context_free(&context);
    return good ? 0 : 1;
}
