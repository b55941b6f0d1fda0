#include "golden_cases.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* ---- Pictures, in integer arithmetic --------------------------------------------------------------- */

/* A number of 16 bits for each place, as if random. */
static uint32_t noise_at(uint32_t x, uint32_t y, uint32_t k) {
    uint32_t n = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ k * 0xC2B2AE3Du;
    n = (n ^ n >> 15) * 0x2C1B3C6Du;
    return (n ^ n >> 12) >> 8 & 0xFFFF;
}

/* A wave of 16 bits that rises and falls by straight lines. */
static uint32_t triangle(uint32_t phase) {
    const uint32_t part = phase & 0x1FFFF;
    return part < 0x10000 ? part : 0x1FFFF - part;
}

static bool in_disc(uint32_t x, uint32_t y, uint32_t cx, uint32_t cy, uint32_t radius) {
    const int64_t dx = (int64_t)x - cx, dy = (int64_t)y - cy;
    return dx * dx + dy * dy < (int64_t)radius * radius;
}

/* A sky with a sun above ground with a texture. */
static uint32_t scene_at(uint32_t x, uint32_t y, uint32_t k, uint32_t w, uint32_t h) {
    static const uint32_t sun[4] = {65000, 60000, 20000, 65535}, top[4] = {12000, 20000, 50000, 65535};
    if (in_disc(x, y, w / 3, h / 4, 1 + h / 8))
        return sun[k];
    if (y < h / 2)
        return k == 3 ? 65535 - 40000 * y / h : top[k] + (60000 - top[k]) * y / h;
    return triangle(x * 19000 + y * 31000) / (2 + k) + noise_at(x, y, k) / 6 + 9000;
}

/* Discs and bars of one colour each on white. */
static uint32_t drawing_at(uint32_t x, uint32_t y, uint32_t k, uint32_t w, uint32_t h) {
    if (in_disc(x, y, w / 4, h / 2, 1 + h / 4))
        return k == 0 ? 60000 : 8000;
    if (x > w / 2 && x < w / 2 + 1 + w / 12)
        return k == 2 ? 50000 : 20000;
    if (y > 3 * h / 4 && (x + y) % 16 < 5)
        return 5000;
    return 65535;
}

static uint32_t sample_at(golden_picture_kind kind, uint32_t x, uint32_t y, uint32_t k, uint32_t w, uint32_t h) {
    switch (kind) {
    case SCENE:
        return scene_at(x, y, k, w, h);
    case DRAWING:
        return drawing_at(x, y, k, w, h);
    case STRIPES:
        return 20000 + triangle(x * 40000 + y * 21000) / 3 + 3000 * k;
    default:
        return 30000 + 5000 * k;
    }
}

static gscl_image make_picture(golden_picture_kind kind, uint32_t width, uint32_t height, uint32_t channels,
                               gscl_sample sample) {
    gscl_image image = {.width = width, .height = height, .channels = channels, .sample = sample};
    uint8_t *u8 = image.pixels = malloc((size_t)width * height * channels * sizeof(float));
    uint16_t *u16 = image.pixels;
    float *f32 = image.pixels;
    for (size_t i = 0; u8 && i < (size_t)width * height * channels; i++) {
        const uint32_t at = (uint32_t)(i / channels), k = (uint32_t)(i % channels);
        const bool is_alpha = channels % 2 == 0 && k + 1 == channels;
        const uint32_t value = sample_at(kind, at % width, at / width, is_alpha ? 3 : k, width, height);
        if (sample == GSCL_SAMPLE_U8)
            u8[i] = (uint8_t)(value >> 8);
        else if (sample == GSCL_SAMPLE_U16)
            u16[i] = (uint16_t)value;
        else
            f32[i] = (float)value / 65536.0f;
    }
    return image;
}

/* ---- Encodes --------------------------------------------------------------------------------------- */

#define BYTES(n) .target = GSCL_TARGET_BYTES, .value = n
#define PAPER .profile = GSCL_PROFILE_PAPER

const golden_case golden_cases[] = {
    {"rgb", SCENE, 96, 64, 3, 2, BYTES(600)},
    {"grey", SCENE, 80, 61, 1, 2, BYTES(400)},
    {"grey-alpha", SCENE, 65, 49, 2, 1, BYTES(400)},
    {"rgba", SCENE, 64, 64, 4, 1, BYTES(500)},
    {"default-target", SCENE, 256, 171, 3, 1, .target = GSCL_TARGET_AUTO},
    {"drawing", DRAWING, 120, 90, 3, 2, BYTES(500)},
    {"flat", FLAT, 40, 30, 3, 1, BYTES(100)},
    {"1x1", SCENE, 1, 1, 3, 5, BYTES(60)},
    {"1x17", SCENE, 1, 17, 1, 3, BYTES(60)},
    {"33x2", SCENE, 33, 2, 4, 2, BYTES(100)},
    {"16-bit", SCENE, 50, 40, 3, 1, BYTES(400), .sample = GSCL_SAMPLE_U16},
    {"float", SCENE, 50, 40, 2, 1, BYTES(400), .sample = GSCL_SAMPLE_F32},
    {"paper", SCENE, 64, 48, 3, 0, BYTES(900), PAPER},
    {"paper-grey", SCENE, 48, 64, 1, 1, BYTES(600), PAPER},
    {"paper-rgba", SCENE, 48, 48, 4, 0, BYTES(900), PAPER, .codebook_size = 32},
    {"paper-l2", SCENE, 64, 48, 3, 0, BYTES(900), PAPER, .loss = GSCL_LOSS_L2},
    {"blend-alpha", SCENE, 72, 56, 3, 1, BYTES(500), .blend = GSCL_BLEND_ALPHA},
    {"blend-sum", SCENE, 72, 56, 3, 2, BYTES(500), .blend = GSCL_BLEND_SUM},
    {"blend-sum-grey", STRIPES, 72, 56, 1, 1, BYTES(300), .blend = GSCL_BLEND_SUM},
    {"opacity", SCENE, 72, 56, 3, 1, BYTES(500), .effects_on = GSCL_EFFECT_OPACITY},
    {"alpha-opaque", SCENE, 72, 56, 3, 1, BYTES(500), .blend = GSCL_BLEND_ALPHA, .effects_off = GSCL_EFFECT_OPACITY},
    {"upright", SCENE, 72, 56, 3, 1, BYTES(500), .effects_off = GSCL_EFFECT_ROTATION},
    {"circles", DRAWING, 72, 56, 3, 1, BYTES(500), .effects_off = GSCL_EFFECT_ROTATION | GSCL_EFFECT_ANISOTROPY},
    {"no-chroma", SCENE, 72, 56, 3, 1, BYTES(400), .effects_off = GSCL_EFFECT_CHROMA},
    {"texture", STRIPES, 96, 72, 3, 3, BYTES(400), .effects_on = GSCL_EFFECT_TEXTURE},
    {"no-texture", STRIPES, 96, 72, 3, 3, BYTES(400), .effects_off = GSCL_EFFECT_TEXTURE},
    {"tune-psnr", SCENE, 90, 70, 3, 5, BYTES(300), .tune = GSCL_TUNE_PSNR},
    {"tune-ssim", SCENE, 90, 70, 3, 2, BYTES(700), .tune = GSCL_TUNE_SSIM},
    {"tune-visual", SCENE, 90, 70, 3, 3, BYTES(700), .tune = GSCL_TUNE_VISUAL},
    {"tune-visual-grey", SCENE, 90, 70, 1, 2, BYTES(500), .tune = GSCL_TUNE_VISUAL},
    {"loss-l1", SCENE, 60, 50, 3, 1, BYTES(500), .loss = GSCL_LOSS_L1},
    {"loss-l1-ssim", SCENE, 60, 50, 3, 1, BYTES(500), .loss = GSCL_LOSS_L1_SSIM},
    {"psnr", SCENE, 64, 48, 3, 1, .target = GSCL_TARGET_PSNR, .value = 22},
    {"bits-per-pixel", DRAWING, 200, 120, 3, 1, .target = GSCL_TARGET_BPP, .value = 0.2},
    {"splats", SCENE, 100, 100, 3, 2, .target = GSCL_TARGET_SPLATS, .value = 150},
    {"coarse-bare", SCENE, 60, 50, 3, 1, BYTES(400), .step_factor = 2, .bare = true},
    {"progressive", SCENE, 96, 64, 3, 2, BYTES(900), .progressive = true},
    {"tiny", SCENE, 128, 85, 3, 2, BYTES(150), .bare = true},
    {"packets", SCENE, 96, 64, 3, 1, BYTES(900), .packet_size = 150},
    {"quality", SCENE, 96, 64, 3, 1, .target = GSCL_TARGET_QUALITY, .value = 30},
    {"2-megapixels", SCENE, 1600, 1250, 3, 0, BYTES(12000)},
};
const size_t golden_case_count = sizeof golden_cases / sizeof *golden_cases;

const golden_case *golden_case_named(const char *name) {
    for (size_t i = 0; i < golden_case_count; i++)
        if (strcmp(golden_cases[i].name, name) == 0)
            return &golden_cases[i];
    return NULL;
}

gscl_result golden_open(gscl_context **context, int threads) {
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = GSCL_HOST_DEVICE;
    settings.threads = threads;
    return gscl_context_create(context, &settings);
}

static gscl_encode_settings settings_of(const golden_case *c) {
    gscl_encode_settings s;
    gscl_encode_settings_default(&s);
    s.profile = c->profile;
    s.blend = c->blend;
    s.loss = c->loss;
    s.tune = c->tune;
    s.target = c->target;
    s.target_value = c->value;
    s.effort = c->effort;
    s.effects_on = c->effects_on;
    s.effects_off = c->effects_off;
    s.codebook_size = c->codebook_size;
    s.step_factor = c->step_factor;
    s.bare = c->bare;
    s.progressive = c->progressive;
    s.packet_size = c->packet_size;
    return s;
}

gscl_image golden_picture(const golden_case *c) {
    return make_picture(c->kind, c->width, c->height, c->channels, c->sample ? c->sample : GSCL_SAMPLE_U8);
}

gscl_result golden_encode(gscl_context *context, const golden_case *c, golden_file *file) {
    gscl_encode_report report = {.struct_size = sizeof report};
    const gscl_encode_settings settings = settings_of(c);
    gscl_image image = golden_picture(c);
    *file = (golden_file){NULL, 0, 0};
    if (!image.pixels)
        return GSCL_ERROR_OUT_OF_MEMORY;
    const gscl_result result = gscl_encode(context, &image, &settings, &file->bytes, &file->size, &report);
    free(image.pixels);
    file->psnr = report.psnr;
    return result;
}

uint64_t golden_hash(const golden_file *file) {
    uint64_t hash = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < file->size; i++)
        hash = (hash ^ file->bytes[i]) * UINT64_C(1099511628211);
    return hash;
}
