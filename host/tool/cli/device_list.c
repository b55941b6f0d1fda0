#include "cli/device_list.h"

#include <stddef.h>
#include <string.h>

#include "cli/message.h"
#include "cli/pocl_cache.h"

bool is_host_device(const char *device) {
    return device && strcmp(device, GSCL_HOST_DEVICE) == 0;
}

gscl_result list_encoders(gscl_device_info **devices) {
    *devices = NULL;
    const gscl_result result = gscl_list_devices(devices);
    return result == GSCL_ERROR_NO_PLATFORM || result == GSCL_ERROR_NO_ENCODER ? GSCL_OK : result;
}

const gscl_device_info *find_host(const gscl_device_info *devices) {
    while (devices && !is_host_device(devices->id))
        devices = devices->next;
    return devices;
}

const gscl_device_info *find_opencl(const gscl_device_info *devices) {
    const gscl_device_info *found = NULL;
    for (const gscl_device_info *device = devices; device; device = device->next)
        if (!is_host_device(device->id) && (!found || device->is_default))
            found = device;
    return found;
}

void report_absent_pocl(const gscl_device_info *devices) {
    char text[2048];
    if (!find_opencl(devices) && pocl_cache_explain(text, sizeof text))
        report_error("devices", "%s", text);
}
