/* gscl devices: lists OpenCL devices, with the default one and the reason, and the device "host". */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/pocl_cache.h"
#include "commands/command.h"
#include "commands/device_check.h"

#define GIB (1024.0 * 1024.0 * 1024.0)

static void print_text(const gscl_device_info *device) {
    printf("%c %-5s %s\n", device->is_default ? '*' : ' ', device->id, device->device_name);
    printf("        %s, %s\n", device->platform_name, device->device_version);
    printf("        %s, %u compute units, %.1f GiB memory, largest buffer %.1f GiB\n",
           device->is_gpu ? "GPU" : "not a GPU", device->compute_units, (double)device->memory_bytes / GIB,
           (double)device->max_allocation_bytes / GIB);
    if (device->is_default)
        printf("        the default: %s\n", device->why_default);
}

static void write_json(json_writer *json, const gscl_device_info *device) {
    json_open_object(json, NULL);
    json_string(json, "id", device->id);
    json_string(json, "device", device->device_name);
    json_string(json, "platform", device->platform_name);
    json_string(json, "version", device->device_version);
    json_bool(json, "is_gpu", device->is_gpu);
    json_bool(json, "is_default", device->is_default);
    json_string(json, "why_default", device->why_default);
    json_integer(json, "compute_units", device->compute_units);
    json_integer(json, "memory_bytes", device->memory_bytes);
    json_integer(json, "max_allocation_bytes", device->max_allocation_bytes);
    json_close_object(json);
}

static void print_device(const gscl_device_info *device, bool as_json, json_writer *json) {
    if (as_json)
        write_json(json, device);
    else if (strcmp(device->id, GSCL_HOST_DEVICE) == 0)
        printf("  %-5s %s\n        one core; for 'gscl decode', which says in its help when it is the default\n",
               device->id, device->device_name);
    else
        print_text(device);
}

/* `devices`: a list, which may be empty; `host`: the device that is printed last. */
static void print_devices(const gscl_device_info *devices, const gscl_device_info *host, bool as_json) {
    json_writer json;
    json_start(&json, stdout);
    if (as_json)
        json_open_array(&json, NULL);
    for (const gscl_device_info *device = devices; device; device = device->next)
        print_device(device, as_json, &json);
    print_device(host, as_json, &json);
    if (as_json)
        json_close_array(&json);
}

static int list_devices(bool as_json) {
    gscl_device_info *devices = NULL;
    gscl_context *host;
    const gscl_result result = gscl_list_devices(&devices);
    if (result != GSCL_OK && result != GSCL_ERROR_NO_PLATFORM && result != GSCL_ERROR_NO_ENCODER)
        return report_result(NULL, "OpenCL", result);
    const int status = open_device(&(device_choice){.device = GSCL_HOST_DEVICE}, &host);
    char text[EXPLANATION_SIZE];
    if (result == GSCL_ERROR_NO_PLATFORM && pocl_cache_explain(text, sizeof text))
        report_error("devices", "%s", text);
    if (status == EXIT_SUCCESS)
        print_devices(devices, gscl_context_device(host), as_json);
    gscl_context_free(&host);
    gscl_free(devices);
    return status;
}

int command_devices(int argc, char **argv) {
    bool as_json = false, check = false, has_limit = false;
    uint64_t limit_s = 120;
    const option_spec options[] = {
        {.name = "check",
         .kind = OPTION_FLAG,
         .value = &check,
         .help = "encode and decode a small picture on each device, with the kernels for CPUs and for GPUs"},
        {.name = "limit",
         .kind = OPTION_INTEGER,
         .value = &limit_s,
         .given = &has_limit,
         .argument = "S",
         .min_integer = 1,
         .max_integer = 86400,
         .help = "seconds after which a single check has failed (default 120)"},
        {.name = "json", .kind = OPTION_FLAG, .value = &as_json, .help = "write JSON"},
    };
    const option_command command = {
        .name = "devices",
        .usage = "[--check [--limit S]] [--json]",
        .about =
            "Lists the OpenCL devices that gscl can use; * marks the default.  The first column is the\n"
            "number for --device.  The last one, host, decodes without OpenCL.\n"
            "With --check it encodes and decodes a small picture on each device and prints the PSNR and the largest\n"
            "difference from a drawing in double precision, or what failed, which makes the exit code 1.",
        .options = options,
        .option_count = sizeof options / sizeof *options,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);
    if (has_limit && !check)
        return report_usage("devices", "--limit applies to --check only; add --check");
    return check ? device_check_run(limit_s, as_json) : list_devices(as_json);
}
