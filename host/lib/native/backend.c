#include "native/backend.h"

#include <stdio.h>
#include <stdlib.h>

#include "native/launch.h"
#include "native/machine.h"
#include "native/memory.h"
#include "native/native_device.h"
#include "native/processor.h"

static const gscl_work_shapes shapes; /* as the CPU mapping is */

/* Lists the processor, unless the library has no kernels that it can run. */
static gscl_result list(gscl_device_list *list) {
    const gscl_native_processor *processor = gscl_native_processor_choose();
    if (!processor)
        return GSCL_OK;
    gscl_listed_device *device = gscl_device_list_grow(list, 1);
    if (!device)
        return GSCL_ERROR_OUT_OF_MEMORY;
    *device = (gscl_listed_device){.kind = GSCL_DEVICE_HOST, .handle = (void *)processor, .shapes = &shapes};
    gscl_device_info *info = &device->info;
    snprintf(info->id, sizeof info->id, GSCL_HOST_DEVICE);
    snprintf(info->platform_name, sizeof info->platform_name, "gscl");
    snprintf(info->device_name, sizeof info->device_name, "this processor, kernels for %s", processor->name);
    snprintf(info->device_version, sizeof info->device_version, "gscl " GSCL_VERSION);
    info->compute_units = (uint32_t)gscl_native_thread_count();
    info->memory_bytes = info->max_allocation_bytes = gscl_native_memory_bytes();
    list->count++;
    return GSCL_OK;
}

static gscl_result open_processor(gscl_context *context, const gscl_listed_device *listed,
                                  const gscl_context_settings *settings) {
    gscl_native_device *device = context->device = calloc(1, sizeof *device);
    if (!device)
        return gscl_fail_memory(context);
    device->processor = listed->handle;
    device->threads = settings->threads > 0 ? settings->threads : (int)listed->info.compute_units;
    context->info.compute_units = (uint32_t)device->threads;
    return gscl_pool_create(context, device->threads, &device->pool);
}

static void close_processor(gscl_context *context) {
    if (!context->device)
        return;
    gscl_native_kernels_free(context);
    gscl_pool_free(gscl_native(context)->pool);
    free(context->device);
    context->device = NULL;
}

/* Launches have ended when they return, kernels are built, and their times added up at once. */
static gscl_result finish(gscl_context *context) {
    (void)context;
    return GSCL_OK;
}

static void do_nothing(gscl_context *context) {
    (void)context;
}

static void prefetch(gscl_context *context, const gscl_program_request *requests, size_t count) {
    (void)context, (void)requests, (void)count;
}

/* Kernels are compiled for single precision. */
static bool has_double(gscl_context *context) {
    (void)context;
    return false;
}

const gscl_backend gscl_native_backend = {
    .is_host = true,
    .list = list,
    .open = open_processor,
    .close = close_processor,
    .memory_create = gscl_native_memory_create,
    .memory_release = gscl_native_memory_release,
    .write = gscl_native_write,
    .read = gscl_native_read,
    .read_rows = gscl_native_read_rows,
    .copy = gscl_native_copy,
    .fill = gscl_native_fill,
    .kernel_find = gscl_native_kernel_find,
    .launch = gscl_native_launch,
    .finish = finish,
    .collect_times = do_nothing,
    .prefetch = prefetch,
    .prefetch_end = do_nothing,
    .has_double = has_double,
};
