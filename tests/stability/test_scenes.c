/* Every hard scene, in every blend mode. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* STABILITY_BLEND: a blend's name, or `turn`: of each case one blend, of all cases all, and none of the images, which no
 * kernel knows. */
static bool is_wanted(const scene_case *subject, size_t number, int blend) {
    const char *wanted = getenv("STABILITY_BLEND");
    if (wanted && !strcmp(wanted, "turn"))
        return subject != image_cases && (int)(number % 3) == blend;
    return !wanted || !strcmp(wanted, stability_blends[blend]);
}

int main(void) {
    static const scene_case *const subjects[] = {shape_cases, blending_cases, place_cases, image_cases};
    static hard_test hard[MOST_TESTS];
    static struct CMUnitTest tests[MOST_TESTS];
    size_t count = 0;
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
        for (size_t j = 0; subjects[i][j].name; j++) {
            for (int blend = 0; blend < 3 && count < MOST_TESTS; blend++) {
                if (!is_wanted(subjects[i], j, blend))
                    continue;
                hard[count] = (hard_test){.of = &subjects[i][j], .blend = blend};
                snprintf(hard[count].name, sizeof hard[count].name, "%s, %s", subjects[i][j].name,
                         stability_blends[blend]);
                tests[count] = (struct CMUnitTest){hard[count].name, test_hard_scene, NULL, NULL, &hard[count]};
                count++;
            }
        }
    }
    return _cmocka_run_group_tests("scenes", tests, count, stability_open, stability_close);
}
