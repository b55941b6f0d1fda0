/* Whole encodes of hard images: every blend, the paper's profile and the tuning for SSIM, in both mappings. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/measure.h>

#include "both_mappings.h"
#include "decodes.h"
#include "decode/coded_image.h"
#include "report.h"
#include "scene.h"

#define BYTES 160 /* of a file, at most */
/* The error that a file may have beyond that of the mean colour alone, which needs no splat: in dB, and the
 * rounding of the background and of samples.  In `sum`, overlapping splats also add the rounding of their colours,
 * whose codes are 1/32 apart; the bound allows for three overlapping splats. */
#define WORST_GAIN_DB 0.1
#define ROUNDING_MSE 1.0
#define SUM_MSE (3.0 * (255.0 / 64.0) * (255.0 / 64.0))

/* A way to encode. */
typedef struct {
    const char *name;
    gscl_profile profile;
    gscl_blend blend;
    gscl_tune tune;
} mode;

static const mode modes[] = {
    {"normalized", GSCL_PROFILE_DEFAULT, GSCL_BLEND_NORMALIZED, GSCL_TUNE_PSNR},
    {"alpha", GSCL_PROFILE_DEFAULT, GSCL_BLEND_ALPHA, GSCL_TUNE_PSNR},
    {"sum", GSCL_PROFILE_DEFAULT, GSCL_BLEND_SUM, GSCL_TUNE_PSNR},
    {"tuned for SSIM", GSCL_PROFILE_DEFAULT, GSCL_BLEND_NORMALIZED, GSCL_TUNE_SSIM},
    {"tuned for what people see", GSCL_PROFILE_DEFAULT, GSCL_BLEND_NORMALIZED, GSCL_TUNE_VISUAL},
    {"paper", GSCL_PROFILE_PAPER, GSCL_BLEND_ALPHA, GSCL_TUNE_PSNR},
};
#define MODES (sizeof modes / sizeof *modes)

static void *allocate(size_t size) {
    void *memory = calloc(size + 1, 1);
    assert_non_null(memory);
    return memory;
}

/* 16 bits a sample, so that steps of 1/65535 are resolved. */
static gscl_image image_of(const scene *s) {
    const size_t pixels = (size_t)s->width * (size_t)s->height;
    uint16_t *samples = allocate(pixels * SCENE_CHANNELS * sizeof *samples);
    for (size_t i = 0; i < pixels * SCENE_CHANNELS; i++)
        samples[i] = (uint16_t)(s->target[i % SCENE_CHANNELS * pixels + i / SCENE_CHANNELS] * 65535.0f + 0.5f);
    return (gscl_image){.width = (uint32_t)s->width,
                        .height = (uint32_t)s->height,
                        .channels = SCENE_CHANNELS,
                        .sample = GSCL_SAMPLE_U16,
                        .pixels = samples};
}

/* The mean squared error of the best single colour, for samples in 0..255. */
static double flat_mse(const gscl_image *image) {
    const uint16_t *samples = image->pixels;
    const size_t pixels = (size_t)image->width * image->height;
    double sum = 0.0;
    for (int k = 0; k < SCENE_CHANNELS; k++) {
        double mean = 0.0;
        for (size_t i = 0; i < pixels; i++)
            mean += samples[i * SCENE_CHANNELS + (size_t)k] / 257.0 / (double)pixels;
        for (size_t i = 0; i < pixels; i++)
            sum += pow(samples[i * SCENE_CHANNELS + (size_t)k] / 257.0 - mean, 2.0);
    }
    return sum / (double)(pixels * SCENE_CHANNELS);
}

static void check_words_used(const uint8_t *bytes, size_t size) {
    gscl_coded_image p;
    bool used[2][GSF_MAX_CODEBOOK] = {{false}};
    assert_int_equal(gscl_coded_image_read(&p, bytes, size, false), GSCL_OK);
    for (uint32_t i = 0; i < p.file.header.splat_count; i++)
        used[0][p.file.indexed[i].shape] = used[1][p.file.indexed[i].colour] = true;
    for (uint16_t k = 0; p.file.header.splat_count > 0 && k < GSF_MAX_CODEBOOK; k++)
        if ((k < p.file.codebooks.shape_count && !used[0][k]) || (k < p.file.codebooks.colour_count && !used[1][k]))
            fail_msg("word %u of a codebook has no splat", k);
    gscl_coded_image_free(&p);
}

static void encode_in_mode(gscl_context *context, const gscl_image *image, const mode *m, uint8_t **bytes,
                           size_t *size) {
    gscl_encode_settings settings;
    gscl_encode_settings_default(&settings);
    settings.profile = m->profile;
    settings.blend = m->blend;
    settings.tune = m->tune;
    settings.target = GSCL_TARGET_BYTES;
    settings.target_value = BYTES;
    settings.effort = m->profile == GSCL_PROFILE_PAPER ? 0 : 1;
    if (gscl_encode(context, image, &settings, bytes, size, NULL) != GSCL_OK)
        fail_msg("%s: %s", m->name, gscl_context_message(context));
    assert_in_range(*size, 1, BYTES);
}

static void check_quality(gscl_context *context, const scene *s, const gscl_image *image, const mode *m,
                          const char *mapping, const uint8_t *bytes, size_t size) {
    gscl_image decoded = {0};
    gscl_comparison c = {.struct_size = sizeof c};
    char detail[60];
    assert_int_equal(gscl_decode(context, bytes, size, NULL, &decoded), GSCL_OK);
    assert_int_equal(gscl_compare(image, &decoded, &c), GSCL_OK);
    gscl_free(decoded.pixels);
    const double bound =
        flat_mse(image) * pow(10.0, WORST_GAIN_DB / 10.0) + (m->blend == GSCL_BLEND_SUM ? SUM_MSE : ROUNDING_MSE);
    snprintf(detail, sizeof detail, "%s, %s", m->name, mapping);
    report("encode", s->name, detail, "mean squared error, of the mean colour's", bound, c.mse);
    if (!(isfinite(c.mse) && c.mse <= bound))
        fail_msg("%s: the mean squared error is %g, at most %g expected", detail, c.mse, bound);
}

static void check_encode(const scene *s, const gscl_image *image, const mode *m, int mapping) {
    uint8_t *bytes[2] = {NULL, NULL};
    size_t sizes[2];
    char message[200];
    for (int i = 0; i < 2; i++)
        encode_in_mode(contexts[mapping], image, m, &bytes[i], &sizes[i]);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    if (!decodes_alike(contexts, decoder_count, bytes[0], sizes[0], message, sizeof message))
        fail_msg("%s, %s mapping: %s", m->name, mapping_names[mapping], message);
    check_quality(contexts[mapping], s, image, m, mapping_names[mapping], bytes[0], sizes[0]);
    if (m->profile == GSCL_PROFILE_PAPER)
        check_words_used(bytes[0], sizes[0]);
    gscl_free(bytes[0]);
    gscl_free(bytes[1]);
}

static void synthetic_image(void **state) {
    static scene s;
    const scene_case *c = *state;
    scene_begin(&s, c->name, 0);
    c->make(&s);
    gscl_image image = image_of(&s);
    for (size_t i = 0; i < MODES; i++)
        for (int mapping = 0; mapping < (int)scene_scaled((size_t)mapping_count, 1); mapping++)
            check_encode(&s, &image, &modes[i], mapping);
    free(image.pixels);
}

int main(void) {
    static struct CMUnitTest tests[40];
    static scene_case cases[40];
    size_t count = 0;
    for (; image_cases[count].name; count++) {
        cases[count] = image_cases[count];
        tests[count] = (struct CMUnitTest){image_cases[count].name, synthetic_image, NULL, NULL, &cases[count]};
    }
    return _cmocka_run_group_tests("encodes", tests, count, open_contexts, close_contexts);
}
