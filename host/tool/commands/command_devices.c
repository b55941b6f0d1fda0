/* gscl devices: lists OpenCL devices, with the default one and the reason. */
#include <stdio.h>
#include <stdlib.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"
#include "cli/json.h"
#include "cli/options.h"
#include "commands/command.h"

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

static void print_devices(const gscl_device_info *devices, bool as_json) {
    json_writer json;
    json_start(&json, stdout);
    if (as_json)
        json_open_array(&json, NULL);
    for (const gscl_device_info *device = devices; device; device = device->next) {
        if (as_json)
            write_json(&json, device);
        else
            print_text(device);
    }
    if (as_json)
        json_close_array(&json);
}

int command_devices(int argc, char **argv) {
    bool as_json = false;
    const option_spec options[] = {
        {.name = "json", .kind = OPTION_FLAG, .value = &as_json, .help = "write JSON"},
    };
    const option_command command = {
        .name = "devices",
        .usage = "[--json]",
        .about = "Lists the OpenCL devices that gscl can use; * marks the default.  The first column is the\n"
                 "number for --device.",
        .options = options,
        .option_count = sizeof options / sizeof *options,
    };
    int first;
    const option_outcome outcome = options_parse(&command, argc, argv, &first);
    if (outcome != OPTIONS_RUN)
        return options_exit_code(outcome);

    gscl_device_info *devices;
    const gscl_result result = gscl_list_devices(&devices);
    if (result != GSCL_OK)
        return report_result(NULL, "OpenCL", result);
    print_devices(devices, as_json);
    gscl_free(devices);
    return EXIT_SUCCESS;
}
