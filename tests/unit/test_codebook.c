/* The paper profile's codebooks: the choices of an RDO pass, dropped splats and words, buffers that passes reuse. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "both_mappings.h"
#include "cl/constants.h"
#include "codebook/codebook_cluster.h"
#include "codebook/codebook_order.h"
#include "codebook/codebook_plan.h"
#include "codebook/codebook_quantise.h"
#include "codebook/codebook_rdo.h"
#include "codebook/codebook_step.h"
#include "fit/fit.h"
#include "synthetic_scene.h"

#define WIDTH 61
#define HEIGHT 47
#define SPLATS 12
#define SHAPES 4
#define COLOURS 6
#define WORD_BITS 16 /* rounding of words is negligible */
#define POSITION_BITS 6
#define FREE_BITS 1e-12 /* lambda: only the error counts */
#define MAX_PASSES 60

typedef struct {
    gscl_context *context;
    gscl_coded_image coded;
    gscl_fit fit;
    gscl_codebook codebook;
    gscl_codebook_rdo rdo;
} scene;

static void check_call(const scene *s, gscl_result result) {
    if (result != GSCL_OK)
        fail_msg("%s", gscl_context_message(s->context));
}

static void make_target(float *planes) {
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        const int x = i % WIDTH, y = i / WIDTH % HEIGHT, channel = i / (WIDTH * HEIGHT);
        planes[i] = 0.5f + 0.3f * sinf(0.15f * (float)x + (float)channel) * cosf(0.2f * (float)y);
    }
}

static void make_splat(float *p) {
    p[GSCL_X] = synthetic_uniform(0, WIDTH);
    p[GSCL_Y] = synthetic_uniform(0, HEIGHT);
    p[GSCL_LOG_S1] = synthetic_uniform(1, 2.5);
    p[GSCL_LOG_S2] = synthetic_uniform(1, 2.5);
    p[GSCL_THETA] = synthetic_uniform(0, 3);
    p[GSCL_OPACITY] = synthetic_uniform(-1, 3);
    for (int k = 0; k < 3; k++)
        p[GSCL_COLOUR + k] = synthetic_uniform(0.1, 0.9);
}

static void scene_open(scene *s, gscl_context *context) {
    static float planes[3 * WIDTH * HEIGHT];
    float params[SPLATS * GSCL_PARAMS] = {0};
    uint64_t random = 3;
    memset(s, 0, sizeof *s);
    s->context = context;
    s->coded.file.header = (gsf_header){.blend = GSF_BLEND_ALPHA,
                                        .coding = GSF_CODING_CODEBOOK,
                                        .layout = GSF_RGB,
                                        .has_chroma = true,
                                        .has_opacity = true,
                                        .has_rotation = true,
                                        .has_anisotropy = true,
                                        .width = WIDTH,
                                        .height = HEIGHT};
    const gscl_kernel_options options = gscl_coded_image_options(&s->coded.file.header);
    synthetic_random_state = 11;
    make_target(planes);
    for (int i = 0; i < SPLATS; i++)
        make_splat(params + i * GSCL_PARAMS);
    check_call(s, gscl_fit_create(&s->fit, context, &options, WIDTH, HEIGHT, 0, planes));
    check_call(s, gscl_fit_append(&s->fit, params, SPLATS));
    check_call(s, gscl_codebook_create(&s->codebook, &s->fit, POSITION_BITS, WORD_BITS, WORD_BITS));
    check_call(s, gscl_codebook_cluster(&s->codebook, SHAPES, COLOURS, false, &random));
    check_call(s, gscl_codebook_sort(&s->codebook, &s->coded));
    check_call(s, gscl_codebook_rdo_create(&s->rdo, &s->codebook));
}

static void scene_close(scene *s) {
    gscl_codebook_rdo_free(&s->rdo);
    gscl_codebook_free(&s->codebook);
    gscl_fit_free(&s->fit);
    gscl_coded_image_free(&s->coded);
}

/* Squared error of the rendering of the splats in the host arrays. */
static double rendering_error(scene *s) {
    double error;
    check_call(s, gscl_codebook_upload(&s->codebook));
    check_call(s, gscl_codebook_project(&s->codebook));
    check_call(s, gscl_fit_rendering_error(&s->fit, &error));
    return error;
}

static void run_pass(scene *s, double lambda, bool keep_all) {
    check_call(s, gscl_codebook_project(&s->codebook));
    check_call(s, gscl_codebook_rdo_run(&s->rdo, lambda, keep_all));
}

/* Runs passes until one changes nothing. */
static void run_until_settled(scene *s) {
    float params[SPLATS * GSCL_PARAMS];
    int32_t pairs[SPLATS][2];
    for (int pass = 0; pass < MAX_PASSES; pass++) {
        run_pass(s, FREE_BITS, true);
        if (pass > 0 && memcmp(params, s->codebook.params, sizeof params) == 0 &&
            memcmp(pairs, s->codebook.pairs, sizeof pairs) == 0)
            return;
        memcpy(params, s->codebook.params, sizeof params);
        memcpy(pairs, s->codebook.pairs, sizeof pairs);
    }
    fail_msg("%d passes were not enough", MAX_PASSES);
}

/* No other colour word and no neighbouring cell of a single splat gives a smaller error. */
static void check_minimum(scene *s) {
    gscl_codebook *c = &s->codebook;
    const double least = rendering_error(s), cells = 1 << POSITION_BITS;
    const float step[2] = {(float)(WIDTH / cells), (float)(HEIGHT / cells)};
    for (int i = 0; i < SPLATS; i++)
        for (int move = 0; move < 5; move++)
            for (int word = 0; word < c->books[GSCL_BOOK_COLOUR].count; word++) {
                float *at = c->params + i * GSCL_PARAMS + (move > 2 ? GSCL_Y : GSCL_X);
                int32_t *index = &c->pairs[i][GSCL_BOOK_COLOUR];
                const float old_at = *at;
                const int32_t old_index = *index;
                *at += move == 0 ? 0 : (move & 1 ? 1.0f : -1.0f) * step[move > 2];
                *index = word;
                const double error = rendering_error(s);
                if (error < least * (1 - 1e-4))
                    fail_msg("splat %d, move %d, word %d: error %g is less than %g", i, move, word, error, least);
                *at = old_at;
                *index = old_index;
            }
}

static void test_passes_reach_a_minimum(void **state) {
    (void)state;
    for (int m = 0; m < mapping_count; m++) {
        scene s;
        scene_open(&s, contexts[m]);
        const double before = rendering_error(&s);
        run_until_settled(&s);
        assert_int_equal(gscl_codebook_splats(&s.codebook), SPLATS);
        assert_true(rendering_error(&s) < 0.9 * before);
        check_minimum(&s);
        scene_close(&s);
    }
}

/* With a large lambda an RDO pass drops all splats, unless it must keep them. */
static void test_lambda_and_keep_all(void **state) {
    (void)state;
    for (int m = 0; m < mapping_count; m++)
        for (int keep_all = 0; keep_all < 2; keep_all++) {
            scene s;
            scene_open(&s, contexts[m]);
            run_pass(&s, 1e6, keep_all);
            assert_int_equal(gscl_codebook_splats(&s.codebook), keep_all ? SPLATS : 0);
            scene_close(&s);
        }
}

/* After a pass every word of both books belongs to a splat. */
static void test_unused_words_are_dropped(void **state) {
    (void)state;
    scene s;
    scene_open(&s, contexts[0]);
    s.codebook.books[GSCL_BOOK_SHAPE].count = SHAPES + 3; /* words without splats */
    run_pass(&s, FREE_BITS, true);
    for (int b = 0; b < GSCL_BOOKS; b++) {
        const int count = s.codebook.books[b].count;
        bool used[SHAPES + COLOURS] = {false};
        assert_in_range(count, 1, b == GSCL_BOOK_SHAPE ? SHAPES : COLOURS);
        for (int i = 0; i < SPLATS; i++) {
            assert_in_range(s.codebook.pairs[i][b], 0, count - 1);
            used[s.codebook.pairs[i][b]] = true;
        }
        for (int k = 0; k < count; k++)
            assert_true(used[k]);
    }
    scene_close(&s);
}

/* Passes use the arrays and buffers allocated at first, also when splats are dropped. */
static void test_passes_keep_their_memory(void **state) {
    (void)state;
    scene s;
    scene_open(&s, contexts[0]);
    gscl_codebook_rdo before = s.rdo;
    for (int pass = 0; pass < 3; pass++) {
        run_pass(&s, pass * 0.02, false);
        before.settings = s.rdo.settings; /* the only part that a pass may replace */
        assert_memory_equal(&before, &s.rdo, sizeof before);
    }
    scene_close(&s);
}

static void test_steps_of_words_lower_the_error(void **state) {
    (void)state;
    for (int m = 0; m < mapping_count; m++) {
        scene s;
        scene_open(&s, contexts[m]);
        const double before = rendering_error(&s);
        check_call(&s, gscl_codebook_restart_optimiser(&s.codebook));
        for (int step = 0; step < 30; step++)
            check_call(&s, gscl_codebook_step(&s.codebook, 0.5f));
        check_call(&s, gscl_codebook_read_back(&s.codebook));
        assert_true(rendering_error(&s) < 0.8 * before);
        scene_close(&s);
    }
}

/* With as many words as splats straight-through steps are as free as an ordinary fit, because clustering reproduces
 * each step exactly. */
static void test_straight_through_steps_lower_the_error(void **state) {
    (void)state;
    for (int m = 0; m < mapping_count; m++) {
        scene s;
        uint64_t random = 5;
        scene_open(&s, contexts[m]);
        check_call(&s, gscl_codebook_cluster(&s.codebook, SPLATS, SPLATS, false, &random));
        const double before = rendering_error(&s);
        for (int step = 0; step < 30; step++) {
            check_call(&s, gscl_codebook_step_straight_through(&s.codebook, 0.5f));
            check_call(&s, gscl_codebook_cluster(&s.codebook, SPLATS, SPLATS, true, &random));
        }
        assert_true(rendering_error(&s) < 0.8 * before);
        scene_close(&s);
    }
}

/* Dropping the unused words of a coded image does not change its splats. */
static void test_coded_words_are_dropped(void **state) {
    (void)state;
    float before[SPLATS * GSCL_PARAMS], after[SPLATS * GSCL_PARAMS], background[4];
    scene s;
    scene_open(&s, contexts[0]);
    gsf_coded_image *file = &s.coded.file;
    check_call(&s, gscl_codebook_quantise(&s.codebook, &s.coded));
    const int words = file->codebooks.shape_count + file->codebooks.colour_count;
    file->header.splat_count = 3;
    gscl_coded_image_params(&s.coded, before, background);
    gscl_coded_codebooks_drop_unused(file);
    gscl_coded_image_params(&s.coded, after, background);
    assert_true(file->codebooks.shape_count + file->codebooks.colour_count < words);
    assert_true(file->codebooks.shape_count <= 3 && file->codebooks.colour_count <= 3);
    assert_memory_equal(before, after, 3 * GSCL_PARAMS * sizeof *before);
    scene_close(&s);
}

/* A larger file holds more splats, and larger codebooks leave bytes for fewer. */
static void test_plan(void **state) {
    (void)state;
    double before = 0;
    for (int bytes = 100; bytes < 100000; bytes *= 2) {
        const double splats = gscl_codebook_splats_for(8.0 * bytes, 32, 32, 6, 4);
        assert_true(splats >= 1 && splats >= before);
        before = splats;
    }
    assert_true(before > 10000);
    assert_true(gscl_codebook_splats_for(16000, 64, 64, 6, 4) < gscl_codebook_splats_for(16000, 16, 16, 6, 4));
    assert_true(gscl_codebook_splats_for(16000, 64, 64, 7, 4) < gscl_codebook_splats_for(16000, 64, 64, 6, 4));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_passes_reach_a_minimum),
        cmocka_unit_test(test_lambda_and_keep_all),
        cmocka_unit_test(test_unused_words_are_dropped),
        cmocka_unit_test(test_passes_keep_their_memory),
        cmocka_unit_test(test_steps_of_words_lower_the_error),
        cmocka_unit_test(test_straight_through_steps_lower_the_error),
        cmocka_unit_test(test_coded_words_are_dropped),
        cmocka_unit_test(test_plan),
    };
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
