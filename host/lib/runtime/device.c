#include "runtime/device.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_PLATFORMS 16
#define MAX_DEVICES 64

typedef struct device_list {
    size_t count;
    cl_platform_id platforms[MAX_DEVICES];
    cl_device_id devices[MAX_DEVICES];
    gscl_device_info infos[MAX_DEVICES];
} device_list;

static void describe(cl_platform_id platform, cl_device_id device, cl_device_type type, gscl_device_info *info) {
    cl_ulong memory = 0, allocation = 0;
    cl_uint units = 0;
    clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof info->platform_name, info->platform_name, NULL);
    clGetDeviceInfo(device, CL_DEVICE_NAME, sizeof info->device_name, info->device_name, NULL);
    clGetDeviceInfo(device, CL_DEVICE_VERSION, sizeof info->device_version, info->device_version, NULL);
    clGetDeviceInfo(device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
    clGetDeviceInfo(device, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof memory, &memory, NULL);
    clGetDeviceInfo(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof allocation, &allocation, NULL);
    info->is_gpu = (type & CL_DEVICE_TYPE_GPU) != 0;
    info->compute_units = units;
    info->memory_bytes = memory;
    info->max_allocation_bytes = allocation;
}

/* 3 for a GPU, 2 for an accelerator, 1 for a CPU. */
static int preference(cl_device_type type) {
    return type & CL_DEVICE_TYPE_GPU ? 3 : type & CL_DEVICE_TYPE_ACCELERATOR ? 2 : 1;
}

static void mark_default(device_list *list, const int *preferences) {
    static const char *const reasons[] = {"", "the first CPU; there is no GPU or accelerator",
                                          "the first accelerator; there is no GPU", "the first GPU"};
    size_t best = 0;
    for (size_t i = 1; i < list->count; i++)
        if (preferences[i] > preferences[best])
            best = i;
    if (list->count == 0)
        return;
    list->infos[best].is_default = true;
    snprintf(list->infos[best].why_default, sizeof list->infos[best].why_default, "%s", reasons[preferences[best]]);
}

/* Lists every available device with a compiler. */
static void list_devices(device_list *list) {
    cl_platform_id platforms[MAX_PLATFORMS];
    cl_uint platform_count = 0;
    int preferences[MAX_DEVICES];
    memset(list, 0, sizeof *list);
    if (clGetPlatformIDs(MAX_PLATFORMS, platforms, &platform_count) != CL_SUCCESS)
        return;
    if (platform_count > MAX_PLATFORMS)
        platform_count = MAX_PLATFORMS;
    for (cl_uint p = 0; p < platform_count; p++) {
        cl_device_id devices[MAX_DEVICES];
        cl_uint device_count = 0;
        if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, MAX_DEVICES, devices, &device_count) != CL_SUCCESS)
            continue;
        for (cl_uint d = 0; d < device_count && d < MAX_DEVICES && list->count < MAX_DEVICES; d++) {
            cl_device_type type = CL_DEVICE_TYPE_CPU;
            cl_bool usable = CL_FALSE;
            clGetDeviceInfo(devices[d], CL_DEVICE_COMPILER_AVAILABLE, sizeof usable, &usable, NULL);
            clGetDeviceInfo(devices[d], CL_DEVICE_TYPE, sizeof type, &type, NULL);
            if (!usable)
                continue;
            gscl_device_info *info = &list->infos[list->count];
            describe(platforms[p], devices[d], type, info);
            snprintf(info->id, sizeof info->id, "%u.%u", (unsigned)p, (unsigned)d);
            preferences[list->count] = preference(type);
            list->platforms[list->count] = platforms[p];
            list->devices[list->count++] = devices[d];
        }
    }
    mark_default(list, preferences);
}

gscl_result gscl_list_devices(gscl_device_info **devices) {
    if (!devices)
        return GSCL_ERROR_INVALID_ARGUMENT;
    device_list *list = malloc(sizeof *list);
    if (!list)
        return GSCL_ERROR_OUT_OF_MEMORY;
    list_devices(list);
    gscl_device_info *infos = malloc((list->count ? list->count : 1) * sizeof *infos);
    gscl_result result = !infos ? GSCL_ERROR_OUT_OF_MEMORY : list->count == 0 ? GSCL_ERROR_NO_PLATFORM : GSCL_OK;
    if (result == GSCL_OK) {
        memcpy(infos, list->infos, list->count * sizeof *infos);
        for (size_t i = 0; i + 1 < list->count; i++)
            infos[i].next = &infos[i + 1];
        *devices = infos;
    } else {
        free(infos);
    }
    free(list);
    return result;
}

static bool contains_ignoring_case(const char *text, const char *part) {
    for (; *text; text++) {
        size_t i = 0;
        while (part[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)part[i]))
            i++;
        if (!part[i])
            return true;
    }
    return false;
}

static bool matches(const gscl_device_info *info, const char *selector) {
    if (!selector)
        return info->is_default;
    if (isdigit((unsigned char)selector[0]))
        return strcmp(info->id, selector) == 0;
    return contains_ignoring_case(info->device_name, selector) || contains_ignoring_case(info->platform_name, selector);
}

/* "0.0 (name), 0.1 (name)" of all devices or of those that match; cut short when it does not fit. */
static void name_devices(const device_list *list, const char *selector, char *text, size_t size) {
    size_t length = 0;
    text[0] = 0;
    for (size_t i = 0; i < list->count && length < size; i++)
        if (!selector || matches(&list->infos[i], selector))
            length += (size_t)snprintf(text + length, size - length, "%s%s (%.40s)", length ? ", " : "",
                                       list->infos[i].id, list->infos[i].device_name);
}

static gscl_result choose(gscl_context *context, const device_list *list, const char *selector) {
    char names[320];
    size_t found = 0, at = 0;
    if (list->count == 0)
        return gscl_fail(
            context, GSCL_ERROR_NO_PLATFORM,
            "no OpenCL device was found; install an OpenCL implementation, such as the package pocl-opencl-icd");
    for (size_t i = 0; i < list->count; i++)
        if (matches(&list->infos[i], selector)) {
            found++;
            at = i;
        }
    if (found == 0) {
        name_devices(list, NULL, names, sizeof names);
        return gscl_fail(context, GSCL_ERROR_UNKNOWN_DEVICE, "no OpenCL device matches \"%.60s\"; there is %s",
                         selector, names);
    }
    if (found > 1) {
        name_devices(list, selector, names, sizeof names);
        return gscl_fail(context, GSCL_ERROR_AMBIGUOUS_DEVICE, "\"%.60s\" matches more than one OpenCL device: %s",
                         selector, names);
    }
    context->platform = list->platforms[at];
    context->device = list->devices[at];
    context->info = list->infos[at];
    return GSCL_OK;
}

gscl_result gscl_device_choose(gscl_context *context, const char *selector) {
    device_list *list = malloc(sizeof *list);
    if (!list)
        return gscl_fail_memory(context);
    list_devices(list);
    gscl_result result = choose(context, list, selector);
    free(list);
    return result;
}
