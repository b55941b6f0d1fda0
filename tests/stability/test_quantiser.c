/* Both codings at the ends of their ranges: the codes are valid, and the file is drawn as in double precision. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "both_mappings.h"
#include "codebook/codebook_cluster.h"
#include "codebook/codebook_order.h"
#include "codebook/codebook_quantise.h"
#include "codebook/codebook_step.h"
#include "cl/constants.h"
#include "decodes.h"
#include "decode/coded_image.h"
#include "decode/dequantise.h"
#include "decode/quantise.h"
#include "report.h"
#include "synthetic_scene.h"

static const double ln2 = 0.69314718055994530942, pi = 3.14159265358979323846;

static void check_bytes(const char *name, const uint8_t *bytes, size_t size) {
    char message[200];
    if (!decodes_alike(contexts, decoder_count, bytes, size, message, sizeof message))
        fail_msg("%s: %s", name, message);
}

/* ---- Scalar coding ---- */

static const gsf_blend blends[] = {GSF_BLEND_NORMALIZED, GSF_BLEND_ALPHA, GSF_BLEND_SUM};

static gscl_coded_image scalar_picture(gsf_blend blend, uint8_t steps, uint32_t width, uint32_t height,
                                       uint32_t splats) {
    gscl_coded_image p = {0};
    p.file.header = (gsf_header){.blend = blend,
                                 .layout = GSF_RGBA,
                                 .has_chroma = true,
                                 .has_alpha = true,
                                 .has_opacity = true,
                                 .has_rotation = true,
                                 .has_anisotropy = true,
                                 .has_texture = true,
                                 .width = width,
                                 .height = height,
                                 .splat_count = splats};
    p.file.steps = (gsf_steps){steps, steps, steps, steps, steps, steps, steps, 0};
    assert_int_equal(gscl_coded_image_reserve(&p, splats), GSCL_OK);
    return p;
}

/* A parameter at both ends of its coded range, beyond them, and at the ends of the float range. */
static float extreme(size_t parameter, int which) {
    static const float ends[9] = {0.0f, -1.0f, 1.0f, -1.125f, 1.125f, -1e10f, 1e10f, -3e38f, 3e38f};
    const float axes[9] = {0.0f, (float)-ln2, GSCL_LOG_LARGEST_AXIS, -30.0f, 30.0f, -1e4f, 1e4f, -3e38f, 3e38f};
    const float turns[9] = {0.0f, (float)pi, (float)-pi, 1e-7f, -1e-7f, 1e5f, -1e5f, 3e38f, -3e38f};
    if (parameter == GSCL_LOG_S1 || parameter == GSCL_LOG_S2)
        return axes[which];
    if (parameter == GSCL_OPACITY && which > 6)
        return which == 7 ? -INFINITY : INFINITY;
    return parameter == GSCL_THETA ? turns[which] : ends[which];
}

/* A coded colour is at most half a step from its parameter, or at the end of the range. */
static double colour_error(const gscl_coded_image *p, const float *params, const gsf_splat *splat) {
    float back[GSCL_PARAMS];
    int min, max;
    gscl_dequantise(&p->file, splat, back);
    gsf_luma_range(p->file.header.blend, p->file.steps.alpha, 1, &min, &max);
    const double levels = gsf_colour_levels(p->file.steps.alpha), alpha = params[GSCL_COLOUR + 3];
    return fabs(fmin(fmax(alpha, min / levels), max / levels) - back[GSCL_COLOUR + 3]) * levels;
}

static void test_parameters_beyond_all_ends(void **state) {
    (void)state;
    enum { COUNT = 9 * GSCL_PARAMS };
    double worst = 0.0;
    for (int i = 0; i < 3 * 16; i++) {
        gscl_coded_image p = scalar_picture(blends[i % 3], (uint8_t)(i / 3), i % 2 ? 1 : 33, i % 2 ? 40 : 21, COUNT);
        for (size_t j = 0; j < COUNT; j++) {
            float params[GSCL_PARAMS] = {10.0f, 10.0f, 1.0f, 0.5f, 0.3f, 0.0f, 0.5f,
                                         0.5f,  0.5f,  0.5f, 0.1f, 0.1f, 0.2f, 0.2f};
            params[j / 9] = extreme(j / 9, (int)(j % 9));
            gscl_quantise(&p.file, params, &p.file.splats[j]);
            worst = fmax(worst, colour_error(&p, params, &p.file.splats[j]));
        }
        uint8_t *bytes = NULL;
        size_t size = 0;
        assert_int_equal(gscl_coded_image_write(&p, &bytes, &size), GSCL_OK);
        check_bytes("parameters beyond all ends", bytes, size);
        gscl_free(bytes);
        gscl_coded_image_free(&p);
    }
    report("quantiser", "scalar, parameters beyond all ends", "", "colour's error, steps", 0.5 + 1e-5, worst);
    assert_true(worst <= 0.5 + 1e-5); /* the colour is a float, with an error of 1e-5 of a step */
}

/* ---- Codebook coding ---- */

static synthetic_scene *codebook_scene(gsf_blend blend, uint8_t bits, bool wide) {
    const gsf_header header = {.blend = blend,
                               .coding = GSF_CODING_CODEBOOK,
                               .layout = GSF_RGB,
                               .has_chroma = true,
                               .has_opacity = true,
                               .has_rotation = true,
                               .has_anisotropy = true,
                               .width = 45,
                               .height = 34,
                               .splat_count = 60};
    synthetic_scene *s = synthetic_scene_new(&header);
    assert_non_null(s);
    synthetic_random_state = 17;
    synthetic_background(&s->image);
    synthetic_codebooks(&s->image, 200);
    gsf_codebooks *books = &s->image.codebooks;
    books->position_bits = books->shape_bits = books->colour_bits = bits;
    for (int d = 0; d < GSF_MAX_COLOUR_DIMS; d++)
        books->colour[d] = wide ? (gsf_range){-255, 510} : (gsf_range){100, 100};
    books->colour[3] = wide ? (gsf_range){0, 255} : (gsf_range){100, 100};
    for (int d = 0; d < 2; d++)
        books->shape[d] = wide ? (gsf_range){0, GSF_MAX_OCTAVES32} : (gsf_range){150, 150};
    books->shape[2] = wide ? (gsf_range){0, 256} : (gsf_range){33, 33};
    return s;
}

/* Words at both ends of each dimension, and positions at both ends of the image. */
static void use_ends(gsf_coded_image *p) {
    gsf_codebooks *books = &p->codebooks;
    const uint16_t last = (uint16_t)((1u << books->shape_bits) - 1u);
    books->shape_count = books->colour_count = 8;
    for (uint16_t i = 0; i < 8; i++) {
        for (int d = 0; d < GSF_SHAPE_DIMS; d++)
            books->shape_words[i][d] = (d == 0 ? i < 4 : i >> d & 1) ? last : 0;
        for (int d = 0; d < GSF_MAX_COLOUR_DIMS; d++)
            books->colour_words[i][d] = (d == 0 ? i >= 4 : i >> (d - 1) & 1) ? last : 0;
    }
    for (uint32_t i = 0; i < p->header.splat_count; i++)
        p->indexed[i] =
            (gsf_indexed_splat){(uint16_t)(i % 8), (uint16_t)(i / 8 % 8), i & 1 ? last : 0, i & 2 ? last : 0};
}

static void test_codebook_ends(void **state) {
    (void)state;
    for (int i = 0; i < 12; i++) {
        synthetic_scene *s = codebook_scene(blends[i % 3], i / 3 % 2 ? 16 : 1, i / 6);
        char name[80];
        uint8_t *bytes[2];
        size_t sizes[2];
        use_ends(&s->image);
        snprintf(name, sizeof name, "codebooks, blend %d, %d bits, %s", i % 3, i / 3 % 2 ? 16 : 1,
                 i / 6 ? "the widest range" : "min = max");
        for (int k = 0; k < 2; k++)
            assert_int_equal(synthetic_scene_write(s, &bytes[k], &sizes[k]), GSF_OK);
        assert_int_equal(sizes[0], sizes[1]);
        assert_memory_equal(bytes[0], bytes[1], sizes[0]);
        check_bytes(name, bytes[0], sizes[0]);
        free(bytes[0]);
        free(bytes[1]);
        synthetic_scene_free(s);
    }
}

/* ---- The paper's codebooks, clustered on the device ---- */

#define SIDE 32
#define SPLATS 40

typedef struct {
    const char *name;
    int bits, shapes, colours;
    size_t splats;
    bool equal; /* all splats are equal */
} book_case;

static void check_call(gscl_context *context, const char *name, gscl_result result) {
    if (result != GSCL_OK)
        fail_msg("%s: %s", name, gscl_context_message(context));
}

static void make_splats(const book_case *c, float *params) {
    memset(params, 0, c->splats * GSCL_PARAMS * sizeof *params);
    synthetic_random_state = 5;
    for (size_t i = 0; i < c->splats; i++) {
        float *p = params + i * GSCL_PARAMS;
        p[GSCL_X] = synthetic_uniform(0.0, SIDE);
        p[GSCL_Y] = synthetic_uniform(0.0, SIDE);
        p[GSCL_LOG_S1] = synthetic_uniform(-0.5, 3.0);
        p[GSCL_LOG_S2] = synthetic_uniform(-0.5, 3.0);
        p[GSCL_THETA] = synthetic_uniform(-3.0, 3.0);
        p[GSCL_OPACITY] = synthetic_uniform(-4.0, 4.0);
        for (int k = GSCL_COLOUR; k < GSCL_COLOUR + 3; k++)
            p[k] = synthetic_uniform(0.0, 1.0);
        if (c->equal && i > 0)
            memcpy(p + GSCL_LOG_S1, params + GSCL_LOG_S1, (GSCL_PARAMS - GSCL_LOG_S1) * sizeof *p);
    }
}

/* Each word of the file is used by a splat. */
static void check_words_used(const book_case *c, const gsf_coded_image *file) {
    bool used[2][GSF_MAX_CODEBOOK] = {{false}};
    for (uint32_t i = 0; i < file->header.splat_count; i++)
        used[0][file->indexed[i].shape] = used[1][file->indexed[i].colour] = true;
    for (int b = 0; b < 2; b++) {
        const int count = b ? file->codebooks.colour_count : file->codebooks.shape_count;
        for (int k = 0; k < count; k++)
            if (!used[b][k])
                fail_msg("%s: word %d of book %d is empty", c->name, k, b);
        if (count > (b ? c->colours : c->shapes) || count > (int)c->splats || (c->equal && count != 1))
            fail_msg("%s: %d words", c->name, count);
    }
}

/* The device's words are within a step of the file's, in each dimension.  Without fmin and fmax in loops, of which GCC 12 for aarch64
 * makes vectors, and fails itself. */
static double word_error(const gscl_codebook *book, const float *projected) {
    double worst = 0.0;
    const gscl_book *shapes = &book->books[GSCL_BOOK_SHAPE];
    const double levels = (double)((1u << shapes->bits) - 1u);
    for (int d = 0; d < 2; d++) {
        double low = INFINITY, high = -INFINITY;
        for (int k = 0; k < shapes->count; k++) {
            const float word = shapes->words[k * GSCL_BOOK_DIMS + d];
            low = word < low ? word : low;
            high = word > high ? word : high;
        }
        const double allowed = 0.5 * (high - low) / levels + 4 * 0x1p-24 * fmax(fabs(low), fabs(high));
        for (int i = 0; i < book->fit->renderer.count; i++) {
            const double word = shapes->words[book->pairs[i][0] * GSCL_BOOK_DIMS + d];
            const double error = fabs(projected[i * GSCL_PARAMS + GSCL_LOG_S1 + d] - word);
            const double share = allowed > 0.0 ? error / allowed : error;
            if (!(share <= worst))
                worst = share;
        }
    }
    return worst;
}

static void cluster(gscl_context *context, gscl_fit *fit, const book_case *c, gscl_coded_image *coded, double *error) {
    static float params[SPLATS * GSCL_PARAMS], projected[SPLATS * GSCL_PARAMS];
    gscl_codebook book;
    uint64_t random = 9;
    make_splats(c, params);
    check_call(context, c->name, gscl_fit_append(fit, params, c->splats));
    check_call(context, c->name, gscl_codebook_create(&book, fit, c->bits, c->bits, c->bits));
    for (int iteration = 0; iteration < (c->equal ? 0 : 3); iteration++) {
        check_call(context, c->name, gscl_codebook_cluster(&book, c->shapes, c->colours, iteration > 0, &random));
        check_call(context, c->name, gscl_codebook_sort(&book, coded));
        check_call(context, c->name, gscl_codebook_step_straight_through(&book, 1.0f));
    }
    check_call(context, c->name, gscl_codebook_cluster(&book, c->shapes, c->colours, true, &random));
    check_call(context, c->name, gscl_codebook_project(&book));
    check_call(context, c->name, gscl_fit_read(fit, projected));
    for (size_t i = 0; i < c->splats * GSCL_PARAMS; i++)
        assert_true(isfinite(projected[i]));
    *error = word_error(&book, projected);
    check_call(context, c->name, gscl_codebook_quantise(&book, coded));
    gscl_codebook_free(&book);
}

static void check_books(gscl_context *context, const book_case *c, double *error) {
    static float target[SIDE * SIDE * 3];
    const gscl_kernel_options options = {
        .blend = GSCL_ALPHA, .colours = 3, .opacity = 1, .loss = GSCL_LOSS_KIND_EXTERNAL};
    gscl_fit fit;
    gscl_coded_image coded = {0};
    uint8_t *bytes = NULL;
    size_t size;
    coded.file.header = (gsf_header){.blend = GSF_BLEND_ALPHA,
                                     .coding = GSF_CODING_CODEBOOK,
                                     .layout = GSF_RGB,
                                     .has_chroma = true,
                                     .has_opacity = true,
                                     .has_rotation = true,
                                     .has_anisotropy = true,
                                     .width = SIDE,
                                     .height = SIDE};
    check_call(context, c->name, gscl_fit_create(&fit, context, &options, SIDE, SIDE, 0, target));
    cluster(context, &fit, c, &coded, error);
    check_words_used(c, &coded.file);
    assert_int_equal(gscl_coded_image_write(&coded, &bytes, &size), GSCL_OK);
    check_bytes(c->name, bytes, size);
    gscl_free(bytes);
    gscl_coded_image_free(&coded);
    gscl_fit_free(&fit);
}

static void test_clustered_codebooks(void **state) {
    (void)state;
    static const book_case cases[] = {
        {"clustered words, b = 1", 1, 8, 8, SPLATS, false},
        {"clustered words, b = 16", 16, 8, 8, SPLATS, false},
        {"clustered words, all splats equal (min = max)", 8, 8, 8, SPLATS, true},
        {"clustered words, fewer splats than words", 8, 64, 64, 5, false},
        {"clustered words, k = 1", 16, 1, 1, SPLATS, false},
        {"clustered words, one splat", 1, 8, 8, 1, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (int m = 0; m < mapping_count; m++) {
            double error;
            check_books(contexts[m], &cases[i], &error);
            report("quantiser", cases[i].name, mapping_names[m], "word's error, half steps and rounding", 1.0, error);
            if (error > 1.0)
                fail_msg("%s: a word is off by %g half steps", cases[i].name, error);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parameters_beyond_all_ends),
        cmocka_unit_test(test_codebook_ends),
        cmocka_unit_test(test_clustered_codebooks),
    };
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
