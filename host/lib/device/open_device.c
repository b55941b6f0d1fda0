#include "device/open_device.h"

#include <ctype.h>
#include <string.h>

#include "device/device_list.h"
#include "device/host_device.h"
#include "runtime/backend.h"
#include "runtime/queue.h"
#include "runtime/text.h"
#include "runtime/timing.h"

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

/* Whether the selector names the device.  A NULL selector means the default device. */
static bool device_matches(const gscl_device_info *info, const char *selector) {
    if (!selector)
        return info->is_default;
    if (isdigit((unsigned char)selector[0]) || strcmp(info->id, GSCL_HOST_DEVICE) == 0)
        return strcmp(info->id, selector) == 0;
    return contains_ignoring_case(info->device_name, selector) || contains_ignoring_case(info->platform_name, selector);
}

/* "0.0 (name), 0.1 (name)" of the usable devices that match; NULL: of all usable ones.  Ends with "..." where the text
 * is full. */
static void device_list_name(const gscl_device_list *list, const char *selector, char *bytes, size_t size) {
    static const char more[] = ", ...";
    gscl_text text = gscl_text_begin(bytes, size - (sizeof more - 1));
    for (size_t i = 0; i < list->count; i++) {
        const gscl_listed_device *d = &list->devices[i];
        char name[41];
        if (d->unusable[0] || (selector && !device_matches(&d->info, selector)))
            continue;
        gscl_text_shorten(name, sizeof name, d->info.device_name);
        gscl_text_append(&text, "%s%s (%s)", text.length ? ", " : "", d->info.id, name);
    }
    if (text.overflow)
        memcpy(bytes + text.length, more, sizeof more);
}

static gscl_result device_fail_unusable(gscl_context *context, gscl_result result, const gscl_listed_device *d) {
    return gscl_fail(context, result, "OpenCL device %s (%s) %s", d->info.id, d->info.device_name, d->unusable);
}

#ifdef GSCL_WITH_OPENCL
static gscl_result device_fail_absent(gscl_context *context, const gscl_device_list *list) {
    if (list->absence[0])
        return gscl_fail(
            context, GSCL_ERROR_NO_PLATFORM,
            "no OpenCL device was found (%s); install the OpenCL loader and an implementation, such as the "
            "packages ocl-icd-libopencl1 and pocl-opencl-icd",
            list->absence);
    return gscl_fail(
        context, GSCL_ERROR_NO_PLATFORM,
        "no OpenCL device was found; install an OpenCL implementation, such as the package pocl-opencl-icd");
}
#else
static gscl_result device_fail_absent(gscl_context *context, const gscl_device_list *list) {
    (void)list;
    return gscl_fail(context, GSCL_ERROR_NO_PLATFORM,
                     "no OpenCL device was found: this library was built without OpenCL");
}
#endif

/* The error when no usable device matches. */
static gscl_result device_fail_none(gscl_context *context, const gscl_device_list *list, const char *selector) {
    char names[320];
    /* Only the processor is there, which has no GPU mapping and no number. */
    const bool has_opencl = list->count > 0 && list->devices[0].kind != GSCL_DEVICE_HOST;
    if (!has_opencl && (!selector || isdigit((unsigned char)selector[0]) || list->count == 0))
        return device_fail_absent(context, list);
    if (!selector)
        return device_fail_unusable(context, GSCL_ERROR_NO_PLATFORM, &list->devices[0]);
    for (size_t i = 0; i < list->count; i++)
        if (device_matches(&list->devices[i].info, selector))
            return device_fail_unusable(context, GSCL_ERROR_UNKNOWN_DEVICE, &list->devices[i]);
    device_list_name(list, NULL, names, sizeof names);
    return gscl_fail(context, GSCL_ERROR_UNKNOWN_DEVICE, "no device matches \"%.60s\"; there is %s", selector,
                     names[0] ? names : "none that can be used");
}

/* Fails where the device has too small work-groups for the mapping: before any work, rather than at a launch. */
static gscl_result check_groups(gscl_context *context) {
    const size_t largest = context->largest_group, needed = gscl_mapping_largest_group(context);
    if (largest == 0 || needed <= largest)
        return GSCL_OK;
    return gscl_fail(context, GSCL_ERROR_GROUP_SIZE,
                     "%s has work-groups of at most %zu work-items, and kernels of the %s mapping need %zu",
                     context->info.device_name, largest, context->gpu_mapping ? "GPU" : "CPU", needed);
}

static gscl_result device_open_listed(gscl_context *context, const gscl_listed_device *device,
                                      const gscl_context_settings *settings) {
    context->backend = device->backend;
    context->info = device->info;
    context->is_host = device->kind == GSCL_DEVICE_HOST;
    context->is_cpu = device->kind == GSCL_DEVICE_CPU || context->is_host;
    context->shapes = device->shapes;
    context->largest_group = device->largest_group;
    context->gpu_mapping =
        settings->mapping == GSCL_MAPPING_AUTO ? gscl_mapping_auto(context) : settings->mapping == GSCL_MAPPING_GPU;
    if (context->is_host && context->gpu_mapping)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT,
                         "the kernels of the device \"host\" have the CPU mapping; choose an OpenCL device for the GPU "
                         "mapping");
    GSCL_TRY(check_groups(context));
    if (settings->timing)
        GSCL_TRY(gscl_timing_create(context));
    return context->backend->open(context, device, settings);
}

/* Opens the one device of the list that the settings ask for. */
static gscl_result device_open_chosen(gscl_context *context, const gscl_device_list *list,
                                      const gscl_context_settings *settings) {
    const char *selector = settings->device;
    size_t found = 0;
    const gscl_listed_device *chosen = NULL;
    for (size_t i = 0; i < list->count; i++)
        if (!list->devices[i].unusable[0] && device_matches(&list->devices[i].info, selector)) {
            chosen = &list->devices[i];
            found++;
        }
    if (found == 0)
        return device_fail_none(context, list, selector);
    if (found > 1) {
        char names[320];
        device_list_name(list, selector, names, sizeof names);
        return gscl_fail(context, GSCL_ERROR_AMBIGUOUS_DEVICE, "\"%.60s\" matches more than one device: %s", selector,
                         names);
    }
    return device_open_listed(context, chosen, settings);
}

gscl_result gscl_device_open(gscl_context *context, const gscl_context_settings *settings) {
    gscl_device_list list;
    const bool is_host = settings->device && strcmp(settings->device, GSCL_HOST_DEVICE) == 0;
    gscl_result result =
        is_host ? gscl_device_list_create_host(&list) : gscl_device_list_create(&list, settings->mapping);
    if (result != GSCL_OK)
        result = gscl_fail_memory(context);
    else if (is_host && list.count == 0) /* no kernels for this processor */
        result = gscl_host_open(context, settings);
    else
        result = device_open_chosen(context, &list, settings);
    gscl_device_list_free(&list);
    return result;
}

void gscl_device_close(gscl_context *context) {
    gscl_timing_free(context);
    if (!context->backend)
        return;
    gscl_release_parked(context);
    context->backend->close(context);
}
