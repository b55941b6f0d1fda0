/* gscl devices: lists the devices, with the default one and the reason. */
#include <stdio.h>
#include <stdlib.h>

#include <gscl/gscl.h>

#include "cli/device_choice.h"
#include "cli/device_list.h"
#include "cli/json.h"
#include "cli/message.h"
#include "cli/options.h"
#include "commands/command.h"
#include "commands/device_check.h"

#define GIB (1024.0 * 1024.0 * 1024.0)

static void print_text(const gscl_device_info *device) {
    printf("%c %-5s %s\n", device->is_default ? '*' : ' ', device->id, device->device_name);
    if (is_host_device(device->id)) {
        printf("        %u thread%s, %.1f GiB memory\n", device->compute_units, device->compute_units == 1 ? "" : "s",
               (double)device->memory_bytes / GIB);
    } else {
        printf("        %s, %s\n", device->platform_name, device->device_version);
        printf("        %s, %u compute units, %.1f GiB memory, largest buffer %.1f GiB\n",
               device->is_gpu ? "GPU" : "not a GPU", device->compute_units, (double)device->memory_bytes / GIB,
               (double)device->max_allocation_bytes / GIB);
    }
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

static void print_decoder(const gscl_device_info *host) {
    printf("  %-5s %s\n        one core; for 'gscl decode', which says in its help when it is the default\n", host->id,
           host->device_name);
}

/* `devices`: a list, which may be empty; `decoder`: the device "host" where it decodes only, or NULL. */
static void print_devices(const gscl_device_info *devices, const gscl_device_info *decoder, bool as_json) {
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
    if (decoder && as_json)
        write_json(&json, decoder);
    else if (decoder)
        print_decoder(decoder);
    if (as_json)
        json_close_array(&json);
}

static int list_devices(bool as_json) {
    gscl_device_info *devices = NULL;
    gscl_context *decoder = NULL;
    int status = EXIT_SUCCESS;
    const gscl_result result = list_encoders(&devices);
    if (result != GSCL_OK)
        return report_result(NULL, "devices", result);
    if (!find_host(devices))
        status = open_device(&(device_choice){.device = GSCL_HOST_DEVICE}, &decoder);
    report_absent_pocl(devices);
    if (status == EXIT_SUCCESS)
        print_devices(devices, gscl_context_device(decoder), as_json);
    gscl_context_free(&decoder);
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
         .help = "encode and decode a small picture on each device, with the kernels for CPUs, and on those of OpenCL "
                 "for GPUs, too"},
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
            "Lists the devices that gscl can use; * marks the default.  The first column is the name for --device.\n"
            "The last one, host, is this processor, with kernels that are part of this program; all others are of "
            "OpenCL.\n"
            "Only 'gscl tradeoff' needs OpenCL, and encoding on a processor for which this program has no kernels.\n"
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
