/* For programs of which some tests need an encoder, or OpenCL, and the others only a library that decodes.  After cmocka.h. */
#ifndef GSCL_JOINED_TESTS_H
#define GSCL_JOINED_TESTS_H

#include <string.h>

#define MAX_TESTS 100

static struct CMUnitTest joined_tests[MAX_TESTS];
static size_t joined_count;

static inline void join_tests(const struct CMUnitTest *tests, size_t count) {
    assert_true(joined_count + count <= MAX_TESTS);
    memcpy(joined_tests + joined_count, tests, count * sizeof *tests);
    joined_count += count;
}

/* Adds an array of tests to those of the program. */
#define JOIN_TESTS(tests) join_tests(tests, sizeof(tests) / sizeof *(tests))

/* Runs all that were added as one group. */
static inline int run_joined_tests(CMFixtureFunction set_up, CMFixtureFunction tear_down) {
    return _cmocka_run_group_tests("tests", joined_tests, joined_count, set_up, tear_down);
}

#endif
