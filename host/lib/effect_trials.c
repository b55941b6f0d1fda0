/* Trials of effects: encodes of a smaller copy of the image, with an effect and without. */
#include <math.h>
#include <stdlib.h>

#include "box_blur.h"
#include "effects.h"
#include "timing.h"

#define TRIAL_LEVEL 2     /* of the pyramid: a quarter of the size, */
#define TRIAL_SIDE 64     /* or more, so that the shorter side has so many pixels */
#define BITS_PER_SPLAT 34 /* about */
#define LOOK_LEVEL 1      /* at which the image is looked at */
#define COHERENT 0.3      /* images whose edges agree less on a direction may do without ellipses */
#define WINDOW 0.6        /* in which they are to agree: its radius, in distances from splat to splat */
#define OPACITY_GAIN 0.2  /* dB that opacity must show */
#define LEAST_BYTES 100   /* smaller files have nothing to try */
#define FAINT (8.0 / 255) /* root mean square of colour differences, up to which grey may do */

/* One plane of the image at a level, the mean of all channels. */
typedef struct field {
    int width, height;
    float *values;
} field;

/* ---- How well the directions of edges agree ---- */

/* The structure tensor: gx gx - gy gy, 2 gx gy and gx gx + gy gy at each pixel. */
typedef struct tensor {
    float *difference, *mixed, *sum;
} tensor;

static void tensor_of(const field *f, tensor *t) {
    for (int y = 0; y < f->height; y++)
        for (int x = 0; x < f->width; x++) {
            int left = x ? x - 1 : x, right = x < f->width - 1 ? x + 1 : x;
            int up = y ? y - 1 : y, down = y < f->height - 1 ? y + 1 : y;
            float gx = f->values[y * f->width + right] - f->values[y * f->width + left];
            float gy = f->values[down * f->width + x] - f->values[up * f->width + x];
            size_t at = (size_t)y * (size_t)f->width + (size_t)x;
            t->difference[at] = gx * gx - gy * gy;
            t->mixed[at] = 2 * gx * gy;
            t->sum[at] = gx * gx + gy * gy;
        }
}

/* `planes`: room for three of the field's size; `line`: for its longer side.  1: in each window all edges have one direction; 0: all directions are there alike. */
static double coherence(const field *f, int radius, float *planes, double *line) {
    size_t pixels = (size_t)f->width * (size_t)f->height;
    tensor t = {planes, planes + pixels, planes + 2 * pixels};
    double directed = 0, all = 0;
    tensor_of(f, &t);
    for (int i = 0; i < 3; i++)
        gscl_box_blur(planes + (size_t)i * pixels, f->width, f->height, radius, line);
    for (size_t i = 0; i < pixels; i++) {
        directed += hypot(t.difference[i], t.mixed[i]);
        all += t.sum[i];
    }
    return all > 0 ? directed / all : 0;
}

/* ---- Looking at the image ---- */

static gscl_result look_at_shapes(const gscl_encoder *e, double splats, double *coherent) {
    int level = e->first_level + LOOK_LEVEL;
    field f = {(int)gscl_level_size(e->image->width, level), (int)gscl_level_size(e->image->height, level), NULL};
    size_t pixels = (size_t)f.width * (size_t)f.height, longer = (size_t)(f.width > f.height ? f.width : f.height);
    float *planes = malloc(4 * pixels * sizeof *planes);
    double *line = malloc(longer * sizeof *line);
    bool there = planes && line;
    if (there) {
        f.values = planes + 3 * pixels;
        gscl_image_to_planes(e->image, 1, false, level, f.values);
        *coherent = coherence(&f, (int)rint(WINDOW * sqrt((double)pixels / fmax(splats, 1))) + 1, planes, line);
    }
    free(planes);
    free(line);
    return there ? GSCL_OK : gscl_fail(e->context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
}

/* Root mean square of the colours' differences from grey. */
static double colourfulness(const gscl_encoder *e) {
    size_t pixels = e->pixels;
    double sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        double r = e->planes[i], g = e->planes[pixels + i], b = e->planes[2 * pixels + i], mean = (r + g + b) / 3;
        sum += (r - mean) * (r - mean) + (g - mean) * (g - mean) + (b - mean) * (b - mean);
    }
    return sqrt(sum / (3 * (double)pixels));
}

/* ---- Trials ---- */

/* The image at a quarter of its size, or what is left at TRIAL_SIDE: the caller frees the pixels. */
static gscl_result make_copy(const gscl_encoder *e, gscl_image *copy) {
    const gsf_header *header = &e->picture.file.header;
    int level = e->first_level, colours = header->has_chroma ? 3 : 1;
    uint32_t shorter = e->image->width < e->image->height ? e->image->width : e->image->height;
    while (level < e->first_level + TRIAL_LEVEL && gscl_level_size(shorter, level + 1) >= TRIAL_SIDE)
        level++;
    *copy = (gscl_image){.width = gscl_level_size(e->image->width, level),
                         .height = gscl_level_size(e->image->height, level),
                         .channels = gsf_channel_count(header),
                         .sample = GSCL_SAMPLE_F32,
                         .premultiplied = true};
    size_t pixels = (size_t)copy->width * copy->height, channels = copy->channels;
    float *planes = malloc(pixels * channels * sizeof *planes), *samples = malloc(pixels * channels * sizeof *samples);
    if (planes && samples) {
        gscl_image_to_planes(e->image, colours, header->has_alpha, level, planes);
        for (size_t i = 0; i < pixels * channels; i++)
            samples[i] = planes[i % channels * pixels + i / channels];
        copy->pixels = samples;
    } else {
        free(samples);
    }
    free(planes);
    return copy->pixels ? GSCL_OK : gscl_fail(e->context, GSCL_ERROR_OUT_OF_MEMORY, "out of memory");
}

/* PSNR of the copy, encoded quickly with these effects. */
static gscl_result try_with(gscl_encoder *e, const gscl_image *copy, double bytes, double splats, uint32_t on,
                            uint32_t off, double *psnr) {
    gscl_encode_settings settings = e->settings;
    gscl_encode_report report;
    uint8_t *file = NULL;
    size_t size;
    settings.effects_on |= on;
    settings.effects_off |= off;
    settings.effort = 0;
    settings.progress = NULL;
    settings.target = bytes > 0 ? GSCL_TARGET_BYTES : GSCL_TARGET_SPLATS;
    settings.target_value = bytes > 0 ? bytes : splats;
    GSCL_TRY(gscl_encode(e->context, copy, &settings, &file, &size, &report));
    free(file);
    *psnr = report.psnr;
    return GSCL_OK;
}

/* Asks for `effects` where the copy is better with them, by more than `least` dB, and else rules them out. */
static gscl_result try_both(gscl_encoder *e, uint32_t effects, double least, double bytes, double splats) {
    gscl_image copy;
    double with, without;
    GSCL_TRY(make_copy(e, &copy));
    gscl_result result = try_with(e, &copy, bytes, splats, effects, 0, &with);
    if (result == GSCL_OK)
        result = try_with(e, &copy, bytes, splats, 0, effects, &without);
    free(copy.pixels);
    GSCL_TRY(result);
    bool on = with - without > least;
    *(on ? &e->settings.effects_on : &e->settings.effects_off) |= effects;
    for (uint32_t effect = 1; effect <= effects; effect <<= 1)
        if (effects & effect)
            gscl_effect_decide(e, (gscl_effect)effect, GSCL_EFFECT_TRIAL, on, with - without);
    return GSCL_OK;
}

/* Ellipses against circles. */
static gscl_result try_shapes(gscl_encoder *e, double bytes, double splats) {
    const uint32_t shapes = GSCL_EFFECT_ROTATION | GSCL_EFFECT_ANISOTROPY;
    bool open = !((e->settings.effects_on | e->settings.effects_off) & shapes);
    return open ? try_both(e, shapes, 0, bytes, splats) : GSCL_OK;
}

/* Pays where things hide each other, not in photographs. */
static gscl_result try_opacity(gscl_encoder *e, double bytes, double splats) {
    bool open = gscl_effect_is_open(&e->settings, GSCL_EFFECT_OPACITY) && e->settings.blend != GSCL_BLEND_ALPHA &&
                !e->picture.file.header.has_alpha;
    return open ? try_both(e, GSCL_EFFECT_OPACITY, OPACITY_GAIN, bytes, splats) : GSCL_OK;
}

static gscl_result try_chroma(gscl_encoder *e, double bytes, double splats) {
    if (!e->picture.file.header.has_chroma || !gscl_effect_is_open(&e->settings, GSCL_EFFECT_CHROMA))
        return GSCL_OK;
    double colourful = colourfulness(e);
    gscl_log(e->context, GSCL_LOG_DEBUG, "colourfulness: %.4f", colourful);
    if (colourful > FAINT)
        return GSCL_OK;
    GSCL_TRY(try_both(e, GSCL_EFFECT_CHROMA, 0, bytes, splats));
    e->picture.file.header.has_chroma = e->settings.effects_on & GSCL_EFFECT_CHROMA;
    return e->picture.file.header.has_chroma ? GSCL_OK : gscl_encoder_make_planes(e);
}

/* What is tried depends on how the image looks. */
static gscl_result look_and_try(gscl_encoder *e, double bytes, double splats) {
    double coherent = 1;
    GSCL_TRY(try_chroma(e, bytes, splats));
    GSCL_TRY(look_at_shapes(e, splats, &coherent));
    gscl_log(e->context, GSCL_LOG_DEBUG, "coherence of edges: %.2f%s", coherent, e->has_ground ? ", plain ground" : "");
    if (coherent < COHERENT)
        GSCL_TRY(try_shapes(e, bytes, splats));
    return coherent < COHERENT || e->has_ground ? try_opacity(e, bytes, splats) : GSCL_OK;
}

gscl_result gscl_effects_try(gscl_encoder *e, double bytes, double splats) {
    if (e->settings.profile == GSCL_PROFILE_PAPER || e->settings.effort == 0)
        return GSCL_OK;
    if (bytes > 0 && bytes < LEAST_BYTES)
        return GSCL_OK;
    if (bytes > 0)
        splats = 8 * bytes / BITS_PER_SPLAT;
    gscl_stage(e->context, "effect trials");
    gscl_stages_freeze(e->context, true);
    gscl_result result = look_and_try(e, bytes, splats);
    gscl_stages_freeze(e->context, false);
    return result;
}
