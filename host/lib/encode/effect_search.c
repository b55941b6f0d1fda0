/* Trials of effects: quick fits of the image for the same budget, with an effect and without. */
#include "encode/effect_search.h"

#include <math.h>
#include <stdlib.h>

#include "image/box_sum.h"
#include "session/effects.h"
#include "runtime/timing.h"
#include "scalar/encode_scalar.h"

#define BITS_PER_SPLAT 34 /* about */
#define LOOK_LEVEL 1      /* at which the image is looked at */
#define COHERENT 0.3      /* images whose edges agree less on a direction may do without ellipses */
#define WINDOW 0.6        /* in which they are to agree: its radius, in distances from splat to splat */
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

/* 1: in each window all edges have one direction; 0: all directions are there alike.  `planes`: room for three of the
 * field's size; `line`: for its longer side. */
static double coherence(const field *f, int radius, float *planes, double *line) {
    size_t pixels = (size_t)f->width * (size_t)f->height;
    tensor t = {planes, planes + pixels, planes + 2 * pixels};
    double directed = 0, all = 0;
    tensor_of(f, &t);
    for (int i = 0; i < 3; i++)
        gscl_box_sum(planes + (size_t)i * pixels, f->width, f->height, radius, line);
    for (size_t i = 0; i < pixels; i++) {
        directed += hypot(t.difference[i], t.mixed[i]);
        all += t.sum[i];
    }
    return all > 0 ? directed / all : 0;
}

/* ---- Looking at the image ---- */

static gscl_result look_at_shapes(const gscl_encoder *e, double splats, double *coherent) {
    int level = e->source.first_level + LOOK_LEVEL;
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
    return there ? GSCL_OK : gscl_fail_memory(e->context);
}

/* Root mean square of the colours' differences from grey. */
static double colourfulness(const gscl_encoder *e) {
    size_t pixels = e->source.pixels;
    double sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        double r = e->source.planes[i], g = e->source.planes[pixels + i], b = e->source.planes[2 * pixels + i],
               mean = (r + g + b) / 3;
        sum += (r - mean) * (r - mean) + (g - mean) * (g - mean) + (b - mean) * (b - mean);
    }
    return sqrt(sum / (3 * (double)pixels));
}

/* ---- Trials ---- */

/* The file that is to be made, and what is known of it. */
typedef struct trial {
    gscl_encoder *encoder;
    size_t bytes, splats; /* the budget; splats where bytes is 0 */
    double missing;       /* squared error per sample that no sketch sees: of colours that grey leaves out */
    double psnr;          /* of a sketch with what the settings say so far; NAN: not known */
} trial;

/* PSNR of a sketch without these effects. */
static gscl_result sketch_without(const trial *t, uint32_t off, double *psnr) {
    gscl_encoder *e = t->encoder;
    gscl_encode_settings settings = e->settings;
    double mse = 0;
    /* Opacity by content (effects.c) is left out: sketches tell shapes apart better without it. */
    if (gscl_effect_is_open(&settings, GSCL_EFFECT_OPACITY) && settings.blend != GSCL_BLEND_ALPHA)
        off |= GSCL_EFFECT_OPACITY;
    e->settings.effects_off |= off;
    gscl_result result = gscl_scalar_probe_fit(e, t->bytes, t->splats, &mse);
    e->settings = settings;
    *psnr = -10 * log10(fmax(mse + t->missing, 1e-12));
    return result;
}

/* Asks for effects, or rules them out. */
static void decide(trial *t, uint32_t effects, bool on, double gain_db) {
    gscl_encoder *e = t->encoder;
    *(on ? &e->settings.effects_on : &e->settings.effects_off) |= effects;
    for (uint32_t effect = 1; effect <= effects; effect <<= 1)
        if (effects & effect)
            gscl_effect_decide(e, (gscl_effect)effect, GSCL_EFFECT_TRIAL, on, gain_db);
}

static gscl_result know_psnr(trial *t) {
    return isnan(t->psnr) ? sketch_without(t, 0, &t->psnr) : GSCL_OK;
}

#define SHAPES (GSCL_EFFECT_ROTATION | GSCL_EFFECT_ANISOTROPY)

/* Ellipses against circles. */
static gscl_result try_shapes(trial *t) {
    double circles;
    GSCL_TRY(know_psnr(t));
    GSCL_TRY(sketch_without(t, SHAPES, &circles));
    double gain_db = t->psnr - circles;
    decide(t, SHAPES, gain_db > 0, gain_db);
    return GSCL_OK;
}

/* The image becomes grey, or coloured again. */
static gscl_result set_chroma(gscl_encoder *e, bool chroma) {
    e->coded.file.header.has_chroma = chroma;
    return gscl_encoder_make_planes(e);
}

/* Faint colours against grey.  With an alpha channel the errors of grey and colour do not compare. */
static gscl_result try_chroma(trial *t) {
    gscl_encoder *e = t->encoder;
    const gsf_header *header = &e->coded.file.header;
    double grey;
    if (!header->has_chroma || header->has_alpha || !gscl_effect_is_open(&e->settings, GSCL_EFFECT_CHROMA))
        return GSCL_OK;
    double colourful = colourfulness(e);
    gscl_log(e->context, GSCL_LOG_DEBUG, "colourfulness: %.4f", colourful);
    if (colourful > FAINT)
        return GSCL_OK;
    GSCL_TRY(know_psnr(t));
    grey = -20 * log10(fmax(colourful, 1e-6)); /* at best: all but the colours right */
    if (t->psnr < grey) {
        GSCL_TRY(set_chroma(e, false));
        t->missing = colourful * colourful;
        GSCL_TRY(sketch_without(t, GSCL_EFFECT_CHROMA, &grey));
    }
    bool pays = t->psnr > grey;
    decide(t, GSCL_EFFECT_CHROMA, pays, t->psnr - grey);
    t->psnr = fmax(t->psnr, grey);
    if (!pays || header->has_chroma)
        return GSCL_OK;
    t->missing = 0;
    return set_chroma(e, true);
}

/* What is tried depends on how the image looks. */
static gscl_result look_and_try(trial *t) {
    gscl_encoder *e = t->encoder;
    double coherent = 1, splats = t->bytes ? 8.0 * (double)t->bytes / BITS_PER_SPLAT : (double)t->splats;
    const gscl_encode_settings *settings = &e->settings;
    bool shapes_open = !((settings->effects_on | settings->effects_off) & SHAPES);
    GSCL_TRY(try_chroma(t));
    if (!shapes_open)
        return GSCL_OK;
    GSCL_TRY(look_at_shapes(e, splats, &coherent));
    gscl_log(e->context, GSCL_LOG_DEBUG, "coherence of edges: %.2f", coherent);
    return coherent < COHERENT ? try_shapes(t) : GSCL_OK;
}

gscl_result gscl_effects_try(gscl_encoder *e, size_t bytes, size_t splats) {
    if (e->settings.profile == GSCL_PROFILE_PAPER || e->settings.effort == 0)
        return GSCL_OK;
    if (bytes && bytes < LEAST_BYTES)
        return GSCL_OK;
    trial t = {.encoder = e, .bytes = bytes, .splats = splats, .psnr = NAN};
    gscl_stage(e->context, GSCL_STAGE_EFFECT_SEARCH);
    gscl_stages_freeze(e->context, true);
    gscl_progress_stage(&e->progress, 0, 0);
    gscl_result result = look_and_try(&t);
    gscl_progress_stage(&e->progress, 0, 1);
    gscl_stages_freeze(e->context, false);
    return result;
}
