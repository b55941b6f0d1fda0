/* All hard scenes in all blend modes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

#define MAX_TESTS 400

static const char *const shapes[] = {"rotated", "axis-aligned", "isotropic"}; /* GSCL_SHAPE_... */

/* One test case. */
typedef struct {
    const scene_case *of;
    int blend, shape;
    char name[100];
} hard_test;

static void test_hard_scene(void **state) {
    static scene s;
    const hard_test *t = *state;
    scene_begin(&s, t->of->name, t->blend);
    t->of->make(&s);
    scene_set_shape(&s, t->shape);
    if (t->shape != GSCL_SHAPE_ROTATED)
        snprintf(s.name + strlen(s.name), sizeof s.name - strlen(s.name), ", %s", shapes[t->shape]);
    check_scene(&s);
}

/* STABILITY_BLEND is the name of a blend, or `alternate`: then each case runs in one blend, so that all blends occur,
 * and the image cases do not run, because no kernel depends on them. */
static bool is_selected(const scene_case *subject, size_t number, int blend, int shape) {
    const char *selected = getenv("STABILITY_BLEND");
    if (shape != GSCL_SHAPE_ROTATED && subject == image_cases)
        return false;
    if (selected && !strcmp(selected, "alternate"))
        return subject != image_cases && (int)(number % 3) == blend && (shape == GSCL_SHAPE_ROTATED || number % 4 == 0);
    return !selected || !strcmp(selected, stability_blends[blend]);
}

static hard_test hard[MAX_TESTS];
static size_t hard_count;

static void add_tests(const scene_case *subject, size_t number, int shape) {
    for (int blend = 0; blend < 3; blend++) {
        if (hard_count == MAX_TESTS || !is_selected(subject, number, blend, shape))
            continue;
        hard_test *test = &hard[hard_count++];
        *test = (hard_test){.of = &subject[number], .blend = blend, .shape = shape};
        snprintf(test->name, sizeof test->name, "%s, %s, %s", subject[number].name, shapes[shape],
                 stability_blends[blend]);
    }
}

int main(void) {
    static const scene_case *const subjects[] = {shape_cases, blending_cases, place_cases, image_cases};
    static struct CMUnitTest tests[MAX_TESTS];
    for (int shape = GSCL_SHAPE_ROTATED; shape <= GSCL_SHAPE_ISOTROPIC; shape++)
        for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++)
            for (size_t j = 0; subjects[i][j].name; j++)
                add_tests(subjects[i], j, shape);
    for (size_t i = 0; i < hard_count; i++)
        tests[i] = (struct CMUnitTest){hard[i].name, test_hard_scene, NULL, NULL, &hard[i]};
    return _cmocka_run_group_tests("scenes", tests, hard_count, stability_open, stability_close);
}
