#define _DEFAULT_SOURCE /* strsignal */
#include "commands/device_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/measure.h>

#include "cli/device_choice.h"
#include "cli/device_list.h"
#include "cli/exit_code.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/stopwatch.h"
#include "host/system/check_process.h"
#include "host/system/signals.h"
#include "image/synthetic_image.h"

#define WIDTH 96 /* of the picture, pixels */
#define HEIGHT 64
#define TARGET_BYTES 900
#define MIN_PSNR 27.5      /* dB; sound devices reach 29.0 */
#define MAX_DIFFERENCE 1.0 /* of samples in 0..255; sound devices stay below 0.01 */
#define MAX_DEVICES 64

typedef enum check_stage { STAGE_OPENING, STAGE_ENCODING, STAGE_DECODING, STAGE_END } check_stage;

static const char *const stage_words[] = {"opening the device", "encoding", "decoding", "the end"};

/* How far a check has come.  The child sends it at the start of each stage and at the end. */
typedef struct check_record {
    int stage;
    bool has_failed;
    double psnr, difference, seconds;
    char message[400]; /* of the failure */
} check_record;

typedef struct device_record {
    char id[sizeof((gscl_device_info *)0)->id];
    char name[sizeof((gscl_device_info *)0)->device_name];
} device_record;

typedef struct check_task {
    device_record device;
    gscl_mapping mapping;
    int pipe;
    check_record record;
} check_task;

/* ---- In the child ------------------------------------------------------------------------------ */

static void send_stage(check_task *task, check_stage stage) {
    task->record.stage = (int)stage;
    check_process_send(task->pipe, &task->record, sizeof task->record);
}

static bool task_fail(check_task *task, const gscl_context *context, gscl_result result) {
    char text[EXPLANATION_SIZE];
    explain_result(context, result, text);
    task->record.has_failed = true;
    snprintf(task->record.message, sizeof task->record.message, "%.*s", (int)sizeof task->record.message - 1, text);
    return false;
}

static bool encode_and_decode(check_task *task, gscl_context *context, const gscl_image *image) {
    uint8_t *bytes = NULL;
    size_t size = 0;
    gscl_encode_settings settings;
    gscl_encode_report report = {.struct_size = sizeof report};
    gscl_encode_settings_default(&settings);
    settings.target = GSCL_TARGET_BYTES;
    settings.target_value = TARGET_BYTES;
    send_stage(task, STAGE_ENCODING);
    gscl_result result = gscl_encode(context, image, &settings, &bytes, &size, &report);
    if (result == GSCL_OK) {
        task->record.psnr = report.psnr;
        send_stage(task, STAGE_DECODING);
        result = gscl_measure_decoding(context, bytes, size, &task->record.difference);
    }
    gscl_free(bytes);
    return result == GSCL_OK || task_fail(task, context, result);
}

/* The measured figures are within their bounds. */
static void judge(check_task *task) {
    check_record *r = &task->record;
    r->has_failed = true;
    if (!(r->difference <= MAX_DIFFERENCE))
        snprintf(r->message, sizeof r->message,
                 "decoded samples differ by %.3g/255 from double precision, at most %g/255 "
                 "would be right",
                 r->difference, MAX_DIFFERENCE);
    else if (!(r->psnr >= MIN_PSNR))
        snprintf(r->message, sizeof r->message, "the encode has %.2f dB, at least %g dB would be right", r->psnr,
                 MIN_PSNR);
    else
        r->has_failed = false;
}

static int run_task(void *opaque, int pipe) {
    check_task *task = opaque;
    gscl_image image = {0};
    gscl_context *context = NULL;
    const double start = stopwatch_now();
    const device_choice choice = {.device = task->device.id, .mapping = (int)task->mapping, .quiet = true};
    task->pipe = pipe;
    send_stage(task, STAGE_OPENING);
    const gscl_result result = create_context(&choice, &context);
    if (result != GSCL_OK)
        task_fail(task, context, result);
    else if (!synthetic_image_make(&image, WIDTH, HEIGHT))
        task_fail(task, NULL, GSCL_ERROR_OUT_OF_MEMORY);
    else if (encode_and_decode(task, context, &image))
        judge(task);
    free(image.pixels);
    gscl_context_free(&context);
    task->record.seconds = stopwatch_now() - start;
    check_process_send(pipe, &task->record, sizeof task->record);
    send_stage(task, STAGE_END);
    return EXIT_SUCCESS;
}

static int run_list(void *opaque, int pipe) {
    (void)opaque;
    gscl_device_info *devices = NULL;
    const gscl_result result = gscl_list_devices(&devices);
    if (result != GSCL_OK)
        return report_result(NULL, "OpenCL", result);
    report_absent_pocl(devices);
    for (const gscl_device_info *device = devices; device; device = device->next) {
        device_record record;
        memcpy(record.id, device->id, sizeof record.id);
        memcpy(record.name, device->device_name, sizeof record.name);
        check_process_send(pipe, &record, sizeof record);
    }
    gscl_free(devices);
    return EXIT_SUCCESS;
}

/* ---- In the parent ----------------------------------------------------------------------------- */

typedef struct device_records {
    size_t count;
    device_record devices[MAX_DEVICES];
} device_records;

static void receive_device(void *opaque, const void *record) {
    device_records *list = opaque;
    if (list->count < MAX_DEVICES)
        memcpy(&list->devices[list->count++], record, sizeof(device_record));
}

static void receive_record(void *opaque, const void *record) {
    memcpy(&((check_task *)opaque)->record, record, sizeof(check_record));
}

/* Describes an end of the process before its check was complete. */
static void describe_end(check_record *r, check_end end, int number, uint64_t limit_s) {
    const char *stage = stage_words[r->stage];
    if (end == CHECK_TOO_LATE)
        snprintf(r->message, sizeof r->message, "%s was not done after %llu s", stage, (unsigned long long)limit_s);
    else if (end == CHECK_KILLED)
        snprintf(r->message, sizeof r->message, "%s ended with signal %d (%s)", stage, number,
                 system_signal_text(number));
    else
        snprintf(r->message, sizeof r->message, "%s ended the process with exit code %d", stage, number);
    r->has_failed = true;
}

static void check_device(check_task *task, uint64_t limit_s) {
    const check_process process = {
        .run = run_task, .record_size = sizeof(check_record), .receive = receive_record, .opaque = task};
    check_end end;
    int number = 0;
    if (!check_process_run(&process, (double)limit_s, &end, &number)) {
        task->record.has_failed = true;
        snprintf(task->record.message, sizeof task->record.message, "the system starts no process for it");
    } else if (!task->record.has_failed && (end != CHECK_EXITED || number != 0 || task->record.stage != STAGE_END)) {
        describe_end(&task->record, end, number, limit_s);
    }
}

static void print_task(const check_task *task) {
    const check_record *r = &task->record;
    printf("%-5s %s, mapping %s: ", task->device.id, task->device.name, mapping_words[task->mapping]);
    if (r->has_failed)
        printf("FAILED: %s\n", r->message);
    else
        printf("pass: %.2f dB, largest difference %.2g/255, %.1f s\n", r->psnr, r->difference, r->seconds);
    fflush(stdout);
}

static void write_task(json_writer *json, const check_task *task) {
    const check_record *r = &task->record;
    json_open_object(json, NULL);
    json_string(json, "id", task->device.id);
    json_string(json, "device", task->device.name);
    json_string(json, "mapping", mapping_words[task->mapping]);
    json_bool(json, "passed", !r->has_failed);
    if (r->has_failed)
        json_string(json, "failure", r->message);
    json_real(json, "psnr", r->psnr);
    json_real(json, "largest_difference", r->difference);
    json_real(json, "seconds", r->seconds);
    json_close_object(json);
}

/* Checks both mappings of an OpenCL device, and the one of "host".  Returns whether they passed. */
static bool check_mappings(const device_record *device, uint64_t limit_s, json_writer *json) {
    bool passed = true;
    const gscl_mapping last = is_host_device(device->id) ? GSCL_MAPPING_CPU : GSCL_MAPPING_GPU;
    for (gscl_mapping mapping = GSCL_MAPPING_CPU; mapping <= last; mapping++) {
        check_task task = {.device = *device, .mapping = mapping};
        check_device(&task, limit_s);
        if (json)
            write_task(json, &task);
        else
            print_task(&task);
        passed = passed && !task.record.has_failed;
    }
    return passed;
}

/* Lists the devices.  Returns the exit code of the program. */
static int find_devices(device_records *list, uint64_t limit_s) {
    const check_process process = {
        .run = run_list, .record_size = sizeof(device_record), .receive = receive_device, .opaque = list};
    check_end end = CHECK_EXITED;
    int number = EXIT_FAILURE;
    if (!check_process_run(&process, (double)limit_s, &end, &number))
        report_error("devices", "the system starts no process for the check");
    else if (end == CHECK_TOO_LATE)
        report_error("OpenCL", "listing the devices was not done after %llu s", (unsigned long long)limit_s);
    else if (end == CHECK_KILLED)
        report_error("OpenCL", "listing the devices ended with signal %d (%s)", number, system_signal_text(number));
    return end == CHECK_EXITED ? number : EXIT_FAILURE;
}

int device_check_run(uint64_t limit_s, bool as_json) {
    device_records list = {0};
    json_writer json;
    int status = find_devices(&list, limit_s);
    if (status != EXIT_SUCCESS)
        return status;
    json_start(&json, stdout);
    if (as_json)
        json_open_array(&json, NULL);
    for (size_t i = 0; i < list.count; i++)
        if (!check_mappings(&list.devices[i], limit_s, as_json ? &json : NULL))
            status = EXIT_FAILURE;
    if (as_json)
        json_close_array(&json);
    return status;
}
