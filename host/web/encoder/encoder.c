/* The encoder as a WebAssembly module, for encode-run.js: the library, whose threads are workers.
 *
 * An instance encodes one picture: encoder_allocate for its pixels, encoder_settings to fill in, encoder_encode, and then what
 * encoder_values has. */
#include <gscl/gscl.h>
#include <stdbool.h>
#include <stdlib.h>

#define EXPORT(name) __attribute__((export_name(name)))

/* The numbers that encode-run.js writes and those that it reads, in this order. */
enum setting {
    WIDTH,
    HEIGHT,
    CHANNELS,
    SAMPLE,
    PREMULTIPLIED,
    TARGET,
    TARGET_VALUE,
    EFFORT,
    TUNE,
    SEED,
    BARE,
    PROGRESSIVE,
    PACKET_SIZE,
    PACKET_COUNT,
    PACKET_IDENTITY,
    PACKET_LOSS,
    THREADS,
    SETTINGS
};
enum value { BYTES, SIZE, SPLATS, PSNR, SSIMULACRA2, TRIALS, MESSAGE, VALUES };

static double settings[SETTINGS], values[VALUES];

/* Of encode-run.js. */
__attribute__((import_module("gscl"), import_name("progress"))) void
host_progress(double fraction, double psnr, uint32_t splats, double elapsed_s, double remaining_s);

EXPORT("allocate") void *encoder_allocate(size_t size);
EXPORT("settings") double *encoder_settings(void);
EXPORT("encode") gscl_result encoder_encode(void *pixels);
EXPORT("values") const double *encoder_values(void);

void *encoder_allocate(size_t size) {
    return malloc(size);
}

double *encoder_settings(void) {
    return settings;
}

const double *encoder_values(void) {
    return values;
}

static bool report_progress(void *opaque, const gscl_progress *p) {
    (void)opaque;
    host_progress(p->fraction, p->psnr, p->splats, p->elapsed_s, p->remaining_s);
    return true;
}

static gscl_encode_settings encode_settings(void) {
    gscl_encode_settings s;
    gscl_encode_settings_default(&s);
    s.target = (gscl_target)settings[TARGET];
    s.target_value = settings[TARGET_VALUE];
    s.effort = (int)settings[EFFORT];
    s.tune = (gscl_tune)settings[TUNE];
    s.seed = (uint64_t)settings[SEED];
    s.bare = settings[BARE] != 0;
    s.progressive = settings[PROGRESSIVE] != 0;
    s.packet_size = (uint32_t)settings[PACKET_SIZE];
    s.packet_count = (uint32_t)settings[PACKET_COUNT];
    s.packet_identity = (uint32_t)settings[PACKET_IDENTITY];
    s.packet_loss = settings[PACKET_LOSS];
    s.progress = report_progress;
    return s;
}

static gscl_result encode(gscl_context *context, void *pixels) {
    const gscl_encode_settings s = encode_settings();
    const gscl_image image = {.width = (uint32_t)settings[WIDTH],
                              .height = (uint32_t)settings[HEIGHT],
                              .channels = (uint32_t)settings[CHANNELS],
                              .sample = (gscl_sample)settings[SAMPLE],
                              .premultiplied = settings[PREMULTIPLIED] != 0,
                              .pixels = pixels};
    gscl_encode_report report = {.struct_size = sizeof report};
    uint8_t *bytes;
    size_t size;
    const gscl_result result = gscl_encode(context, &image, &s, &bytes, &size, &report);
    if (result != GSCL_OK)
        return result;
    values[BYTES] = (double)(uintptr_t)bytes;
    values[SIZE] = (double)size;
    values[SPLATS] = report.splats;
    values[PSNR] = report.psnr;
    values[SSIMULACRA2] = report.ssimulacra2;
    values[TRIALS] = report.trials;
    return GSCL_OK;
}

/* Nothing is freed: the instance is dropped. */
gscl_result encoder_encode(void *pixels) {
    gscl_context *context;
    gscl_context_settings s;
    gscl_context_settings_default(&s);
    s.threads = (int)settings[THREADS];
    gscl_result result = gscl_context_create(&context, &s);
    if (result == GSCL_OK)
        result = encode(context, pixels);
    values[MESSAGE] = (double)(uintptr_t)gscl_context_message(context);
    return result;
}
