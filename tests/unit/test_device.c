/* Devices that this machine does not have: long names, unavailable devices, devices whose clGetDeviceInfo fails. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>
#include <gscl/gscl.h>

#include "devices.h"
#include "fake_opencl.h"
#include "runtime/launch.h"
#include "runtime/text.h"

#define LONG_NAME 300 /* bytes */

static int fake_nothing(void **state) {
    (void)state;
    fake = (fake_opencl){0};
    return 0;
}

static gscl_result open_device(const char *selector, gscl_context **context) {
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = selector;
    return gscl_context_create(context, &settings);
}

/* Opens the device and frees the context, but copies its message. */
static gscl_result try_device(const char *selector, char message[512]) {
    gscl_context *context;
    const gscl_result result = open_device(selector, &context);
    snprintf(message, 512, "%s", gscl_context_message(context));
    gscl_context_free(&context);
    return result;
}

static int count_devices(void) {
    gscl_device_info *devices;
    int count = 0;
    if (gscl_list_devices(&devices) != GSCL_OK)
        return 0;
    for (const gscl_device_info *d = devices; d; d = d->next)
        count++;
    gscl_free(devices);
    return count;
}

/* "Fast accelerator " and letters that take two bytes in UTF-8. */
static void make_long_name(char name[LONG_NAME + 1]) {
    const size_t start = (size_t)snprintf(name, LONG_NAME, "Fast accelerator ");
    for (size_t i = start; i < LONG_NAME; i += 2)
        memcpy(name + i, "\xC3\xA9", 2);
    name[LONG_NAME] = 0;
}

static bool ends_with(const char *text, const char *end) {
    return strlen(text) >= strlen(end) && strcmp(text + strlen(text) - strlen(end), end) == 0;
}

static void test_long_names_are_shortened(void **state) {
    (void)state;
    char name[LONG_NAME + 1];
    gscl_context *context;
    make_long_name(name);
    fake.device_name = fake.platform_name = name;
    assert_int_equal(open_device("fast accelerator", &context), GSCL_OK);
    const gscl_device_info *device = gscl_context_device(context);
    const char *const texts[] = {device->device_name, device->platform_name};
    for (size_t i = 0; i < 2; i++) {
        const size_t length = strlen(texts[i]) - 3;
        assert_true(strlen(texts[i]) > 100 && ends_with(texts[i], "..."));
        assert_memory_equal(texts[i], name, length);
        assert_true(length % 2 == 1); /* no character of two bytes is split */
    }
    gscl_context_free(&context);
}

static void test_short_names_are_kept(void **state) {
    (void)state;
    gscl_context *context;
    fake.device_name = "Name";
    assert_int_equal(open_device("0.0", &context), GSCL_OK);
    assert_string_equal(gscl_context_device(context)->device_name, "Name");
    gscl_context_free(&context);
}

static void test_unavailable_device_is_not_listed(void **state) {
    (void)state;
    const int count = count_devices();
    fake.second_device = true;
    assert_true(count_devices() > count);
    fake.second_unavailable = true;
    assert_int_equal(count_devices(), count);
}

static void test_unavailable_device_is_not_the_default(void **state) {
    (void)state;
    gscl_device_info *devices;
    fake.second_device = fake.first_unavailable = true;
    assert_int_equal(gscl_list_devices(&devices), GSCL_OK);
    int defaults = 0;
    for (const gscl_device_info *d = devices; d; d = d->next) {
        assert_string_not_equal(d->id, "0.0");
        defaults += d->is_default;
    }
    assert_int_equal(defaults, 1);
    gscl_free(devices);
}

static void test_unavailable_device_is_refused(void **state) {
    (void)state;
    char message[512];
    fake.device_name = "Rare";
    fake.first_unavailable = true;
    assert_int_equal(try_device("0.0", message), GSCL_ERROR_UNKNOWN_DEVICE);
    assert_string_equal(message, "OpenCL device 0.0 (Rare) is not available");
    assert_int_equal(try_device("rare", message), GSCL_ERROR_UNKNOWN_DEVICE);
    assert_string_equal(message, "OpenCL device 0.0 (Rare) is not available");
    assert_int_equal(try_device("other", message), GSCL_ERROR_UNKNOWN_DEVICE);
    assert_non_null(strstr(message, has_native() ? "there is host (" : "none that can be used"));
}

static void test_no_available_device(void **state) {
    (void)state;
    char message[512];
    gscl_device_info *devices;
    fake.first_unavailable = true;
    if (has_native()) {
        assert_int_equal(gscl_list_devices(&devices), GSCL_OK);
        assert_string_equal(devices->id, GSCL_HOST_DEVICE);
        assert_true(devices->is_default && !devices->next);
        gscl_free(devices);
        assert_int_equal(try_device(NULL, message), GSCL_OK);
        return;
    }
    assert_int_equal(gscl_list_devices(&devices), GSCL_ERROR_NO_PLATFORM);
    assert_int_equal(try_device(NULL, message), GSCL_ERROR_NO_PLATFORM);
    assert_non_null(strstr(message, "is not available"));
}

/* The id of the default device. */
static void read_default(gscl_mapping mapping, char id[16]) {
    gscl_context *context;
    if (!open_on(&context, NULL, mapping))
        fail_msg("%s", gscl_context_message(context));
    snprintf(id, 16, "%s", gscl_context_device(context)->id);
    gscl_context_free(&context);
}

/* A GPU or an accelerator comes first, then the processor's compiled kernels, then a CPU of OpenCL. */
static void test_the_default_device(void **state) {
    (void)state;
    static const struct {
        cl_device_type type;
        gscl_mapping mapping;
        bool is_opencl;
    } cases[] = {
        {CL_DEVICE_TYPE_GPU, GSCL_MAPPING_AUTO, true},  {CL_DEVICE_TYPE_ACCELERATOR, GSCL_MAPPING_AUTO, true},
        {CL_DEVICE_TYPE_CPU, GSCL_MAPPING_AUTO, false}, {CL_DEVICE_TYPE_CPU, GSCL_MAPPING_CPU, false},
        {CL_DEVICE_TYPE_CPU, GSCL_MAPPING_GPU, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char id[16];
        fake.device_type = cases[i].type;
        read_default(cases[i].mapping, id);
        assert_string_equal(id, cases[i].is_opencl || !has_native() ? "0.0" : GSCL_HOST_DEVICE);
    }
}

/* The id of the device that is listed as the default, which need not be one that can be opened. */
static void read_listed_default(char id[16]) {
    gscl_device_info *devices;
    assert_int_equal(gscl_list_devices(&devices), GSCL_OK);
    for (const gscl_device_info *d = devices; d; d = d->next)
        if (d->is_default)
            snprintf(id, 16, "%s", d->id);
    gscl_free(devices);
}

/* Of two GPUs: memory of its own, then memory, then compute units, then the first. */
static void test_the_default_of_two_gpus(void **state) {
    (void)state;
    const cl_ulong small = (cl_ulong)8 << 30, large = (cl_ulong)64 << 30;
    const struct {
        fake_numbers first, second;
        bool is_second;
    } cases[] = {
        {{true, true, large, 96}, {true, false, small, 20}, true},
        {{true, false, small, 20}, {true, true, large, 96}, false},
        {{true, false, small, 96}, {true, false, large, 20}, true},
        {{true, false, large, 20}, {true, false, small, 96}, false},
        {{true, true, small, 20}, {true, true, large, 20}, true},
        {{true, false, small, 20}, {true, false, small, 96}, true},
        {{true, false, small, 20}, {true, false, small, 20}, false},
    };
    fake.device_type = CL_DEVICE_TYPE_GPU;
    fake.second_device = true;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char id[16] = "";
        fake.first = cases[i].first;
        fake.second = cases[i].second;
        read_listed_default(id);
        assert_string_equal(id, cases[i].is_second ? "0.1" : "0.0");
    }
}

/* What they say of themselves counts among GPUs only. */
static void test_accelerators_keep_their_order(void **state) {
    (void)state;
    char id[16] = "";
    fake.device_type = CL_DEVICE_TYPE_ACCELERATOR;
    fake.second_device = true;
    fake.first = (fake_numbers){true, true, 1 << 30, 1};
    fake.second = (fake_numbers){true, false, (cl_ulong)64 << 30, 96};
    read_listed_default(id);
    assert_string_equal(id, "0.0");
}

static void test_every_description_is_checked(void **state) {
    (void)state;
    static const cl_device_info parameters[] = {
        CL_DEVICE_NAME,
        CL_DEVICE_VERSION,
        CL_DEVICE_TYPE,
        CL_DEVICE_AVAILABLE,
        CL_DEVICE_MAX_COMPUTE_UNITS,
        CL_DEVICE_COMPILER_AVAILABLE,
        CL_DEVICE_GLOBAL_MEM_SIZE,
        CL_DEVICE_MAX_MEM_ALLOC_SIZE,
        CL_DEVICE_MAX_WORK_GROUP_SIZE,
    };
    for (size_t i = 0; i < sizeof parameters / sizeof *parameters; i++) {
        char message[512];
        fake.failing_info = parameters[i];
        assert_int_equal(try_device("0.0", message), GSCL_ERROR_UNKNOWN_DEVICE);
        assert_non_null(strstr(message, "cannot be queried: CL_OUT_OF_RESOURCES"));
    }
}

/* The message shortens long names of the devices that it lists. */
static void test_ambiguous_devices_are_named(void **state) {
    (void)state;
    char name[LONG_NAME + 1], message[512];
    make_long_name(name);
    fake.device_name = name;
    fake.second_device = true;
    assert_int_equal(try_device("accelerator", message), GSCL_ERROR_AMBIGUOUS_DEVICE);
    assert_non_null(strstr(message, "0.0 (Fast accelerator"));
    assert_non_null(strstr(message, "...), 0.1 (Fast accelerator"));
}

/* A device is refused before any kernel is built or launched. */
static void test_small_groups_are_refused(void **state) {
    (void)state;
    static const struct {
        gscl_mapping mapping;
        const char *message;
    } cases[] = {
        {GSCL_MAPPING_GPU, "Rare has work-groups of at most 32 work-items, and kernels of the GPU mapping need 64"},
        {GSCL_MAPPING_CPU, "Rare has work-groups of at most 32 work-items, and kernels of the CPU mapping need 64"},
    };
    fake.device_name = "Rare";
    fake.largest_group = 32;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        gscl_context *context;
        gscl_context_settings settings;
        gscl_context_settings_default(&settings);
        settings.device = "0.0";
        settings.mapping = cases[i].mapping;
        assert_int_equal(gscl_context_create(&context, &settings), GSCL_ERROR_GROUP_SIZE);
        assert_string_equal(gscl_context_message(context), cases[i].message);
        gscl_context_free(&context);
    }
}

typedef struct last_log {
    gscl_log_level level;
    char text[128];
} last_log;

static void keep_log(void *opaque, gscl_log_level level, const char *message) {
    last_log *log = opaque;
    log->level = level;
    snprintf(log->text, sizeof log->text, "%s", message);
}

/* A context whose notices go to the log. */
static gscl_context *logged_context(last_log *log) {
    gscl_context *context;
    gscl_context_settings settings;
    gscl_context_settings_default(&settings);
    settings.device = "0.0";
    settings.log = keep_log;
    settings.log_opaque = log;
    assert_int_equal(gscl_context_create(&context, &settings), GSCL_OK);
    return context;
}

static void notify(const char *text, const last_log *log) {
    char expected[128];
    fake.notice(text, NULL, 0, fake.notice_data);
    snprintf(expected, sizeof expected, "OpenCL: %s", text);
    assert_int_equal(log->level, GSCL_LOG_WARNING);
    assert_string_equal(log->text, expected);
}

static void test_notices_are_logged(void **state) {
    (void)state;
    last_log log;
    gscl_context *context = logged_context(&log);
    notify("a page fault", &log);
    gscl_context_free(&context);
}

static void build_something(gscl_context *context) {
    const gscl_kernel_options plain = {.colours = 1};
    gscl_kernel *kernel;
    assert_int_equal(gscl_kernel_find(context, GSCL_PROGRAM_BENCHMARK, &plain, "multiply_add", &kernel), GSCL_OK);
}

/* One OpenCL context and one build of each program serve all contexts of a device that are open, until the last one ends. */
static void test_contexts_share_a_device(void **state) {
    (void)state;
    last_log logs[2];
    gscl_context *first = logged_context(&logs[0]), *second = logged_context(&logs[1]);
    assert_int_equal(fake.contexts, 1);
    build_something(first);
    const int builds = fake.builds;
    assert_int_equal(builds, 1);
    build_something(second);
    assert_int_equal(fake.builds, builds);
    gscl_context_free(&first);
    build_something(second);
    notify("a page fault", &logs[1]);
    gscl_context *third = logged_context(&logs[0]);
    build_something(third);
    gscl_context_free(&second);
    gscl_context_free(&third);
    assert_int_equal(fake.contexts, 1);
    assert_int_equal(fake.builds, builds);
    third = logged_context(&logs[0]);
    build_something(third);
    gscl_context_free(&third);
    assert_int_equal(fake.contexts, 2);
    assert_int_equal(fake.builds, 2 * builds);
}

static void test_appended_text_is_whole(void **state) {
    (void)state;
    char bytes[8];
    gscl_text text = gscl_text_begin(bytes, sizeof bytes);
    gscl_text_append(&text, "%s", "abcd");
    gscl_text_append(&text, "-%d", 56);
    assert_false(text.overflow);
    assert_string_equal(bytes, "abcd-56");
    text = gscl_text_begin(bytes, sizeof bytes);
    gscl_text_append(&text, "%s", "abcd");
    gscl_text_append(&text, "-%d", 567);
    gscl_text_append(&text, "x");
    assert_true(text.overflow);
    assert_string_equal(bytes, "abcd");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_long_names_are_shortened, fake_nothing),
        cmocka_unit_test_setup(test_short_names_are_kept, fake_nothing),
        cmocka_unit_test_setup(test_unavailable_device_is_not_listed, fake_nothing),
        cmocka_unit_test_setup(test_unavailable_device_is_not_the_default, fake_nothing),
        cmocka_unit_test_setup(test_unavailable_device_is_refused, fake_nothing),
        cmocka_unit_test_setup(test_no_available_device, fake_nothing),
        cmocka_unit_test_setup(test_the_default_device, fake_nothing),
        cmocka_unit_test_setup(test_the_default_of_two_gpus, fake_nothing),
        cmocka_unit_test_setup(test_accelerators_keep_their_order, fake_nothing),
        cmocka_unit_test_setup(test_every_description_is_checked, fake_nothing),
        cmocka_unit_test_setup(test_ambiguous_devices_are_named, fake_nothing),
        cmocka_unit_test_setup(test_small_groups_are_refused, fake_nothing),
        cmocka_unit_test_setup(test_notices_are_logged, fake_nothing),
        cmocka_unit_test_setup(test_contexts_share_a_device, fake_nothing),
        cmocka_unit_test_setup(test_appended_text_is_whole, fake_nothing),
    };
    fake_opencl_install();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
