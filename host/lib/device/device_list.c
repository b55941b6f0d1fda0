#include "device/device_list.h"

#include <stdio.h>
#include <stdlib.h>

#include "device/backends.h"

/* The larger, the better; 0 for a device that cannot be used. */
static int device_preference(const gscl_listed_device *d, gscl_mapping mapping) {
    if (d->unusable[0] || (d->kind == GSCL_DEVICE_HOST && mapping == GSCL_MAPPING_GPU))
        return 0;
    return d->kind == GSCL_DEVICE_GPU           ? 4
           : d->kind == GSCL_DEVICE_ACCELERATOR ? 3
           : d->kind == GSCL_DEVICE_HOST        ? 2
                                                : 1;
}

/* Whether GPU `a` comes before GPU `b`, whatever their order in the list. */
static bool is_better_gpu(const gscl_listed_device *a, const gscl_listed_device *b) {
    if (a->shares_memory != b->shares_memory)
        return b->shares_memory;
    if (a->info.memory_bytes != b->info.memory_bytes)
        return a->info.memory_bytes > b->info.memory_bytes;
    return a->info.compute_units > b->info.compute_units;
}

/* The default device; NULL where none can be used. */
static gscl_listed_device *find_default(const gscl_device_list *list, gscl_mapping mapping) {
    int best_preference = 0;
    gscl_listed_device *best = NULL;
    for (size_t i = 0; i < list->count; i++) {
        gscl_listed_device *device = &list->devices[i];
        const int preference = device_preference(device, mapping);
        const bool is_better =
            preference > best_preference ||
            (best && preference == best_preference && device->kind == GSCL_DEVICE_GPU && is_better_gpu(device, best));
        if (is_better) {
            best = device;
            best_preference = preference;
        }
    }
    return best;
}

static int count_usable_gpus(const gscl_device_list *list) {
    int count = 0;
    for (size_t i = 0; i < list->count; i++)
        count += list->devices[i].kind == GSCL_DEVICE_GPU && !list->devices[i].unusable[0];
    return count;
}

/* Why a device is the default. */
static const char *default_reason(const gscl_device_list *list, const gscl_listed_device *device) {
    switch (device->kind) {
    case GSCL_DEVICE_GPU:
        return count_usable_gpus(list) == 1 ? "the only GPU"
               : device->shares_memory      ? "the GPU with the most memory, which all share with the processor"
                                            : "the GPU with the most memory of its own";
    case GSCL_DEVICE_ACCELERATOR:
        return "the first accelerator; there is no GPU";
    case GSCL_DEVICE_HOST:
        return "kernels are compiled already; there is no GPU or accelerator";
    default:
        return "the first CPU; there is no GPU or accelerator";
    }
}

static void device_list_mark_default(gscl_device_list *list, gscl_mapping mapping) {
    gscl_listed_device *device = find_default(list, mapping);
    if (!device)
        return;
    device->info.is_default = true;
    snprintf(device->info.why_default, sizeof device->info.why_default, "%s", default_reason(list, device));
}

static gscl_result device_list_append(gscl_device_list *list, const gscl_backend *backend) {
    size_t i = list->count;
    const gscl_result result = backend->list(list);
    while (i < list->count)
        list->devices[i++].backend = backend;
    return result;
}

gscl_result gscl_device_list_create(gscl_device_list *list, gscl_mapping mapping) {
    gscl_result result = GSCL_OK;
    *list = (gscl_device_list){0};
    for (size_t b = 0; gscl_backends[b] && result == GSCL_OK; b++)
        result = device_list_append(list, gscl_backends[b]);
    device_list_mark_default(list, mapping);
    return result;
}

gscl_result gscl_device_list_create_host(gscl_device_list *list) {
    gscl_result result = GSCL_OK;
    *list = (gscl_device_list){0};
    for (size_t b = 0; gscl_backends[b] && result == GSCL_OK; b++)
        if (gscl_backends[b]->is_host)
            result = device_list_append(list, gscl_backends[b]);
    return result;
}

gscl_result gscl_list_devices(gscl_device_info **devices) {
    if (!devices)
        return GSCL_ERROR_INVALID_ARGUMENT;
    gscl_device_list list;
    gscl_result result = gscl_device_list_create(&list, GSCL_MAPPING_AUTO);
    gscl_device_info *infos = result == GSCL_OK ? malloc((list.count + 1) * sizeof *infos) : NULL;
    size_t usable = 0;
    for (size_t i = 0; infos && i < list.count; i++)
        if (!list.devices[i].unusable[0])
            infos[usable++] = list.devices[i].info;
    for (size_t i = 0; i + 1 < usable; i++)
        infos[i].next = &infos[i + 1];
    gscl_device_list_free(&list);
    if (!infos)
        return GSCL_ERROR_OUT_OF_MEMORY;
    if (usable == 0) {
        free(infos);
        return GSCL_ERROR_NO_PLATFORM;
    }
    *devices = infos;
    return GSCL_OK;
}
