/* The folder in which built kernels are kept: what is stored is found, and nothing else ever is. */
#define _XOPEN_SOURCE 700
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "opencl/binary_store.h"

#define LIMIT 100000 /* bytes */
#define BYTES "the bytes of a program"

static char top[] = "/tmp/gscl-store-XXXXXX";
static char folder[64]; /* top/a/b, which does not exist at the start of a test */

static int remove_all(void) {
    char command[64];
    snprintf(command, sizeof command, "rm -rf %s/*", top);
    return system(command);
}

static int make_top(void **state) {
    (void)state;
    if (!mkdtemp(top))
        return -1;
    snprintf(folder, sizeof folder, "%s/a/b", top);
    return 0;
}

static int begin(void **state) {
    (void)state;
    return remove_all();
}

static int remove_top(void **state) {
    (void)state;
    return remove_all() != 0 || rmdir(top) != 0;
}

/* The names of the folder's files, sorted, each with a blank behind it. */
static const char *file_names(void) {
    static char names[4096];
    struct dirent **entries;
    const int count = scandir(folder, &entries, NULL, alphasort);
    names[0] = 0;
    for (int i = 0; i < count; i++) {
        if (entries[i]->d_name[0] != '.')
            strcat(strcat(names, entries[i]->d_name), " ");
        free(entries[i]);
    }
    if (count >= 0)
        free(entries);
    return names;
}

/* The path of the only file. */
static const char *only_path(void) {
    static char path[4200];
    snprintf(path, sizeof path, "%s/%.*s", folder, (int)strcspn(file_names(), " "), file_names());
    return path;
}

static int save(const char *key, const char *text) {
    return gscl_binary_save(folder, key, text, strlen(text), LIMIT);
}

static void assert_found(const char *key, const char *text) {
    size_t size = 0;
    char *bytes = gscl_binary_load(folder, key, LIMIT, &size);
    if (!bytes)
        fail_msg("%s is not found", key);
    assert_int_equal(size, strlen(text));
    assert_memory_equal(bytes, text, size);
    free(bytes);
}

static void assert_missing(const char *key) {
    size_t size;
    void *bytes = gscl_binary_load(folder, key, LIMIT, &size);
    if (bytes)
        fail_msg("%s is found", key);
}

static size_t read_file(char bytes[4096]) {
    FILE *file = fopen(only_path(), "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, 4096, file);
    fclose(file);
    return size;
}

static void write_file(const char *path, const char *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void test_what_was_stored_is_found(void **state) {
    (void)state;
    assert_missing("key");
    assert_int_equal(save("key", BYTES), 0);
    assert_int_equal(save("other", "b"), 0);
    assert_found("key", BYTES);
    assert_found("other", "b");
    assert_int_equal(save("key", "replaced"), 0);
    assert_found("key", "replaced");
    assert_missing("ke");
    assert_missing("");
}

static void test_only_the_user_may_read_it(void **state) {
    (void)state;
    struct stat status;
    assert_int_equal(save("key", BYTES), 0);
    assert_int_equal(stat(folder, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0700);
    assert_int_equal(stat(only_path(), &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
}

static void test_every_cut_is_missed(void **state) {
    (void)state;
    char bytes[4096];
    assert_int_equal(save("key", BYTES), 0);
    const size_t size = read_file(bytes);
    for (size_t length = 0; length < size; length++) {
        write_file(only_path(), bytes, length);
        assert_missing("key");
    }
    bytes[size] = 0;
    write_file(only_path(), bytes, size + 1);
    assert_missing("key");
    assert_int_equal(save("key", BYTES), 0);
    assert_found("key", BYTES);
}

static void test_every_changed_byte_is_missed(void **state) {
    (void)state;
    char bytes[4096];
    assert_int_equal(save("key", BYTES), 0);
    const size_t size = read_file(bytes);
    for (size_t at = 0; at < size; at++)
        for (int bit = 0; bit < 8; bit++) {
            bytes[at] = (char)(bytes[at] ^ 1 << bit);
            write_file(only_path(), bytes, size);
            assert_missing("key");
            bytes[at] = (char)(bytes[at] ^ 1 << bit);
        }
    write_file(only_path(), bytes, size);
    assert_found("key", BYTES);
}

/* As if the hashes of two keys were equal. */
static void test_file_of_another_key_is_missed(void **state) {
    (void)state;
    char bytes[4096], path[4200];
    assert_int_equal(save("one", BYTES), 0);
    const size_t size = read_file(bytes);
    assert_int_equal(unlink(only_path()), 0);
    assert_int_equal(save("two", BYTES), 0);
    snprintf(path, sizeof path, "%s", only_path());
    write_file(path, bytes, size);
    assert_missing("two");
    assert_missing("one");
}

static void test_what_is_no_file_is_missed(void **state) {
    (void)state;
    char path[4200], target[64];
    assert_int_equal(save("key", BYTES), 0);
    snprintf(path, sizeof path, "%s", only_path());
    snprintf(target, sizeof target, "%s/target", top);
    assert_int_equal(rename(path, target), 0);
    assert_int_equal(symlink(target, path), 0);
    assert_missing("key");
    assert_int_equal(unlink(path), 0);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_missing("key");
    assert_int_equal(unlink(path), 0);
    assert_int_equal(mkdir(path, 0700), 0);
    assert_missing("key");
    assert_int_not_equal(save("key", BYTES), 0);
    assert_null(strstr(file_names(), "part-"));
}

static void test_folder_that_cannot_be_made(void **state) {
    (void)state;
    char file[64];
    snprintf(file, sizeof file, "%s/a", top);
    write_file(file, "", 0);
    assert_int_equal(save("key", BYTES), ENOTDIR);
    assert_missing("key");
}

static void test_unwritable_folder(void **state) {
    (void)state;
    const bool is_root = geteuid() == 0; /* who may write everywhere */
    assert_int_equal(save("key", BYTES), 0);
    assert_int_equal(chmod(folder, 0500), 0);
    assert_true(!is_root || seteuid(65534) == 0);
    assert_int_equal(save("other", BYTES), EACCES);
    assert_true(!is_root || seteuid(0) == 0);
    assert_found("key", BYTES);
    assert_missing("other");
    assert_int_equal(chmod(folder, 0700), 0);
}

/* The limit of a process for files stands for a full disk. */
static void test_full_disk_leaves_nothing(void **state) {
    (void)state;
    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    small = before;
    small.rlim_cur = 40;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    const int error = save("key", BYTES);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_int_equal(error, EFBIG);
    assert_string_equal(file_names(), "");
}

static void set_age(const char *path, time_t seconds) {
    const struct timespec times[2] = {{.tv_sec = time(NULL) - seconds}, {.tv_sec = time(NULL) - seconds}};
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

static void make_all_older(void) {
    char names[4096], path[8300];
    snprintf(names, sizeof names, "%s", file_names());
    for (char *name = strtok(names, " "); name; name = strtok(NULL, " ")) {
        struct stat status;
        snprintf(path, sizeof path, "%s/%s", folder, name);
        assert_int_equal(stat(path, &status), 0);
        set_age(path, time(NULL) - status.st_mtime + 10);
    }
}

static int save_large(const char *key) {
    static char bytes[LIMIT / 3];
    return gscl_binary_save(folder, key, bytes, sizeof bytes - 100, LIMIT);
}

static void test_oldest_files_are_removed(void **state) {
    (void)state;
    size_t size;
    static const char *const keys[] = {"a", "b", "c"};
    for (size_t i = 0; i < 3; i++) {
        make_all_older();
        assert_int_equal(save_large(keys[i]), 0);
    }
    make_all_older();
    void *bytes = gscl_binary_load(folder, "a", LIMIT, &size); /* which makes it the newest */
    assert_non_null(bytes);
    free(bytes);
    assert_int_equal(save_large("d"), 0);
    assert_missing("b");
    for (size_t i = 0; i < 3; i++) {
        bytes = gscl_binary_load(folder, (const char *const[]){"a", "c", "d"}[i], LIMIT, &size);
        assert_non_null(bytes);
        free(bytes);
    }
}

static void test_limits_of_one_file(void **state) {
    (void)state;
    static char bytes[LIMIT];
    size_t size;
    assert_int_equal(gscl_binary_save(folder, "key", bytes, LIMIT, LIMIT), EFBIG);
    assert_int_equal(gscl_binary_save(folder, "key", bytes, SIZE_MAX, LIMIT), EFBIG);
    assert_string_equal(file_names(), "");
    assert_int_equal(gscl_binary_save(folder, "key", bytes, 1000, LIMIT), 0);
    assert_null(gscl_binary_load(folder, "key", 1000, &size));
}

static void test_strange_files_stay_and_unfinished_ones_go(void **state) {
    (void)state;
    char path[128];
    static const char *const names[] = {"part-000000", "part-111111", "readme", "photo.bin.png"};
    assert_int_equal(save("key", BYTES), 0);
    assert_int_equal(unlink(only_path()), 0);
    for (size_t i = 0; i < 4; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        write_file(path, BYTES, 5);
        if (i != 1)
            set_age(path, 100000);
    }
    assert_int_equal(save("key", BYTES), 0);
    assert_null(strstr(file_names(), "part-000000"));
    for (size_t i = 1; i < 4; i++)
        assert_non_null(strstr(file_names(), names[i]));
}

/* Bytes of a key and their number are functions of `seed`, so that a mixture of two is noticed. */
static size_t fill(unsigned seed, char bytes[5000]) {
    const size_t size = 1000 + seed * 37 % 4000;
    memset(bytes, (int)('a' + seed % 26), size);
    memcpy(bytes, &seed, sizeof seed);
    return size;
}

static bool is_filled(const char *bytes, size_t size) {
    char expected[5000];
    unsigned seed;
    memcpy(&seed, bytes, sizeof seed);
    return size == fill(seed, expected) && memcmp(bytes, expected, size) == 0;
}

/* Saves and loads in turns; a process ends in the middle of it.  Returns whether all that was found was whole. */
static bool work(unsigned number) {
    char bytes[5000];
    static const char *const keys[] = {"a", "b", "c"};
    for (unsigned i = 0; i < 300; i++) {
        size_t size = fill(1000 * number + i, bytes);
        if (gscl_binary_save(folder, keys[i % 3], bytes, size, 12000) != 0)
            return false;
        char *found = gscl_binary_load(folder, keys[(i + number) % 3], 12000, &size);
        if (found && !is_filled(found, size))
            return false;
        free(found);
    }
    return true;
}

static void test_many_processes(void **state) {
    (void)state;
    pid_t children[8];
    for (unsigned i = 0; i < 8; i++) {
        children[i] = fork();
        if (children[i] == 0)
            _exit(work(i) ? 0 : 1);
    }
    assert_int_equal(kill(children[7], SIGKILL), 0);
    for (unsigned i = 0; i < 8; i++) {
        int status;
        assert_int_equal(waitpid(children[i], &status, 0), children[i]);
        assert_true(i == 7 || status == 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_what_was_stored_is_found, begin),
        cmocka_unit_test_setup(test_only_the_user_may_read_it, begin),
        cmocka_unit_test_setup(test_every_cut_is_missed, begin),
        cmocka_unit_test_setup(test_every_changed_byte_is_missed, begin),
        cmocka_unit_test_setup(test_file_of_another_key_is_missed, begin),
        cmocka_unit_test_setup(test_what_is_no_file_is_missed, begin),
        cmocka_unit_test_setup(test_folder_that_cannot_be_made, begin),
        cmocka_unit_test_setup(test_unwritable_folder, begin),
        cmocka_unit_test_setup(test_full_disk_leaves_nothing, begin),
        cmocka_unit_test_setup(test_oldest_files_are_removed, begin),
        cmocka_unit_test_setup(test_limits_of_one_file, begin),
        cmocka_unit_test_setup(test_strange_files_stay_and_unfinished_ones_go, begin),
        cmocka_unit_test_setup(test_many_processes, begin),
    };
    return cmocka_run_group_tests(tests, make_top, remove_top);
}
