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

static void device_list_mark_default(gscl_device_list *list, gscl_mapping mapping) {
    static const char *const reasons[] = {"", "the first CPU; there is no GPU or accelerator",
                                          "kernels are compiled already; there is no GPU or accelerator",
                                          "the first accelerator; there is no GPU", "the first GPU"};
    int best_preference = 0;
    gscl_listed_device *best = NULL;
    for (size_t i = 0; i < list->count; i++) {
        const int preference = device_preference(&list->devices[i], mapping);
        if (preference > best_preference) {
            best = &list->devices[i];
            best_preference = preference;
        }
    }
    if (!best)
        return;
    best->info.is_default = true;
    snprintf(best->info.why_default, sizeof best->info.why_default, "%s", reasons[best_preference]);
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
