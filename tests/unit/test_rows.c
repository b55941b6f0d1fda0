/* Decoding by rows in memory of the caller: the samples are those of gscl_decode in software, with strips of any height and any
 * memory, and it allocates nothing. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "devices.h"
#include "synthetic_image.h"
#include "synthetic_scene.h"
#include "wrapped_allocations.h"

enum { KINDS = 12, WIDTH = 530, HEIGHT = 50, SPLATS = 250, MANY_SPLATS = 6000, SOFTWARE_PIXELS = 65536, GUARD = 64 };
#define POISON 0xA7

static gscl_context *context;

static int open_host(void **state) {
    (void)state;
    return open_on(&context, GSCL_HOST_DEVICE, GSCL_MAPPING_AUTO) ? 0 : -1;
}

static int close_host(void **state) {
    (void)state;
    gscl_context_free(&context);
    return 0;
}

/* ---- Allocations of the library (meson.build redirects its calls to these) ---- */

static int allocations; /* since a test set it to 0 */

void *__wrap_malloc(size_t size) {
    allocations++;
    return __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
    allocations++;
    return __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size) {
    allocations++;
    return __real_realloc(memory, size);
}

/* ---- Files ---- */

typedef struct file {
    uint8_t *bytes;
    size_t size;
} file;

/* A file of a random kind; twelve numbers have all blends and layouts. */
static file file_of(int number, gsf_coding coding, uint32_t splats, bool bare) {
    const synthetic_kind kind = {WIDTH, HEIGHT, splats, coding, bare};
    file f = {NULL, 0};
    synthetic_random_state = 57 + (uint32_t)number;
    assert_int_equal(synthetic_file_of_kind(&kind, number, &f.bytes, &f.size), GSF_OK);
    return f;
}

static gscl_decode_settings default_settings(void) {
    gscl_decode_settings settings;
    gscl_decode_settings_default(&settings);
    return settings;
}

/* ---- A decode by rows ---- */

/* The rows so far, joined. */
typedef struct joined {
    gscl_image image;    /* of the whole size */
    uint32_t rows;       /* received */
    uint32_t strip_rows; /* expected of each strip but the last; 0: any number up to 16 */
    int calls, last;     /* the callback stops the decode at call `last`; 0: never */
} joined;

static bool join(void *opaque, uint32_t y, const gscl_image *strip) {
    joined *j = opaque;
    const gscl_image *whole = &j->image;
    const uint32_t left = whole->height - y;
    assert_int_equal(y, j->rows);
    assert_true(strip->width == whole->width && strip->channels == whole->channels && strip->sample == whole->sample &&
                strip->layout == whole->layout && strip->premultiplied == whole->premultiplied && strip->stride == 0);
    if (j->strip_rows)
        assert_int_equal(strip->height, j->strip_rows < left ? j->strip_rows : left);
    assert_true(strip->height >= 1 && strip->height <= left && (j->strip_rows || strip->height <= 16));
    const size_t row = whole->width * whole->channels * synthetic_sample_size(whole->sample);
    memcpy((uint8_t *)whole->pixels + y * row, strip->pixels, strip->height * row);
    memset(strip->pixels, POISON, strip->height * row); /* which changes no other strip */
    j->rows += strip->height;
    return ++j->calls != j->last;
}

/* Decodes with `more` bytes beyond the least memory, which begins `offset` bytes behind an aligned address, and sees that nothing
 * around it is written. */
static gscl_result decode_rows(const file *f, const gscl_decode_settings *settings, uint32_t strip_rows, size_t more,
                               size_t offset, joined *j) {
    size_t least;
    const gscl_result result = gscl_rows_memory(f->bytes, f->size, settings, strip_rows, &j->image, &least);
    if (result != GSCL_OK)
        return result;
    const gscl_image *image = &j->image;
    const size_t size = least + more;
    uint8_t *block = malloc(size + 2 * GUARD);
    j->image.pixels = calloc((size_t)image->width * image->height * image->channels + 1, 4);
    assert_true(block && image->pixels);
    memset(block, POISON, size + 2 * GUARD);
    j->rows = 0;
    j->calls = 0;
    j->strip_rows = strip_rows;
    allocations = 0;
    const gscl_result decoded =
        gscl_decode_rows(f->bytes, f->size, settings, strip_rows, block + GUARD / 2 + offset, size, join, j);
    assert_int_equal(allocations, 0);
    for (size_t i = 0; i < GUARD / 2 + offset; i++)
        assert_int_equal(block[i], POISON);
    for (size_t i = GUARD / 2 + offset + size; i < size + 2 * GUARD; i++)
        assert_int_equal(block[i], POISON);
    free(block);
    return decoded;
}

/* The decode by rows has the result and the samples of the whole decode. */
static void check_rows(const char *name, const file *f, const gscl_decode_settings *settings, uint32_t strip_rows,
                       size_t more) {
    gscl_image whole = {0};
    joined j = {.last = 0};
    const gscl_result expected = gscl_decode(context, f->bytes, f->size, settings, &whole);
    const gscl_result result = decode_rows(f, settings, strip_rows, more, strip_rows % 8, &j);
    if (result != expected)
        fail_msg("%s: %s; expected: %s", name, gscl_result_text(result), gscl_result_text(expected));
    if (result == GSCL_OK) {
        assert_int_equal(j.rows, whole.height);
        assert_true(j.image.width == whole.width && j.image.height == whole.height &&
                    j.image.channels == whole.channels && j.image.sample == whole.sample);
        const size_t size = synthetic_sample_count(&whole) * synthetic_sample_size(whole.sample);
        if (memcmp(j.image.pixels, whole.pixels, size) != 0)
            fail_msg("%s: strips of %u rows with %zu bytes more differ from the whole", name, strip_rows, more);
    }
    free(j.image.pixels);
    gscl_free(whole.pixels);
}

/* ---- The same samples ---- */

static void test_all_heights(void **state) {
    (void)state;
    for (int number = 0; number < 2 * KINDS; number++) {
        const file f = file_of(number, number < KINDS ? GSF_CODING_SCALAR : GSF_CODING_CODEBOOK, SPLATS, false);
        for (uint32_t rows = 0; rows <= HEIGHT + 1; rows += 1 + (rows > 2) * (uint32_t)(number % 5))
            check_rows("a random file", &f, NULL, rows, 0);
        check_rows("a random file", &f, NULL, UINT32_MAX, 0);
        free(f.bytes);
    }
}

/* Sums of more than one run, and blocks of all heights. */
static void test_many_splats(void **state) {
    (void)state;
    for (int number = 0; number < KINDS; number += 4) {
        const file f = file_of(number, GSF_CODING_SCALAR, MANY_SPLATS, false);
        for (size_t more = 0; more < 200000; more += 30000)
            check_rows("many splats", &f, NULL, more % 60000 ? 0 : 16, more);
        check_rows("many splats", &f, NULL, 5, 0);
        free(f.bytes);
    }
}

static void test_settings(void **state) {
    (void)state;
    for (int number = 0; number < 2 * KINDS; number++) {
        const file f = file_of(number, number < KINDS ? GSF_CODING_SCALAR : GSF_CODING_CODEBOOK, SPLATS, false);
        gscl_decode_settings settings = default_settings();
        settings.width = 401;
        settings.height = 83;
        settings.crop_x = 37;
        settings.crop_y = 5;
        settings.crop_width = 300;
        for (gscl_sample sample = GSCL_SAMPLE_AUTO; sample <= GSCL_SAMPLE_F32; sample++) {
            settings.sample = sample;
            settings.premultiplied = number % 2;
            settings.layout = (gscl_layout)((number + (int)sample) % (GSCL_LAYOUT_BGRA + 1));
            settings.background[number % 3] = 0.5f;
            check_rows("a crop of another size", &f, &settings, 9, 5000);
        }
        settings = default_settings();
        settings.width = settings.height = 1;
        check_rows("a pixel", &f, &settings, 0, 0);
        free(f.bytes);
    }
}

static file read_file(const char *path) {
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    fseek(stream, 0, SEEK_END);
    file f = {NULL, (size_t)ftell(stream)};
    rewind(stream);
    f.bytes = malloc(f.size + 1);
    assert_non_null(f.bytes);
    assert_int_equal(fread(f.bytes, 1, f.size, stream), f.size);
    fclose(stream);
    return f;
}

/* Valid files and others; larger pictures are drawn by kernels where the library has them. */
/* A list with the packets that can be computed.  Too little memory changes nothing. */
static file repaired(file f) {
    const size_t needed = gscl_repair_memory(f.bytes, f.size);
    file list = {malloc(needed + GUARD), 0};
    assert_non_null(list.bytes);
    memset(list.bytes, POISON, needed + GUARD);
    assert_int_equal(gscl_repair_packets(f.bytes, f.size, list.bytes, needed - 1, &list.size),
                     GSCL_ERROR_OUT_OF_MEMORY);
    assert_int_equal(list.bytes[0], POISON);
    allocations = 0;
    assert_int_equal(gscl_repair_packets(f.bytes, f.size, list.bytes, needed, &list.size), GSCL_OK);
    assert_int_equal(allocations, 0);
    assert_int_equal(list.bytes[needed], POISON);
    free(f.bytes);
    return list;
}

static void check_conformance_file(const char *path, const char *name) {
    file f = read_file(path);
    size_t unchanged = 0;
    if (gscl_repair_memory(f.bytes, f.size) > 0)
        f = repaired(f);
    assert_int_equal(gscl_repair_packets(f.bytes, f.size, NULL, 0, &unchanged), GSCL_ERROR_INVALID_ARGUMENT);
    gscl_decode_settings settings = default_settings();
    gscl_info info = {.struct_size = sizeof info};
    gscl_read_settings reading;
    gscl_read_settings_default(&reading);
    reading.bare = settings.bare = strncmp(name, "bare-", 5) == 0;
    const bool is_read = gscl_probe(f.bytes, f.size, &reading, &info) == GSCL_OK;
    if (is_read && info.pixels > SOFTWARE_PIXELS) {
        settings.crop_width = info.width < 64 ? info.width : 64;
        settings.crop_height = info.height < 64 ? info.height : 64;
    }
    for (int partial = 0; partial < 2; partial++) {
        settings.partial = partial;
        check_rows(name, &f, &settings, 0, 20000);
        check_rows(name, &f, &settings, 7, 0);
    }
    free(f.bytes);
}

static void test_conformance_set(void **state) {
    (void)state;
    DIR *folder = opendir(GSCL_CONFORMANCE);
    assert_non_null(folder);
    int files = 0;
    for (const struct dirent *entry; (entry = readdir(folder));) {
        char path[1024];
        if (!strstr(entry->d_name, ".gscl") || strstr(entry->d_name, "repair")) /* it computes no packets */
            continue;
        snprintf(path, sizeof path, "%s/%s", GSCL_CONFORMANCE, entry->d_name);
        check_conformance_file(path, entry->d_name);
        files++;
    }
    closedir(folder);
    assert_true(files > 100);
}

/* ---- Files that end early or are damaged ---- */

static void test_parts_of_files(void **state) {
    (void)state;
    for (int number = 0; number < KINDS; number++) {
        file f = file_of(number, number % 2 ? GSF_CODING_CODEBOOK : GSF_CODING_SCALAR, SPLATS, number % 3 == 0);
        gscl_decode_settings settings = default_settings();
        settings.bare = number % 3 == 0;
        const size_t size = f.size;
        for (f.size = 0; f.size < size; f.size += 1 + f.size / 5)
            for (int partial = 0; partial < 2; partial++) {
                settings.partial = partial;
                uint8_t *exact = malloc(f.size + 1); /* lets a sanitizer see reads beyond the part */
                assert_non_null(exact);
                memcpy(exact, f.bytes, f.size);
                check_rows("a part of a file", &(file){exact, f.size}, &settings, 16, 0);
                free(exact);
            }
        free(f.bytes);
    }
}

/* A bare picture has no check, so that most changes give another valid picture. */
static void test_changed_bytes(void **state) {
    (void)state;
    for (int number = 0; number < 4; number++) {
        const file f = file_of(number, number % 2 ? GSF_CODING_CODEBOOK : GSF_CODING_SCALAR, 40, true);
        gscl_decode_settings settings = default_settings();
        settings.bare = true;
        settings.max_pixels = SOFTWARE_PIXELS;
        settings.max_work = 50000000;
        for (size_t i = 0; i < f.size; i++) {
            f.bytes[i] ^= (uint8_t)(1u << i % 8);
            check_rows("a changed picture", &f, &settings, 16, 0);
            f.bytes[i] ^= (uint8_t)(1u << i % 8);
        }
        free(f.bytes);
    }
}

/* ---- Memory, limits, arguments ---- */

static void test_least_memory(void **state) {
    (void)state;
    for (int number = 0; number < 2 * KINDS; number++) {
        const file f = file_of(number, number < KINDS ? GSF_CODING_SCALAR : GSF_CODING_CODEBOOK,
                               1 + 97u * (uint32_t)number, false);
        size_t least, of_start;
        assert_int_equal(gscl_rows_memory(f.bytes, f.size, NULL, 3, NULL, &least), GSCL_OK);
        assert_int_equal(gscl_rows_memory(f.bytes, 5 + 32, NULL, 3, NULL, &of_start), GSCL_OK);
        assert_int_equal(least, of_start);
        uint8_t *memory = malloc(least);
        assert_non_null(memory);
        joined j = {.calls = 0};
        for (size_t size = 0; size < least; size = least - (least - size) / 2)
            assert_int_equal(gscl_decode_rows(f.bytes, f.size, NULL, 3, memory, size, join, &j),
                             GSCL_ERROR_OUT_OF_MEMORY);
        assert_int_equal(j.calls, 0);
        for (size_t offset = 0; offset < 9; offset++) {
            assert_int_equal(decode_rows(&f, NULL, 3, 0, offset, &j), GSCL_OK);
            free(j.image.pixels);
        }
        free(memory);
        free(f.bytes);
    }
}

static void test_stop(void **state) {
    (void)state;
    const file f = file_of(2, GSF_CODING_SCALAR, SPLATS, false);
    for (int last = 1; last <= HEIGHT; last++) {
        joined j = {.last = last};
        assert_int_equal(decode_rows(&f, NULL, 1, 0, 0, &j), GSCL_ERROR_CANCELLED);
        assert_int_equal(j.calls, last);
        free(j.image.pixels);
    }
    free(f.bytes);
}

static void test_limits(void **state) {
    (void)state;
    const file f = file_of(0, GSF_CODING_SCALAR, SPLATS, false);
    gscl_info info = {.struct_size = sizeof info};
    assert_int_equal(gscl_inspect(f.bytes, f.size, NULL, &info), GSCL_OK);
    gscl_decode_settings settings = default_settings();
    settings.max_pixels = info.pixels;
    settings.max_work = info.work;
    check_rows("at the limits", &f, &settings, 0, 0);
    joined j = {.calls = 0};
    settings.max_work--;
    assert_int_equal(decode_rows(&f, &settings, 0, 0, 0, &j), GSCL_ERROR_LIMIT);
    free(j.image.pixels);
    settings.max_work = 0;
    settings.max_pixels--;
    assert_int_equal(decode_rows(&f, &settings, 0, 0, 0, &j), GSCL_ERROR_LIMIT);
    settings = default_settings();
    settings.width = settings.height = GSCL_MAX_DIMENSION + 1;
    assert_int_equal(decode_rows(&f, &settings, 0, 0, 0, &j), GSCL_ERROR_IMAGE_SIZE);
    settings = default_settings();
    settings.crop_x = WIDTH;
    assert_int_equal(decode_rows(&f, &settings, 0, 0, 0, &j), GSCL_ERROR_INVALID_ARGUMENT);
    assert_int_equal(j.calls, 0);
    free(f.bytes);
}

static void test_arguments(void **state) {
    (void)state;
    static uint8_t memory[200000];
    const file f = file_of(0, GSF_CODING_SCALAR, SPLATS, false);
    joined j = {.calls = 0};
    gscl_decode_settings settings = default_settings();
    size_t least = 0;
    const gscl_result invalid = GSCL_ERROR_INVALID_ARGUMENT;
    assert_int_equal(gscl_rows_memory(NULL, f.size, NULL, 1, NULL, &least), invalid);
    assert_int_equal(gscl_rows_memory(f.bytes, f.size, NULL, 1, NULL, NULL), invalid);
    assert_int_equal(gscl_decode_rows(NULL, f.size, NULL, 1, memory, sizeof memory, join, &j), invalid);
    assert_int_equal(gscl_decode_rows(f.bytes, f.size, NULL, 1, NULL, sizeof memory, join, &j), invalid);
    assert_int_equal(gscl_decode_rows(f.bytes, f.size, NULL, 1, memory, sizeof memory, NULL, &j), invalid);
    settings.sample = (gscl_sample)(GSCL_SAMPLE_F32 + 1);
    assert_int_equal(gscl_rows_memory(f.bytes, f.size, &settings, 1, NULL, &least), invalid);
    assert_int_equal(gscl_decode_rows(f.bytes, f.size, &settings, 1, memory, sizeof memory, join, &j), invalid);
    settings = default_settings();
    settings.struct_size++;
    assert_int_equal(gscl_rows_memory(f.bytes, f.size, &settings, 1, NULL, &least), GSCL_ERROR_STRUCT_SIZE);
    assert_int_equal(gscl_decode_rows(f.bytes, f.size, &settings, 1, memory, sizeof memory, join, &j),
                     GSCL_ERROR_STRUCT_SIZE);
    assert_true(j.calls == 0 && least == 0);
    free(f.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_heights),    cmocka_unit_test(test_many_splats),
        cmocka_unit_test(test_settings),       cmocka_unit_test(test_conformance_set),
        cmocka_unit_test(test_parts_of_files), cmocka_unit_test(test_changed_bytes),
        cmocka_unit_test(test_least_memory),   cmocka_unit_test(test_stop),
        cmocka_unit_test(test_limits),         cmocka_unit_test(test_arguments),
    };
    return cmocka_run_group_tests(tests, open_host, close_host);
}
