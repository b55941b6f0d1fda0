/* Forward and backward pass of the fit against double precision: the rendering, the loss, and the gradient of every kind
 * of parameter, in both mappings. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "both_mappings.h"
#include "cl/constants.h"
#include "fit/fit.h"
#include "fit_oracle.h"
#include "image/image.h"
#include "synthetic_scene.h"

#define WIDTH 43 /* of the full-size image: not a multiple of a tile or a vector, odd at level 1 */
#define HEIGHT 37
#define SAMPLES (WIDTH * HEIGHT * 4)
#define SPLATS 12
#define CROWD 40 /* at tiles of which a work-group takes fewer at a time (backward_splats in cl/fit.cl) */
#define MANY 400

/* ---- Scenes ---- */

typedef struct {
    const char *name;
    gscl_kernel_options options;
    int level;
    size_t count;
    float params[MANY * GSCL_PARAMS];
    float target[SAMPLES];
} fit_case;

static fit_case the_case; /* too large for a stack */

static int channels_of(const fit_case *c) {
    return c->options.colours + c->options.alpha_channel;
}

static int pixels_of(const fit_case *c) {
    return (int)(gscl_level_size(WIDTH, c->level) * gscl_level_size(HEIGHT, c->level));
}

static bool is_used(const fit_case *c, size_t param) {
    return (int)param < GSCL_COLOUR + channels_of(c);
}

static void ordinary_splat(float *p) {
    p[GSCL_X] = synthetic_uniform(0.0, WIDTH);
    p[GSCL_Y] = synthetic_uniform(0.0, HEIGHT);
    p[GSCL_LOG_S1] = synthetic_uniform(log(0.7), log(15.0));
    p[GSCL_LOG_S2] = synthetic_uniform(log(0.7), log(15.0));
    p[GSCL_THETA] = synthetic_uniform(-4.0, 4.0);
    p[GSCL_OPACITY] = synthetic_uniform(-3.0, 3.0);
    for (int k = GSCL_COLOUR; k < GSCL_COLOUR + 4; k++)
        p[k] = synthetic_uniform(-0.2, 1.2);
}

static fit_case *ordinary_case(int blend, int colours, int alpha_channel, int opacity, int loss, int level) {
    fit_case *c = &the_case;
    static char name[80];
    snprintf(name, sizeof name, "blend %d, %d+%d channels, opacity %d, loss %d, level %d", blend, colours,
             alpha_channel, opacity, loss, level);
    c->name = name;
    c->options = (gscl_kernel_options){
        .blend = blend, .colours = colours, .alpha_channel = alpha_channel, .opacity = opacity, .loss = loss};
    c->level = level;
    c->count = SPLATS;
    synthetic_random_state = (uint32_t)(blend + 3 * colours + 17 * alpha_channel + 31 * opacity + 101 * level);
    for (size_t i = 0; i < c->count; i++)
        ordinary_splat(c->params + i * GSCL_PARAMS);
    /* An opaque splat's weight must stay off the clamp of the alpha blend, where there is no derivative. */
    for (size_t i = 0; i < c->count && blend == GSCL_ALPHA && !opacity; i++)
        c->params[i * GSCL_PARAMS + GSCL_LOG_S1] = fminf(c->params[i * GSCL_PARAMS + GSCL_LOG_S1], logf(3.0f));
    for (int i = 0; i < SAMPLES; i++)
        c->target[i] = synthetic_uniform(0.0, 1.0);
    return c;
}

/* ---- The oracle's side ---- */

typedef struct {
    oracle_fit fit;
    double params[CROWD * ORACLE_PARAMS];
    double target[SAMPLES], planes[SAMPLES], weights[WIDTH * HEIGHT], luma_target[WIDTH * HEIGHT];
    double gradient[CROWD * ORACLE_PARAMS];
    double loss;
} reference;

/* Behind the planes of the target, where the errors of luma are weighted. */
static float luma_weight_of(int pixel) {
    return 0.3f * (float)(pixel % 7);
}
static float luma_target_of(int pixel) {
    return 0.1f * (float)(pixel % 11);
}

/* Axis-aligned splats have no angle; circles have one axis. */
static void apply_shape(const fit_case *c, double *params) {
    for (size_t i = 0; i < c->count && c->options.shape != GSCL_SHAPE_ROTATED; i++) {
        double *p = params + i * ORACLE_PARAMS;
        p[GSCL_THETA] = 0.0;
        if (c->options.shape == GSCL_SHAPE_ISOTROPIC)
            p[GSCL_LOG_S2] = p[GSCL_LOG_S1];
    }
}

static void reference_create(const fit_case *c, const float *background, reference *t) {
    t->fit = (oracle_fit){.blend = (oracle_blend)c->options.blend,
                          .colours = c->options.colours,
                          .alpha_channel = c->options.alpha_channel,
                          .opacity = c->options.opacity,
                          .texture = c->options.texture,
                          .absolute = c->options.loss == GSCL_LOSS_KIND_L1,
                          .level = c->level,
                          .width = (int)gscl_level_size(WIDTH, c->level),
                          .height = (int)gscl_level_size(HEIGHT, c->level),
                          .target = t->target};
    for (int k = 0; k < channels_of(c); k++)
        t->fit.background[k] = background[k];
    for (int i = 0; i < SAMPLES; i++)
        t->target[i] = t->planes[i] = c->target[i];
    if (c->options.weighted == GSCL_WEIGHTED_LUMA) {
        for (int i = 0; i < pixels_of(c); i++) {
            t->weights[i] = luma_weight_of(i);
            t->luma_target[i] = luma_target_of(i);
        }
        t->fit.luma_weights = t->weights;
        t->fit.luma_target = t->luma_target;
    }
    if (c->options.weighted == GSCL_WEIGHTED_PIXELS) { /* images of this size have one level */
        oracle_ssim_weights(t->planes, channels_of(c), t->fit.width, t->fit.height, 0, t->weights);
        t->fit.weights = t->weights;
    }
    for (size_t i = 0; i < c->count * GSCL_PARAMS; i++)
        t->params[i] = c->params[i];
    apply_shape(c, t->params);
    oracle_fit_draw(&t->fit, t->params, c->count, t->planes);
    t->loss = oracle_fit_loss(&t->fit, t->params, c->count);
    oracle_fit_gradient(&t->fit, t->params, c->count, 1, t->gradient);
    for (size_t i = 0; i < c->count; i++)
        oracle_shape_gradient(t->gradient + i * ORACLE_PARAMS, c->options.shape == GSCL_SHAPE_ROTATED,
                              c->options.shape == GSCL_SHAPE_ISOTROPIC);
}

/* ---- The library's side ---- */

typedef struct {
    float planes[SAMPLES];
    float gradient[MANY * GSCL_PARAMS];
    float background[4];
    double loss;
} outcome;

static void check_call(gscl_context *context, const char *name, gscl_result result) {
    if (result != GSCL_OK)
        fail_msg("%s: %s", name, gscl_context_message(context));
}

/* Renders the splats and reads the planes. */
static gscl_result render(gscl_fit *fit, float *planes) {
    GSCL_TRY(gscl_renderer_render(&fit->renderer));
    return gscl_buffer_read(fit->context, &fit->renderer.image, 0, planes,
                            gscl_fit_level_pixels(fit) * (size_t)fit->renderer.channels * sizeof *planes);
}

static void write_luma(gscl_fit *fit, const fit_case *c) {
    static float planes[2 * WIDTH * HEIGHT];
    const size_t pixels = (size_t)pixels_of(c);
    for (int i = 0; i < pixels_of(c); i++) {
        planes[i] = luma_weight_of(i);
        planes[pixels_of(c) + i] = luma_target_of(i);
    }
    check_call(fit->context, c->name,
               gscl_buffer_write(fit->context, &fit->pyramid.levels[c->level],
                                 pixels * (size_t)channels_of(c) * sizeof(float), planes, 2 * pixels * sizeof(float)));
}

static void run_case(gscl_context *context, const fit_case *c, outcome *o) {
    gscl_fit fit;
    memset(o, 0, sizeof *o);
    check_call(context, c->name, gscl_fit_create(&fit, context, &c->options, WIDTH, HEIGHT, c->level, c->target));
    check_call(context, c->name, gscl_fit_append(&fit, c->params, c->count));
    assert_int_equal(fit.level, c->level);
    if (c->options.weighted == GSCL_WEIGHTED_LUMA)
        write_luma(&fit, c);
    check_call(context, c->name, gscl_fit_gradients(&fit, o->gradient));
    check_call(context, c->name, gscl_fit_loss(&fit, &o->loss));
    check_call(context, c->name, render(&fit, o->planes));
    memcpy(o->background, fit.background, sizeof o->background);
    gscl_fit_free(&fit);
}

/* ---- Comparison ---- */

static const char *const kinds[] = {"x", "y", "ln s1", "ln s2", "theta", "opacity", "colour"};

static int kind_of(size_t param) {
    return param % GSCL_PARAMS < GSCL_COLOUR ? (int)(param % GSCL_PARAMS) : GSCL_COLOUR;
}

/* Each kind's largest error must stay below `allowed` times its largest gradient. */
static void check_gradient(const fit_case *c, const reference *t, const outcome *o, double allowed) {
    double largest[GSCL_COLOUR + 1] = {0}, error[GSCL_COLOUR + 1] = {0};
    for (size_t i = 0; i < c->count * GSCL_PARAMS; i++) {
        if (!is_used(c, i % GSCL_PARAMS))
            continue;
        const int kind = kind_of(i);
        largest[kind] = fmax(largest[kind], fabs(t->gradient[i]));
        error[kind] = fmax(error[kind], fabs(o->gradient[i] - t->gradient[i]));
    }
    for (int kind = 0; kind <= GSCL_COLOUR; kind++) {
        if (!(error[kind] <= allowed * largest[kind]))
            fail_msg("%s: %s: the gradient is off by %g where the largest is %g", c->name, kinds[kind], error[kind],
                     largest[kind]);
    }
}

static void check_forward(const fit_case *c, const reference *t, const outcome *o) {
    const int samples = pixels_of(c) * channels_of(c);
    for (int i = 0; i < samples; i++) {
        const double apart = fabs(o->planes[i] - t->planes[i]);
        if (!(apart < 2e-5))
            fail_msg("%s: sample %d is off by %g", c->name, i, apart);
    }
    /* The library's loss is the mean of squared (L1: absolute) errors. */
    /* With weighted luma, too, it is divided by the samples alone. */
    const double loss = ldexp(t->loss, -2 * c->level) * (t->fit.absolute ? 1.0 : 2.0) / samples;
    if (!(fabs(o->loss - loss) <= 1e-5 * loss))
        fail_msg("%s: the loss is %.9g, %.9g expected", c->name, o->loss, loss);
}

static void check_case(const fit_case *c, double allowed) {
    static reference t;
    static outcome outcomes[2];
    for (int i = 0; i < mapping_count; i++)
        run_case(contexts[i], c, &outcomes[i]);
    reference_create(c, outcomes[0].background, &t);
    for (int i = 0; i < mapping_count; i++) {
        check_forward(c, &t, &outcomes[i]);
        check_gradient(c, &t, &outcomes[i], allowed);
    }
}

/* ---- Tests ---- */

#define ALLOWED 1e-4 /* of the largest gradient of a kind; single precision is good for 3e-5 here */

/* Every pair of colours, alpha channel and opacity. */
static void check_all_options(int blend, int level) {
    static const int options[4][3] = {{1, 0, 0}, {3, 0, 1}, {3, 1, 0}, {1, 1, 1}};
    for (int i = 0; i < 4; i++)
        check_case(ordinary_case(blend, options[i][0], options[i][1], options[i][2], GSCL_LOSS_KIND_L2, level),
                   ALLOWED);
}

static void test_normalized(void **state) {
    (void)state;
    check_all_options(GSCL_NORMALIZED, 0);
}

static void test_alpha(void **state) {
    (void)state;
    check_all_options(GSCL_ALPHA, 0);
}

static void test_sum(void **state) {
    (void)state;
    check_all_options(GSCL_SUM, 0);
}

static void test_crowded_tiles(void **state) {
    (void)state;
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        fit_case *c = ordinary_case(blend, 3, 0, 1, GSCL_LOSS_KIND_L2, 0);
        c->count = CROWD;
        for (size_t i = SPLATS; i < c->count; i++)
            ordinary_splat(c->params + i * GSCL_PARAMS);
        check_case(c, ALLOWED);
    }
}

static void test_blurred_levels(void **state) {
    (void)state;
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        check_all_options(blend, 1);
        check_case(ordinary_case(blend, 3, 0, 1, GSCL_LOSS_KIND_L2, 2), ALLOWED);
    }
}

static void test_shapes(void **state) {
    (void)state;
    for (int variant = 0; variant < 12; variant++) {
        const int blend = variant % 3, level = variant / 3 % 2;
        fit_case *c = ordinary_case(blend, level ? 1 : 3, level, blend == GSCL_ALPHA, GSCL_LOSS_KIND_L2, level);
        c->options.shape = variant < 6 ? GSCL_SHAPE_AXIS_ALIGNED : GSCL_SHAPE_ISOTROPIC;
        check_case(c, ALLOWED);
    }
}

static void add_wave(float *p) {
    p[GSCL_WAVE_X] = synthetic_uniform(-0.3, 0.3);
    p[GSCL_WAVE_Y] = synthetic_uniform(-0.3, 0.3);
    p[GSCL_WAVE_PHASE] = synthetic_uniform(0.0, 1.0);
    p[GSCL_WAVE_AMPLITUDE] = synthetic_random(3) ? synthetic_uniform(0.0, 0.5) : 0.0f;
}

/* Adds the gradients of the rows that are drawn to those of the others. */
static void add_gradients_of_rows(gscl_fit *fit, const fit_case *c, float *total) {
    static float gradients[MANY * GSCL_PARAMS];
    fit->has_old_lists = true;
    check_call(fit->context, c->name, gscl_renderer_project(&fit->renderer));
    check_call(fit->context, c->name, gscl_fit_differentiate(fit));
    check_call(fit->context, c->name,
               gscl_buffer_read(fit->context, &fit->gradients, 0, gradients, c->count * GSCL_PARAMS * sizeof(float)));
    for (size_t i = 0; i < c->count * GSCL_PARAMS; i++)
        total[i] += 0.5f * gradients[i];
}

/* The rows that a step at 2 sees, and those that the next one sees, have the gradients of all rows together. */
static void check_second_rows(const fit_case *c) {
    static reference t;
    static outcome o;
    for (int m = 0; m < mapping_count; m++) {
        gscl_fit fit;
        memset(&o, 0, sizeof o);
        check_call(contexts[m], c->name, gscl_fit_create(&fit, contexts[m], &c->options, WIDTH, HEIGHT, 0, c->target));
        check_call(contexts[m], c->name, gscl_fit_append(&fit, c->params, c->count));
        if (c->options.weighted == GSCL_WEIGHTED_LUMA)
            write_luma(&fit, c);
        check_call(contexts[m], c->name, gscl_fit_set_rows(&fit, 2));
        assert_int_equal(fit.renderer.height, (HEIGHT + 1) / 2);
        add_gradients_of_rows(&fit, c, o.gradient);
        gscl_fit_next_rows(&fit);
        assert_int_equal(fit.renderer.height, HEIGHT / 2);
        add_gradients_of_rows(&fit, c, o.gradient);
        reference_create(c, fit.background, &t);
        check_gradient(c, &t, &o, ALLOWED);
        gscl_fit_free(&fit);
    }
}

static void test_every_second_row(void **state) {
    (void)state;
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        for (int variant = 0; variant < 4; variant++) {
            fit_case *c = ordinary_case(blend, variant ? 3 : 1, variant == 1, variant == 2 || blend == GSCL_ALPHA,
                                        GSCL_LOSS_KIND_L2, 0);
            c->options.texture = variant == 3;
            c->options.weighted = variant == 1 ? GSCL_WEIGHTED_LUMA : GSCL_WEIGHTED_NOT;
            for (size_t i = 0; i < c->count && variant == 3; i++)
                add_wave(c->params + i * GSCL_PARAMS);
            if (variant == 0) {
                c->options.shape = GSCL_SHAPE_AXIS_ALIGNED;
                for (size_t i = 0; i < c->count; i++)
                    c->params[i * GSCL_PARAMS + GSCL_THETA] = 0.0f;
            }
            check_second_rows(c);
        }
    }
}

/* Three steps, of one kernel each or of two; reads the parameters and the projected splats. */
static void take_steps(gscl_context *in, const fit_case *c, bool in_parts, float *params, float *projected) {
    gscl_fit fit;
    check_call(in, c->name, gscl_fit_create(&fit, in, &c->options, WIDTH, HEIGHT, 0, c->target));
    check_call(in, c->name, gscl_fit_append(&fit, c->params, c->count));
    fit.fixed = 1;
    for (int step = 0; step < 3; step++) {
        fit.has_old_lists = true;
        if (in_parts) {
            check_call(in, c->name, gscl_fit_differentiate(&fit));
            check_call(in, c->name, gscl_fit_adam(&fit, &fit.renderer.params, 1.0f));
        } else {
            check_call(in, c->name, gscl_fit_step(&fit, 1.0f, 1));
        }
    }
    check_call(in, c->name, gscl_fit_read(&fit, params));
    check_call(in, c->name,
               gscl_buffer_read(in, &fit.renderer.projected, 0, projected, c->count * GSCL_PROJECTED * sizeof(float)));
    gscl_fit_free(&fit);
}

static void test_a_step_is_its_parts(void **state) {
    (void)state;
    static float params[2][MANY * GSCL_PARAMS], projected[2][MANY * GSCL_PROJECTED];
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        const fit_case *c = ordinary_case(blend, 3, 0, blend == GSCL_ALPHA, GSCL_LOSS_KIND_L2, 0);
        for (int m = 0; m < mapping_count; m++) {
            memset(projected, 0, sizeof projected);
            for (int in_parts = 0; in_parts < 2; in_parts++)
                take_steps(contexts[m], c, in_parts, params[in_parts], projected[in_parts]);
            assert_memory_equal(params[0], params[1], c->count * GSCL_PARAMS * sizeof(float));
            assert_memory_equal(params[0], c->params, 10 * sizeof(float)); /* the fixed one, but its wave */
            assert_memory_not_equal(params[0] + GSCL_PARAMS, c->params + GSCL_PARAMS, sizeof(float));
            for (size_t i = 0; i < c->count * GSCL_PROJECTED; i++)
                if (i % GSCL_PROJECTED < GSCL_PROJECTED_COLOUR + 3)
                    assert_true(projected[0][i] == projected[1][i]);
        }
    }
}

/* A tile without error is skipped for some steps, and computed again for gscl_fit_gradients. */
static void test_tiles_without_error_are_skipped(void **state) {
    (void)state;
    enum { W = 96, H = 64, PLANE = W * H, TILES = 6 * 4 };
    static float target[PLANE], gradients[3 * GSCL_PARAMS], again[3 * GSCL_PARAMS];
    const float params[3][GSCL_PARAMS] = {{20.0f, 20.0f, 1.5f, 1.5f, 0.0f, 0.0f, 1.0f},
                                          {30.0f, 40.0f, 1.5f, 1.0f, 0.5f, 0.0f, 0.0f},
                                          {80.0f, 30.0f, 2.0f, 2.0f, 0.0f, 0.0f, 0.5f}};
    int32_t skip_until[TILES];
    for (int i = 0; i < PLANE; i++)
        target[i] = i % W < 48 ? synthetic_uniform(0.0, 1.0) : 0.5f;
    for (int m = 0; m < mapping_count; m++) {
        gscl_fit fit;
        const gscl_kernel_options options = {.blend = GSCL_NORMALIZED, .colours = 1};
        int skipped = 0, computed = 0;
        check_call(contexts[m], "create", gscl_fit_create(&fit, contexts[m], &options, W, H, 0, target));
        check_call(contexts[m], "append", gscl_fit_append(&fit, &params[0][0], 3));
        for (int step = 0; step < 10; step++)
            check_call(contexts[m], "step", gscl_fit_step(&fit, 1e-6f, 1));
        check_call(contexts[m], "read",
                   gscl_buffer_read(contexts[m], &fit.skip.skip_until, 0, skip_until, sizeof skip_until));
        for (int i = 0; i < TILES; i++) {
            skipped += i % 6 >= 3 && skip_until[i] > fit.skip.step;
            computed += i % 6 < 3 && skip_until[i] == 0;
        }
        assert_int_equal(skipped, TILES / 2);
        assert_int_equal(computed, TILES / 2);
        check_call(contexts[m], "gradients", gscl_fit_gradients(&fit, gradients));
        assert_true(gradients[2 * GSCL_PARAMS + GSCL_COLOUR] != 0.0f);
        check_call(contexts[m], "gradients", gscl_fit_gradients(&fit, again));
        assert_memory_equal(gradients, again, sizeof gradients);
        gscl_fit_free(&fit);
    }
}

static void test_textures(void **state) {
    (void)state;
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        for (int level = 0; level < 2; level++) {
            fit_case *c = ordinary_case(blend, level ? 1 : 3, 1, blend == GSCL_ALPHA, GSCL_LOSS_KIND_L2, level);
            c->options.texture = 1;
            for (size_t i = 0; i < c->count; i++)
                add_wave(c->params + i * GSCL_PARAMS);
            check_case(c, ALLOWED);
        }
    }
}

static void test_weighted_errors(void **state) {
    (void)state;
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        for (int level = 0; level < 2; level++) {
            fit_case *c = ordinary_case(blend, level ? 1 : 3, 1, blend == GSCL_ALPHA, GSCL_LOSS_KIND_L2, level);
            c->options.weighted = GSCL_WEIGHTED_PIXELS;
            for (int i = 0; i < SAMPLES; i++) /* smooth on one side, so that weights differ */
                c->target[i] = i % WIDTH < WIDTH / 2 ? 0.01f * (float)(i % WIDTH) : c->target[i];
            check_case(c, ALLOWED);
        }
    }
}

static void test_weighted_luma(void **state) {
    (void)state;
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        for (int level = 0; level < 2; level++) {
            fit_case *c = ordinary_case(blend, level ? 1 : 3, 1, blend == GSCL_ALPHA, GSCL_LOSS_KIND_L2, level);
            c->options.weighted = GSCL_WEIGHTED_LUMA;
            check_case(c, ALLOWED);
        }
    }
}

/* The planes of weights behind the targets of all levels, in an image of three. */
static void test_ssim_weights(void **state) {
    (void)state;
    enum { W = 150, H = 129, PLANE = W * H, HALF_PLANE = 75 * 65 };
    static float planes[3 * PLANE], found[4 * PLANE];
    static double expected_planes[3 * PLANE], expected[PLANE];
    for (int i = 0; i < 3 * PLANE; i++)
        planes[i] = i % W < W / 2 ? 0.004f * (float)(i % W) : synthetic_uniform(0.2, i % PLANE < PLANE / 2 ? 0.3 : 0.9);
    for (int i = 0; i < 3 * PLANE; i++)
        expected_planes[i] = planes[i];
    oracle_ssim_weights(expected_planes, 3, W, H, 2, expected);
    for (int m = 0; m < mapping_count; m++) {
        gscl_fit fit;
        const gscl_kernel_options options = {.colours = 3, .weighted = GSCL_WEIGHTED_PIXELS};
        check_call(contexts[m], "create", gscl_fit_create(&fit, contexts[m], &options, W, H, 0, planes));
        assert_int_equal(fit.pyramid.last_level, 2);
        check_call(contexts[m], "read", gscl_buffer_read(contexts[m], &fit.pyramid.levels[0], 0, found, sizeof found));
        for (int i = 0; i < PLANE; i++)
            if (!(fabs(found[3 * PLANE + i] - expected[i]) <= 2e-4 * expected[i]))
                fail_msg("pixel (%d, %d) has the weight %.7g, %.7g expected", i % W, i / W, found[3 * PLANE + i],
                         expected[i]);
        check_call(contexts[m], "read",
                   gscl_buffer_read(contexts[m], &fit.pyramid.levels[1], 0, found, 4 * HALF_PLANE * sizeof(float)));
        for (int i = 0; i < W / 2 * (H / 2); i++) {
            const double *at = expected + 2 * (i / (W / 2)) * W + 2 * (i % (W / 2));
            const double mean = (at[0] + at[1] + at[W] + at[W + 1]) / 4.0;
            assert_float_equal(found[3 * HALF_PLANE + i], mean, 2e-4 * mean);
        }
        gscl_fit_free(&fit);
    }
}

/* The target with raised contrast and its weights, adapted to a rendering. */
static void test_ssim_adaptation(void **state) {
    (void)state;
    enum { W = 149, H = 131, PLANE = W * H };
    static float planes[3 * PLANE], projected[3 * PLANE], found[4 * PLANE], params[SPLATS * GSCL_PARAMS];
    static double expected_planes[3 * PLANE], rendering[3 * PLANE], expected[4 * PLANE];
    synthetic_random_state = 3;
    for (int i = 0; i < 3 * PLANE; i++)
        planes[i] =
            0.5f + 0.2f * sinf(0.1f * (float)(i % W)) * cosf(0.12f * (float)(i / W % H)) + synthetic_uniform(-0.1, 0.1);
    for (int i = 0; i < SPLATS; i++) {
        ordinary_splat(params + i * GSCL_PARAMS);
        params[i * GSCL_PARAMS + GSCL_X] = synthetic_uniform(0, W);
        params[i * GSCL_PARAMS + GSCL_Y] = synthetic_uniform(0, H);
    }
    for (int m = 0; m < mapping_count; m++) {
        gscl_fit fit;
        const gscl_kernel_options options = {.colours = 3, .weighted = GSCL_WEIGHTED_PIXELS};
        check_call(contexts[m], "create", gscl_fit_create(&fit, contexts[m], &options, W, H, 0, planes));
        check_call(contexts[m], "append", gscl_fit_append(&fit, params, SPLATS));
        assert_ptr_equal(gscl_fit_weighted_target(&fit), &fit.pyramid.levels[0]);
        check_call(contexts[m], "adapt", gscl_fit_adapt_target(&fit));
        assert_ptr_equal(gscl_fit_weighted_target(&fit), &fit.adapted_target);
        check_call(contexts[m], "read", gscl_buffer_read(contexts[m], &fit.adapted_target, 0, found, sizeof found));
        check_call(contexts[m], "planes", render(&fit, projected));
        for (int i = 0; i < 3 * PLANE; i++) {
            expected_planes[i] = planes[i];
            rendering[i] = projected[i];
        }
        oracle_ssim_adapt(expected_planes, rendering, 3, W, H, fit.pyramid.last_level, expected);
        for (int i = 0; i < 4 * PLANE; i++)
            if (!(fabs(found[i] - expected[i]) <= 5e-4))
                fail_msg("plane %d, pixel (%d, %d) is %.7g, %.7g expected", i / PLANE, i % W, i / W % H, found[i],
                         expected[i]);
        check_call(contexts[m], "level", gscl_fit_set_level(&fit, 1));
        assert_ptr_equal(gscl_fit_weighted_target(&fit), &fit.pyramid.levels[1]);
        gscl_fit_free(&fit);
    }
}

/* The errors must be far from 0, where |e| has no derivative. */
static void test_absolute_loss(void **state) {
    (void)state;
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        for (int level = 0; level < 2; level++) {
            fit_case *c = ordinary_case(blend, 3, 0, 1, GSCL_LOSS_KIND_L1, level);
            for (int i = 0; i < SAMPLES; i++)
                c->target[i] += c->target[i] < 0.5f ? -20.0f : 20.0f;
            check_case(c, ALLOWED);
        }
    }
}

static void test_isotropic_splats_have_no_angle(void **state) {
    (void)state;
    static outcome o;
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        for (int level = 0; level < 2; level++) {
            fit_case *c = ordinary_case(blend, 3, 0, 1, GSCL_LOSS_KIND_L2, level);
            for (size_t i = 0; i < c->count; i++)
                c->params[i * GSCL_PARAMS + GSCL_LOG_S2] = c->params[i * GSCL_PARAMS + GSCL_LOG_S1];
            for (int m = 0; m < mapping_count; m++) {
                run_case(contexts[m], c, &o);
                for (size_t i = 0; i < c->count; i++)
                    assert_true(o.gradient[i * GSCL_PARAMS + GSCL_THETA] == 0.0f);
            }
        }
    }
}

static void check_finite(const fit_case *c, const outcome *o) {
    for (int i = 0; i < pixels_of(c) * channels_of(c); i++)
        if (!isfinite(o->planes[i]))
            fail_msg("%s: sample %d is %g", c->name, i, o->planes[i]);
    for (size_t i = 0; i < c->count * GSCL_PARAMS; i++)
        if (is_used(c, i % GSCL_PARAMS) && !isfinite(o->gradient[i]))
            fail_msg("%s: splat %zu, %s: gradient %g", c->name, i / GSCL_PARAMS, kinds[kind_of(i)], o->gradient[i]);
    assert_true(isfinite(o->loss));
}

static void check_hard(const fit_case *c) {
    static outcome o;
    for (int m = 0; m < mapping_count; m++) {
        run_case(contexts[m], c, &o);
        check_finite(c, &o);
    }
}

/* Many splats on top of each other with the highest opacities: the alpha blend's clamp, and a transmittance of 0. */
static void test_opaque_stacks_are_finite(void **state) {
    (void)state;
    for (int options = 0; options < 12; options++) {
        fit_case *c = ordinary_case(options % 3, 3, 0, options / 3 & 1, GSCL_LOSS_KIND_L2, options / 6);
        c->count = MANY;
        for (size_t i = 0; i < c->count; i++) {
            float *p = c->params + i * GSCL_PARAMS;
            ordinary_splat(p);
            p[GSCL_X] = 20.5f;
            p[GSCL_Y] = 16.5f;
            p[GSCL_OPACITY] = i % 2 ? 8.0f : 30.0f;
        }
        check_hard(c);
    }
}

/* Very long, large and small splats, splats far outside, extreme opacities and colours. */
static void test_hard_scenes_are_finite(void **state) {
    (void)state;
    for (int options = 0; options < 12; options++) {
        fit_case *c = ordinary_case(options % 3, 3, 0, options / 3 & 1, GSCL_LOSS_KIND_L2, options / 6);
        c->count = MANY;
        for (size_t i = 0; i < c->count; i++) {
            float *p = c->params + i * GSCL_PARAMS;
            ordinary_splat(p);
            p[GSCL_X] = synthetic_uniform(-WIDTH, 2.0 * WIDTH);
            p[GSCL_Y] = synthetic_uniform(-HEIGHT, 2.0 * HEIGHT);
            p[GSCL_LOG_S1] = synthetic_uniform(log(0.05), log(30000.0));
            p[GSCL_LOG_S2] = synthetic_uniform(log(0.05), log(30000.0));
            p[GSCL_OPACITY] = synthetic_uniform(-40.0, 40.0);
            for (int k = GSCL_COLOUR; k < GSCL_COLOUR + 4; k++)
                p[k] = synthetic_uniform(-2.0, 3.0);
        }
        check_hard(c);
    }
}

/* A clamped splat's weight has no derivative; its colour and the splats behind it have one. */
static void test_clamped_alpha(void **state) {
    (void)state;
    static outcome o;
    fit_case *c = ordinary_case(GSCL_ALPHA, 3, 0, 0, GSCL_LOSS_KIND_L2, 0);
    static const float splats[2][GSCL_PARAMS] = {{20.5f, 16.5f, 0.2f, 0.2f, 0.0f, 0.0f, 0.9f, 0.1f, 0.4f, 0.0f},
                                                 {20.5f, 16.5f, 9.0f, 9.0f, 0.0f, 0.0f, 0.5f, 0.5f, 0.1f, 0.0f}};
    c->count = 2;
    memcpy(c->params, splats, sizeof splats);
    for (int m = 0; m < mapping_count; m++) {
        run_case(contexts[m], c, &o);
        check_finite(c, &o);
        for (int k = GSCL_X; k <= GSCL_THETA; k++)
            assert_true(o.gradient[GSCL_PARAMS + k] == 0.0f);
        assert_true(o.gradient[GSCL_COLOUR] != 0.0f && o.gradient[GSCL_PARAMS + GSCL_COLOUR] != 0.0f);
    }
}

static void test_same_input_gives_the_same_bits(void **state) {
    (void)state;
    static outcome first, second;
    for (int blend = GSCL_NORMALIZED; blend <= GSCL_SUM; blend++) {
        for (int level = 0; level < 2; level++) {
            fit_case *c = ordinary_case(blend, 3, 0, 1, GSCL_LOSS_KIND_L2, level);
            c->count = MANY;
            for (size_t i = 0; i < c->count; i++)
                ordinary_splat(c->params + i * GSCL_PARAMS);
            for (int m = 0; m < mapping_count; m++) {
                run_case(contexts[m], c, &first);
                run_case(contexts[m], c, &second);
                for (size_t i = 0; i < c->count * GSCL_PARAMS; i++)
                    assert_true(!is_used(c, i % GSCL_PARAMS) ||
                                !memcmp(&first.gradient[i], &second.gradient[i], sizeof(float)));
                assert_memory_equal(first.planes, second.planes, sizeof first.planes);
                assert_true(first.loss == second.loss);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_normalized),
        cmocka_unit_test(test_alpha),
        cmocka_unit_test(test_sum),
        cmocka_unit_test(test_crowded_tiles),
        cmocka_unit_test(test_blurred_levels),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_a_step_is_its_parts),
        cmocka_unit_test(test_every_second_row),
        cmocka_unit_test(test_tiles_without_error_are_skipped),
        cmocka_unit_test(test_textures),
        cmocka_unit_test(test_weighted_errors),
        cmocka_unit_test(test_weighted_luma),
        cmocka_unit_test(test_ssim_weights),
        cmocka_unit_test(test_ssim_adaptation),
        cmocka_unit_test(test_absolute_loss),
        cmocka_unit_test(test_isotropic_splats_have_no_angle),
        cmocka_unit_test(test_opaque_stacks_are_finite),
        cmocka_unit_test(test_hard_scenes_are_finite),
        cmocka_unit_test(test_clamped_alpha),
        cmocka_unit_test(test_same_input_gives_the_same_bits),
    };
    return cmocka_run_group_tests(tests, open_contexts, close_contexts);
}
