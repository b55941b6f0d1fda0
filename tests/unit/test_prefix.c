/* Reading the first bytes of a file: the splats that are certain, for every prefix of files of each kind. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "format/format.h"
#include "synthetic_scene.h"

enum { MAX_SIZE = 16384, SPLATS = 120 };

/* A written file with what it holds. */
typedef struct written {
    synthetic_scene *scene;
    uint8_t bytes[MAX_SIZE];
    size_t size;
} written;

static const uint8_t note[40] = "a block after the picture";
static const gsf_bytes blocks[GSF_BLOCK_COUNT] = {[GSF_BLOCK_XMP] = {note, sizeof note}};

/* `number` selects the header of a scene with scalar coding. */
static void write_scene(written *w, int number, bool bare, bool with_block) {
    gsf_header header = synthetic_header(number, GSF_CODING_SCALAR);
    header.splat_count = SPLATS;
    w->scene = synthetic_scene_new(&header);
    assert_non_null(w->scene);
    gsf_coded_image *image = &w->scene->image;
    synthetic_random_state = 77 + (uint32_t)number;
    synthetic_background(image);
    synthetic_steps(image);
    for (uint32_t i = 0; i < SPLATS; i++)
        synthetic_splat(image, &image->splats[i], synthetic_random(8), header.has_anisotropy ? synthetic_random(8) : 0);
    image->bare = bare;
    image->blocks = with_block ? blocks : NULL;
    void *scratch = malloc(gsf_scratch_size(&header));
    assert_non_null(scratch);
    assert_int_equal(gsf_write(image, w->bytes, MAX_SIZE, &w->size, scratch), GSF_OK);
    free(scratch);
}

/* The certain splats of the first `size` bytes, which must be the first of the whole file. */
static uint32_t check_prefix(const written *w, size_t size) {
    const gsf_coded_image *whole = &w->scene->image;
    uint8_t *exact = malloc(size + 1); /* lets a sanitizer see reads beyond the prefix */
    void *scratch = malloc(gsf_scratch_size(&whole->header));
    gsf_splat *splats = calloc(SPLATS, sizeof *splats);
    gsf_coded_image image = {.splats = splats, .bare = whole->bare};
    uint32_t total = 0;
    assert_true(exact && scratch && splats);
    memcpy(exact, w->bytes, size);
    const gsf_result result = gsf_read_prefix(exact, size, &image, &total, scratch);
    const uint32_t certain = result == GSF_OK ? image.header.splat_count : 0;
    assert_true(result == GSF_OK || result == GSF_TRUNCATED || (result == GSF_NOT_GSCL && size < 4));
    if (result == GSF_OK)
        assert_int_equal(total, SPLATS);
    assert_memory_equal(splats, whole->splats, certain * sizeof *splats);
    free(exact);
    free(scratch);
    free(splats);
    return certain;
}

static void check_all_prefixes(int number, bool bare, bool with_block) {
    static written w;
    write_scene(&w, number, bare, with_block);
    uint32_t before = 0;
    for (size_t size = 0; size <= w.size; size++) {
        const uint32_t certain = check_prefix(&w, size);
        assert_true(certain >= before);
        before = certain;
        /* A reader lags behind by the four bytes of the decoder, the two of the check and the splat itself. */
        if (size > 60 && !with_block)
            assert_true((certain + 12.0) / SPLATS > (double)size / (double)w.size - 0.2);
    }
    assert_int_equal(before, SPLATS);
    if (with_block) /* the whole picture has come, and the block has not */
        assert_int_equal(check_prefix(&w, w.size - 10), SPLATS);
    synthetic_scene_free(w.scene);
}

static void test_complete_files(void **unused) {
    (void)unused;
    for (int number = 0; number < 12; number++)
        check_all_prefixes(number, false, false);
}

static void test_bare_files(void **unused) {
    (void)unused;
    for (int number = 0; number < 12; number++)
        check_all_prefixes(number, true, false);
}

static void test_files_with_blocks(void **unused) {
    (void)unused;
    for (int number = 0; number < 12; number++)
        check_all_prefixes(number, false, true);
}

static void test_library_counts(void **unused) {
    (void)unused;
    static written w;
    uint32_t certain = 0, total = 0;
    write_scene(&w, 1, false, false);
    assert_int_equal(gscl_certain_splats(w.bytes, w.size / 2, NULL, &certain, &total), GSCL_OK);
    assert_int_equal(total, SPLATS);
    assert_in_range(certain, SPLATS / 4, SPLATS - 1);
    assert_int_equal(gscl_certain_splats(w.bytes, w.size, NULL, &certain, &total), GSCL_OK);
    assert_int_equal(certain, SPLATS);
    assert_int_equal(gscl_certain_splats(w.bytes, 8, NULL, &certain, &total), GSCL_ERROR_TRUNCATED);
    assert_int_equal(gscl_certain_splats(w.bytes, w.size, NULL, NULL, &total), GSCL_ERROR_INVALID_ARGUMENT);
    synthetic_scene_free(w.scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_complete_files),
        cmocka_unit_test(test_bare_files),
        cmocka_unit_test(test_files_with_blocks),
        cmocka_unit_test(test_library_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
