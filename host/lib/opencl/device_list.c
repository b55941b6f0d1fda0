#include "opencl/device_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "opencl/cl_error.h"
#include "opencl/quirks.h"
#include "runtime/text.h"

/* A parameter of a device (clGetDeviceInfo) or of its platform (clGetPlatformInfo). */
typedef struct device_query {
    bool of_platform;
    cl_uint parameter;
} device_query;

static cl_int device_query_run(const gscl_listed_device *d, device_query query, size_t size, void *value,
                               size_t *needed) {
    return query.of_platform ? gscl_cl.clGetPlatformInfo(d->platform, query.parameter, size, value, needed)
                             : gscl_cl.clGetDeviceInfo(d->handle, query.parameter, size, value, needed);
}

/* A text of any length, to be freed; NULL in *text on failure. */
static cl_int device_query_text(const gscl_listed_device *d, device_query query, char **text) {
    size_t size = 0;
    *text = NULL;
    cl_int error = device_query_run(d, query, 0, NULL, &size);
    if (error != CL_SUCCESS)
        return error;
    char *bytes = calloc(size + 1, 1);
    if (!bytes)
        return CL_OUT_OF_HOST_MEMORY;
    error = device_query_run(d, query, size, bytes, NULL);
    if (error != CL_SUCCESS) {
        free(bytes);
        return error;
    }
    *text = bytes;
    return CL_SUCCESS;
}

static cl_int device_query_short_text(const gscl_listed_device *d, device_query query, size_t capacity, char *text) {
    char *whole;
    const cl_int error = device_query_text(d, query, &whole);
    if (error == CL_SUCCESS)
        gscl_text_shorten(text, capacity, whole);
    free(whole);
    return error;
}

static cl_int device_describe_platform(gscl_listed_device *d) {
    char *version;
    cl_int error = device_query_text(d, (device_query){true, CL_PLATFORM_VERSION}, &version);
    if (error != CL_SUCCESS)
        return error;
    error = device_query_short_text(d, (device_query){true, CL_PLATFORM_NAME}, sizeof d->info.platform_name,
                                    d->info.platform_name);
    if (error == CL_SUCCESS) {
        d->quirks = gscl_quirks_find(d->info.platform_name, version);
        d->shapes = &d->quirks->shapes;
    }
    free(version);
    return error;
}

static cl_int device_describe_texts(gscl_listed_device *d) {
    const cl_int error = device_query_short_text(d, (device_query){false, CL_DEVICE_NAME}, sizeof d->info.device_name,
                                                 d->info.device_name);
    return error != CL_SUCCESS ? error
                               : device_query_short_text(d, (device_query){false, CL_DEVICE_VERSION},
                                                         sizeof d->info.device_version, d->info.device_version);
}

static gscl_device_kind kind_of_type(cl_device_type type) {
    return type & CL_DEVICE_TYPE_GPU           ? GSCL_DEVICE_GPU
           : type & CL_DEVICE_TYPE_ACCELERATOR ? GSCL_DEVICE_ACCELERATOR
           : type & CL_DEVICE_TYPE_CPU         ? GSCL_DEVICE_CPU
                                               : GSCL_DEVICE_OTHER;
}

/* Whether the device says that its memory is the host's.  OpenCL 2.0 advises against the question, so that no answer counts as
 * no. */
static bool shares_memory(const gscl_listed_device *d) {
    cl_bool is_unified = CL_FALSE;
    return gscl_cl.clGetDeviceInfo(d->handle, CL_DEVICE_HOST_UNIFIED_MEMORY, sizeof is_unified, &is_unified, NULL) ==
               CL_SUCCESS &&
           is_unified;
}

/* Reads the numbers that decide how a device is used, and whether it can be. */
static cl_int device_describe_numbers(gscl_listed_device *d) {
    cl_bool available = CL_FALSE, has_compiler = CL_FALSE;
    cl_ulong memory = 0, allocation = 0;
    cl_uint units = 0;
    size_t largest_group = 0;
    cl_device_type type = 0;
    const struct {
        cl_device_info parameter;
        size_t size;
        void *value;
    } queries[] = {
        {CL_DEVICE_TYPE, sizeof type, &type},
        {CL_DEVICE_AVAILABLE, sizeof available, &available},
        {CL_DEVICE_COMPILER_AVAILABLE, sizeof has_compiler, &has_compiler},
        {CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units},
        {CL_DEVICE_GLOBAL_MEM_SIZE, sizeof memory, &memory},
        {CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof allocation, &allocation},
        {CL_DEVICE_MAX_WORK_GROUP_SIZE, sizeof largest_group, &largest_group},
    };
    for (size_t i = 0; i < sizeof queries / sizeof *queries; i++) {
        const cl_int error =
            gscl_cl.clGetDeviceInfo(d->handle, queries[i].parameter, queries[i].size, queries[i].value, NULL);
        if (error != CL_SUCCESS)
            return error;
    }
    d->kind = kind_of_type(type);
    d->info.is_gpu = d->kind == GSCL_DEVICE_GPU;
    d->info.compute_units = units;
    d->info.memory_bytes = memory;
    d->info.max_allocation_bytes = allocation;
    d->shares_memory = shares_memory(d);
    d->largest_group = largest_group;
    if (!available)
        snprintf(d->unusable, sizeof d->unusable, "is not available");
    else if (!has_compiler)
        snprintf(d->unusable, sizeof d->unusable, "has no compiler");
    return CL_SUCCESS;
}

/* Fills all but the handles and the id.  A device whose parameters cannot be read is listed as unusable, unless the host
 * has no memory left. */
static gscl_result device_describe(gscl_listed_device *d) {
    cl_int error = device_describe_texts(d);
    if (error == CL_SUCCESS)
        error = device_describe_platform(d);
    if (error == CL_SUCCESS)
        error = device_describe_numbers(d);
    if (error != CL_SUCCESS)
        snprintf(d->unusable, sizeof d->unusable, "cannot be queried: %s", gscl_cl_error_name(error));
    return error == CL_OUT_OF_HOST_MEMORY ? GSCL_ERROR_OUT_OF_MEMORY : GSCL_OK;
}

/* Appends the devices of one platform. */
static gscl_result append_platform(gscl_device_list *list, cl_platform_id platform, cl_uint platform_number) {
    cl_uint count = 0;
    if (gscl_cl.clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, NULL, &count) != CL_SUCCESS || count == 0)
        return GSCL_OK; /* a platform without devices */
    cl_device_id *ids = malloc(count * sizeof *ids);
    gscl_listed_device *devices = gscl_device_list_grow(list, count);
    gscl_result result = ids && devices ? GSCL_OK : GSCL_ERROR_OUT_OF_MEMORY;
    if (result == GSCL_OK && gscl_cl.clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, ids, NULL) != CL_SUCCESS)
        count = 0;
    for (cl_uint i = 0; i < count && result == GSCL_OK; i++) {
        gscl_listed_device *d = &devices[i];
        *d = (gscl_listed_device){.platform = platform, .handle = ids[i]};
        gscl_text id = gscl_text_begin(d->info.id, sizeof d->info.id);
        gscl_text_append(&id, "%u.%u", (unsigned)platform_number, (unsigned)i);
        result = device_describe(d);
        list->count++;
    }
    free(ids);
    return result;
}

gscl_result gscl_opencl_list(gscl_device_list *list) {
    cl_uint count = 0;
    const char *absence = gscl_opencl_library();
    if (absence)
        gscl_text_shorten(list->absence, sizeof list->absence, absence);
    if (absence || gscl_cl.clGetPlatformIDs(0, NULL, &count) != CL_SUCCESS || count == 0)
        return GSCL_OK; /* no platform: CL_PLATFORM_NOT_FOUND_KHR */
    cl_platform_id *platforms = malloc(count * sizeof *platforms);
    if (!platforms)
        return GSCL_ERROR_OUT_OF_MEMORY;
    if (gscl_cl.clGetPlatformIDs(count, platforms, NULL) != CL_SUCCESS)
        count = 0;
    gscl_result result = GSCL_OK;
    for (cl_uint p = 0; p < count && result == GSCL_OK; p++)
        result = append_platform(list, platforms[p], p);
    free(platforms);
    return result;
}
