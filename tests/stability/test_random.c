/* Random scenes that combine all hard cases, each compared with its own bounds.
 *
 * Seeds that have failed are listed in seeds.txt and run first.  STABILITY_SEED=N runs that seed alone.
 * STABILITY_SCENES=N sets the number of seeds. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "check.h"
#include "report.h"
#include "synthetic_scene.h"

#define SCENES 3000
#define FEW_SCENES 24
#define MAX_SPLATS 12
#define FILE_INTERVAL 10 /* one scene in FILE_INTERVAL is also written to a file */
#define MAX_PRINTED 5    /* maximum number of failing seeds that are printed */

static const double pi = 3.14159265358979323846;

/* ---- Scenes ---- */

static float random_place(int size) {
    const float on_border = 16.0f * (float)synthetic_random(3);
    switch (synthetic_random(8)) {
    case 0:
        return on_border;
    case 1:
        return nextafterf(on_border, synthetic_random(2) ? 100.0f : -100.0f);
    case 2:
        return synthetic_uniform(-3.0 * size, 4.0 * size);
    case 3:
        return (float)synthetic_random((uint32_t)size) + 0.5f;
    case 4:
        return (float)scene_log_uniform(1e-3, 1e6) * (synthetic_random(2) ? 1.0f : -1.0f);
    default:
        return synthetic_uniform(0.0, size);
    }
}

static float random_angle(void) {
    const float right = (float)((double)synthetic_random(5) * pi / 2.0);
    switch (synthetic_random(4)) {
    case 0:
        return right;
    case 1:
        return nextafterf(right, synthetic_random(2) ? 100.0f : -100.0f);
    default:
        return synthetic_uniform(-7.0, 7.0);
    }
}

static float random_logit(void) {
    switch (synthetic_random(8)) {
    case 0:
        return synthetic_random(2) ? INFINITY : -INFINITY;
    case 1:
        return synthetic_uniform(-20.0, -8.0);
    case 2:
        return synthetic_uniform(8.0, 20.0);
    default:
        return synthetic_uniform(-4.0, 4.0);
    }
}

static void random_axes(float *p) {
    const double s1 = synthetic_random(3) ? scene_log_uniform(0.3, 30.0) : scene_log_uniform(1e-3, 1e6);
    const double aspect = synthetic_random(3) ? scene_log_uniform(1.0, 10.0) : scene_log_uniform(1.0, 1e6);
    scene_set_axes(p, s1, fmax(s1 / aspect, 1e-3));
    if (synthetic_random(4) == 0)
        p[GSCL_LOG_S2] = p[GSCL_LOG_S1];
    if (synthetic_random(2)) {
        const float first = p[GSCL_LOG_S1];
        p[GSCL_LOG_S1] = p[GSCL_LOG_S2];
        p[GSCL_LOG_S2] = first;
    }
}

static void random_scene(scene *s, uint32_t seed) {
    char name[40];
    snprintf(name, sizeof name, "seed %u", seed);
    scene_begin(s, name, (int)(seed % 3));
    synthetic_random_state = 2654435761u * (seed + 1);
    synthetic_random(2);
    const int width = 1 + (int)synthetic_random(synthetic_random(3) ? 24 : 60), height = 1 + (int)synthetic_random(24);
    s->level = width >= 4 && height >= 4 && synthetic_random(4) == 0 ? 1 : 0;
    scene_resize(s, width, height);
    const double colours = synthetic_random(8) ? 1.5 : scene_log_uniform(1.0, 1e4);
    for (uint32_t count = synthetic_random(MAX_SPLATS + 1); count > 0; count--) {
        float *p = scene_add(s);
        p[GSCL_X] = random_place(width);
        p[GSCL_Y] = random_place(height);
        random_axes(p);
        p[GSCL_THETA] = random_angle();
        p[GSCL_OPACITY] = random_logit();
        for (int k = 0; k < SCENE_CHANNELS; k++)
            p[GSCL_COLOUR + k] = synthetic_uniform(-colours, colours);
    }
}

/* ---- Runs ---- */

static double largest_share;
static int failures;

static void run_seed(uint32_t seed) {
    static scene s;
    scene_errors errors[STABILITY_MAPPINGS];
    char message[300];
    random_scene(&s, seed);
    if (scene_agrees(&s, errors, message, sizeof message) &&
        (seed % FILE_INTERVAL != 0 || scene_file_decodes(&s, message, sizeof message))) {
        largest_share = fmax(largest_share, fmax(errors[0].share, errors[1].share));
        return;
    }
    if (failures++ < MAX_PRINTED)
        print_error("%s, %s: %s; to repeat: STABILITY_SEED=%u; keep it in tests/stability/seeds.txt\n", s.name,
                    stability_blends[s.blend], message, seed);
}

static uint32_t number_of(const char *variable, uint32_t otherwise) {
    const char *text = getenv(variable);
    return text ? (uint32_t)strtoul(text, NULL, 10) : otherwise;
}

static void test_seeds_that_failed(void **state) {
    (void)state;
    FILE *file = fopen(STABILITY_SEEDS, "r");
    char line[200];
    assert_non_null(file);
    failures = 0;
    while (fgets(line, sizeof line, file))
        if (line[0] >= '0' && line[0] <= '9')
            run_seed((uint32_t)strtoul(line, NULL, 10));
    fclose(file);
    assert_int_equal(failures, 0);
}

static void test_random_scenes(void **state) {
    (void)state;
    const bool one = getenv("STABILITY_SEED") != NULL;
    const uint32_t first = number_of("STABILITY_SEED", 0);
    const uint32_t count = one ? 1 : number_of("STABILITY_SCENES", (uint32_t)scene_scaled(SCENES, FEW_SCENES));
    failures = 0;
    for (uint32_t seed = first; seed < first + count; seed++)
        run_seed(seed);
    report("random scenes", "forward and backward", "", "largest error, of its bound", 1.0, largest_share);
    if (failures > 0)
        fail_msg("%d of %u seeds fail", failures, count);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_seeds_that_failed),
        cmocka_unit_test(test_random_scenes),
    };
    return cmocka_run_group_tests(tests, stability_open, stability_close);
}
