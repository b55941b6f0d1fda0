/* Every hard scene, in every blend mode. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "check.h"

#define MOST_TESTS 200

/* One test. */
typedef struct {
    const scene_case *of;
    int blend;
    char name[100];
} hard_test;

static void test_hard_scene(void **state) {
    static scene s;
    const hard_test *t = *state;
    scene_begin(&s, t->of->name, t->blend);
    t->of->make(&s);
    check_scene(&s);
}

int main(void) {
    static const scene_case *const subjects[] = {shape_cases, blending_cases, place_cases, image_cases};
    static hard_test hard[MOST_TESTS];
    static struct CMUnitTest tests[MOST_TESTS];
    size_t count = 0;
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
        for (const scene_case *c = subjects[i]; c->name; c++) {
            for (int blend = 0; blend < 3 && count < MOST_TESTS; blend++, count++) {
                hard[count] = (hard_test){.of = c, .blend = blend};
                snprintf(hard[count].name, sizeof hard[count].name, "%s, %s", c->name, stability_blends[blend]);
                tests[count] = (struct CMUnitTest){hard[count].name, test_hard_scene, NULL, NULL, &hard[count]};
            }
        }
    }
    return _cmocka_run_group_tests("scenes", tests, count, stability_open, stability_close);
}
