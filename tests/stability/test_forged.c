/* Valid files that no encoder writes, made so that roundings add up or are multiplied.  Each sample must have the
 * precision that FORMAT.md prescribes ("Precision"), from every decoder. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "every_decoder.h"
#include "oracle.h"
#include "report.h"
#include "synthetic_scene.h"

typedef struct {
    const char *name;
    uint32_t width, height, splats;
    gsf_coding coding;
    void (*fill)(gsf_coded_image *image);
} forged_case;

static const char *const blends[3] = {"normalized", "alpha", "sum"};

/* ---- Scalar coding ---- */

#define SCALE_STEP 4 /* four codes an octave, from half a pixel on */
#define OCTAVE 4
#define FINEST 15 /* the step with most levels */

/* Gives a splat whose axes have been set the brightest or the darkest luma code. */
static void set_extreme_luma(const gsf_coded_image *image, gsf_splat *splat, bool brightest) {
    const unsigned fineness = gsf_colour_fineness(&image->steps, splat->major, splat->aspect);
    int min, max;
    gsf_luma_range(image->header.blend, image->steps.luma, fineness, &min, &max);
    splat->luma = (int16_t)(brightest ? max : min);
}

/* The code of the luma numerator / denominator. */
static int16_t code_of_luma(const gsf_coded_image *image, const gsf_splat *splat, unsigned numerator,
                            unsigned denominator) {
    const unsigned fineness = gsf_colour_fineness(&image->steps, splat->major, splat->aspect);
    return (int16_t)(gsf_colour_levels(image->steps.luma) * fineness * numerator / denominator);
}

/* The chroma code of the highest or of the lowest level. */
static int16_t extreme_chroma(const gsf_coded_image *image, const gsf_splat *splat) {
    const unsigned fineness = gsf_colour_fineness(&image->steps, splat->major, splat->aspect);
    int min, max;
    gsf_chroma_range(image->steps.chroma, fineness, &min, &max);
    return (int16_t)(synthetic_random(2) ? max : min);
}

/* Opaque grey splats in the middle of the image, whose axes have these codes. */
static void fill_scalar(gsf_coded_image *image, unsigned longer, unsigned shorter) {
    const gsf_header *header = &image->header;
    image->steps = (gsf_steps){.scale = SCALE_STEP,
                               .luma = FINEST,
                               .chroma = FINEST,
                               .alpha = FINEST,
                               .opacity = header->has_opacity ? 15 : 0};
    for (uint32_t i = 0; i < header->splat_count; i++) {
        gsf_splat *splat = &image->splats[i];
        *splat = (gsf_splat){.major = (uint16_t)(header->has_anisotropy ? longer : shorter),
                             .aspect = (uint16_t)(header->has_anisotropy ? longer - shorter : 0),
                             .alpha = (int16_t)gsf_colour_levels(FINEST),
                             .opacity = image->steps.opacity};
        splat->luma = code_of_luma(image, splat, 3, 4);
        synthetic_place_splat(image, splat, header->width / 2.0, header->height / 2.0);
    }
}

static void fill_equal(gsf_coded_image *image) {
    fill_scalar(image, 3, 3);
}

static void fill_cancelling(gsf_coded_image *image) {
    fill_scalar(image, OCTAVE, OCTAVE);
    for (uint32_t i = 0; i < image->header.splat_count; i++)
        set_extreme_luma(image, &image->splats[i], i % 2);
}

/* Alphas on both sides of 0, by which colours are divided. */
static void fill_thin(gsf_coded_image *image) {
    fill_scalar(image, 4 * OCTAVE, 3 * OCTAVE);
    image->background[3] = 0;
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        synthetic_splat(image, &image->splats[i], 2 * OCTAVE + synthetic_random(OCTAVE), 0);
        image->splats[i].luma = (int16_t)synthetic_random(4);
        image->splats[i].co = image->splats[i].cg = 0;
        image->splats[i].alpha = (int16_t)(i % 2 ? 3 : -3);
    }
}

/* Needles at any angle and of any colour. */
static void fill_needles(gsf_coded_image *image, unsigned longer, unsigned shorter) {
    const gsf_header *header = &image->header;
    fill_scalar(image, longer, shorter);
    for (uint32_t i = 0; i < header->splat_count; i++) {
        gsf_splat *splat = &image->splats[i];
        const unsigned angles = gsf_angle_count(&image->steps, splat->aspect);
        set_extreme_luma(image, splat, i % 2);
        splat->co = extreme_chroma(image, splat);
        splat->cg = extreme_chroma(image, splat);
        splat->angle = (uint16_t)(header->has_rotation ? synthetic_random(angles) : 0);
        synthetic_place_splat(image, splat, synthetic_uniform(0.0, header->width),
                              synthetic_uniform(0.0, header->height));
    }
}

/* The largest ratio of axes, on short axes of 1/2 and of 4 pixels. */
static void fill_thin_needles(gsf_coded_image *image) {
    fill_needles(image, 8 * OCTAVE, 0);
}
static void fill_thick_needles(gsf_coded_image *image) {
    fill_needles(image, 11 * OCTAVE, 3 * OCTAVE);
}

/* Where floats are 1/1024 pixel apart; positions are divided by 215. */
static void fill_distant_needles(gsf_coded_image *image) {
    fill_needles(image, 8 * OCTAVE - 1, 0);
    for (uint32_t i = 0; i < image->header.splat_count; i++)
        synthetic_place_splat(image, &image->splats[i], image->header.width - synthetic_uniform(0.0, 400.0),
                              synthetic_uniform(0.0, image->header.height));
}

/* The largest ratio of the codes, along the longer side of the image, or within one step of the angle. */
static void fill_far_needles(gsf_coded_image *image) {
    const gsf_header *header = &image->header;
    fill_needles(image, GSF_MAX_SCALE_CODE, 0);
    for (uint32_t i = 0; i < header->splat_count; i++) {
        gsf_splat *splat = &image->splats[i];
        const unsigned angles = gsf_angle_count(&image->steps, splat->aspect);
        const unsigned along = header->width > header->height ? 0 : angles / 2;
        splat->angle = (uint16_t)(header->has_rotation ? (along + angles + i % 3 - 1) % angles : 0);
        synthetic_place_splat(image, splat, synthetic_uniform(0.0, header->width),
                              synthetic_uniform(0.0, header->height));
    }
}

/* The strongest and shortest waves on wide splats. */
static void fill_waves(gsf_coded_image *image, unsigned longer) {
    fill_scalar(image, longer, longer);
    image->steps.luma = 0;
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        gsf_splat *splat = &image->splats[i];
        splat->luma = code_of_luma(image, splat, 1, 2);
        splat->texture =
            (gsf_texture){.direction = (uint8_t)(i % 3), .phase = (uint8_t)(i % GSF_PHASES), .amplitude = 16};
        synthetic_place_splat(image, splat, i % 2 ? 0.0 : image->header.width, 0.0);
    }
}
static void fill_widest_waves(gsf_coded_image *image) {
    fill_waves(image, GSF_MAX_SCALE_CODE);
}
static void fill_wide_waves(gsf_coded_image *image) {
    fill_waves(image, 13 * OCTAVE); /* 2^12 pixels */
}

/* Two waves of opposite phases. */
static void fill_cancelling_waves(gsf_coded_image *image) {
    fill_waves(image, 4 * OCTAVE);
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        image->splats[i].texture.direction = 1;
        image->splats[i].texture.phase = (uint8_t)(i % 2 * GSF_PHASES / 2);
        synthetic_place_splat(image, &image->splats[i], image->header.width / 2.0, 0.0);
    }
}

/* Dark needles whose outlines pass through pixels, on a bright background: the weight of the background decides. */
static void fill_outlines(gsf_coded_image *image) {
    fill_scalar(image, 8 * OCTAVE, 0);
    for (uint32_t i = 0; i < image->header.splat_count; i++) {
        image->splats[i].luma = 0;
        image->splats[i].angle = (uint16_t)(image->header.has_rotation ? 3 : 0);
    }
}

/* ---- Codebook coding ---- */

#define HALF_PIXEL 96  /* axes in 1/32 octave above 1/16 pixel */
#define COLOUR_0 21845 /* of 16 bits from -255 to 510 */

/* One shape and one opaque colour, on splats at any position. */
static void fill_codebook(gsf_coded_image *image, int32_t longer, int32_t shorter, int32_t opacity) {
    const gsf_header *header = &image->header;
    gsf_codebooks *books = &image->codebooks;
    books->shape_count = books->colour_count = 1;
    books->position_bits = books->shape_bits = books->colour_bits = 16;
    books->shape[0] = (gsf_range){longer, longer};
    books->shape[1] = (gsf_range){shorter, shorter};
    books->shape[2] = (gsf_range){0, 0};
    for (int c = 0; c < 4; c++) {
        books->colour[c] = (gsf_range){-255, 510};
        books->colour_words[0][c] = (uint16_t)(COLOUR_0 * (c == 3 ? 2 : 1.75));
    }
    books->colour[4] = (gsf_range){0, opacity};
    books->colour_words[0][4] = 65535;
    for (uint32_t i = 0; i < header->splat_count; i++)
        image->indexed[i] =
            (gsf_indexed_splat){.x = (uint16_t)synthetic_random(1 << 16), .y = (uint16_t)synthetic_random(1 << 16)};
}

static void fill_transparent(gsf_coded_image *image) {
    fill_codebook(image, 300, 300, 0);
}
/* In a corner, so that the weights at some pixels are below half the spacing of floats near 1. */
static void fill_faint(gsf_coded_image *image) {
    fill_codebook(image, 160, 160, 1);
    image->codebooks.colour_words[0][4] = 1;
    for (uint32_t i = 0; i < image->header.splat_count; i++)
        image->indexed[i] = (gsf_indexed_splat){0};
}
static void fill_widest(gsf_coded_image *image) {
    fill_codebook(image, GSF_MAX_OCTAVES32, GSF_MAX_OCTAVES32, 255);
}
static void fill_points(gsf_coded_image *image) {
    fill_codebook(image, 0, 0, 255);
}

/* At an angle that is almost half a turn, which a float does not represent well. */
static void fill_long_words(gsf_coded_image *image) {
    fill_codebook(image, GSF_MAX_OCTAVES32, 0, 255);
    image->codebooks.shape[2] = (gsf_range){255, 256};
    image->codebooks.shape_words[0][2] = 65520;
    for (uint32_t i = 0; i < image->header.splat_count; i++)
        image->indexed[i].x = i % 2 ? 65535 : 0;
}

static const forged_case cases[] = {
    {"2^20 equal splats", 4, 4, 1 << 20, GSF_CODING_SCALAR, fill_equal},
    {"2^9 splats of cancelling colours", 20, 4, 1 << 9, GSF_CODING_SCALAR, fill_cancelling},
    {"2^19 splats of cancelling colours", 4, 4, 1 << 19, GSF_CODING_SCALAR, fill_cancelling},
    {"alpha near 0", 48, 40, 30, GSF_CODING_SCALAR, fill_thin},
    {"needles of 128 x 1/2 px", 512, 300, 12, GSF_CODING_SCALAR, fill_thin_needles},
    {"needles of 1024 x 4 px", 1500, 1000, 12, GSF_CODING_SCALAR, fill_thick_needles},
    {"needles of 107 x 1/2 px at 16,000 px", 16384, 30, 40, GSF_CODING_SCALAR, fill_distant_needles},
    {"needles of the longest codes, 16384 px wide", 16384, 8, 12, GSF_CODING_SCALAR, fill_far_needles},
    {"needles of the longest codes, 16384 px high", 8, 16384, 12, GSF_CODING_SCALAR, fill_far_needles},
    {"waves on axes of 2^14.75 px", 16384, 4, 6, GSF_CODING_SCALAR, fill_widest_waves},
    {"waves on axes of 2^12 px", 16384, 4, 6, GSF_CODING_SCALAR, fill_wide_waves},
    {"waves that cancel", 300, 20, 400, GSF_CODING_SCALAR, fill_cancelling_waves},
    {"an outline", 100, 10, 1, GSF_CODING_SCALAR, fill_outlines},
    {"2^16 equal outlines", 100, 10, 1 << 16, GSF_CODING_SCALAR, fill_outlines},
    {"2^20 splats of opacity 0", 4, 4, 1 << 20, GSF_CODING_CODEBOOK, fill_transparent},
    {"2^20 splats of opacity 2^-24", 4, 4, 1 << 20, GSF_CODING_CODEBOOK, fill_faint},
    {"axes of 2^16 px", 40, 30, 100, GSF_CODING_CODEBOOK, fill_widest},
    {"axes of 1/16 px at 16,000 px", 16383, 3, 6000, GSF_CODING_CODEBOOK, fill_points},
    {"2^16 x 1/16 px", 16384, 8, 12, GSF_CODING_CODEBOOK, fill_long_words},
    {0},
};

/* ---- Comparison ---- */

typedef struct {
    uint8_t *bytes;
    size_t size;
    oracle_image image;
} forged_file;

static forged_file forge(const forged_case *c, const gsf_header *header) {
    forged_file file = {0};
    synthetic_scene *scene = synthetic_scene_new(header);
    assert_non_null(scene);
    synthetic_random_state = 21;
    for (int i = 0; i < GSF_MAX_CHANNELS; i++)
        scene->image.background[i] = (uint16_t)(i == 3 ? 65535 : 30000 + 9000 * i);
    c->fill(&scene->image);
    if (synthetic_scene_write(scene, &file.bytes, &file.size) != GSF_OK)
        fail_msg("%s: the file cannot be written", c->name);
    synthetic_scene_free(scene);
    assert_true(oracle_decode(file.bytes, file.size, &file.image));
    return file;
}

/* The sample with the largest error relative to the one that is allowed. */
typedef struct {
    double share;          /* of the allowed error */
    double error, allowed; /* in 1/255 */
} worst_sample;

/* Whether the page allows a sample; its rounding to a float does not count. */
static bool check_sample(const oracle_image *image, size_t i, double sample, worst_sample *worst) {
    const double error = fabs(sample - image->pixels[i]);
    const double allowed = fmax(image->high[i] - image->pixels[i], image->pixels[i] - image->low[i]);
    if (error < 1e-6)
        return true;
    if (error > worst->share * allowed)
        *worst = (worst_sample){error / allowed, 255.0 * error, 255.0 * allowed};
    return oracle_allows(image, i, sample, 0);
}

static void check_decode(const char *name, const char *detail, gscl_context *context, const forged_file *file,
                         worst_sample *worst) {
    gscl_decode_settings settings;
    gscl_image image = {0};
    gscl_decode_settings_default(&settings);
    settings.sample = GSCL_SAMPLE_F32;
    if (gscl_decode(context, file->bytes, file->size, &settings, &image) != GSCL_OK)
        fail_msg("%s, %s: %s", name, detail, gscl_context_message(context));
    for (size_t i = 0; i < (size_t)image.width * image.height * image.channels; i++) {
        const double sample = ((const float *)image.pixels)[i];
        if (!check_sample(&file->image, i, sample, worst))
            fail_msg("%s, %s: sample %zu is %.9g; %.9g expected, or %.9g to %.9g", name, detail, i, sample,
                     file->image.pixels[i], file->image.low[i], file->image.high[i]);
    }
    gscl_free(image.pixels);
}

/* Sanitizers run small files only: the others would take half an hour. */
#define FEW_SPLATS (1u << 13)

static void check_case(const forged_case *c, const gsf_header *header, const char *shape, worst_sample *worst) {
    char detail[60];
    if (getenv("STABILITY_SMALL") && c->splats > FEW_SPLATS)
        return;
    forged_file file = forge(c, header);
    for (int m = 0; m < decoder_count; m++) {
        snprintf(detail, sizeof detail, "%s%s, %s", blends[header->blend], shape, decoder_names[m]);
        check_decode(c->name, detail, contexts[m], &file, worst);
    }
    free(file.bytes);
    oracle_free(&file.image);
}

static gsf_header header_of(const forged_case *c, gsf_blend blend) {
    return (gsf_header){.blend = blend,
                        .coding = c->coding,
                        .layout = GSF_RGBA,
                        .high_bit_depth = true,
                        .has_chroma = true,
                        .has_alpha = true,
                        .has_opacity = true,
                        .has_rotation = true,
                        .has_anisotropy = true,
                        .has_texture = c->coding == GSF_CODING_SCALAR,
                        .width = c->width,
                        .height = c->height,
                        .splat_count = c->splats};
}

static void test_blends(void **state) {
    (void)state;
    for (const forged_case *c = cases; c->name; c++)
        for (gsf_blend blend = GSF_BLEND_NORMALIZED; blend <= GSF_BLEND_SUM; blend++) {
            const gsf_header header = header_of(c, blend);
            worst_sample worst = {0};
            check_case(c, &header, "", &worst);
            report("forged files", c->name, blends[blend], "sample, in 1/255", worst.allowed, worst.error);
        }
}

static void test_other_shapes(void **state) {
    (void)state;
    for (const forged_case *c = cases; c->name; c++) {
        gsf_header header = header_of(c, GSF_BLEND_NORMALIZED);
        worst_sample worst = {0};
        header.has_rotation = false;
        check_case(c, &header, ", axis-aligned", &worst);
        header.has_anisotropy = false;
        check_case(c, &header, ", isotropic", &worst);
        report("forged files", c->name, "normalized, without rotation", "sample, in 1/255", worst.allowed, worst.error);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_blends), cmocka_unit_test(test_other_shapes)};
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
