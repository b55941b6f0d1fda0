#include "opencl/backend.h"

#include "opencl/device_list.h"
#include "opencl/kernel_times.h"
#include "opencl/launch.h"
#include "opencl/memory.h"
#include "opencl/open.h"
#include "opencl/prefetch.h"
#include "opencl/programs.h"

const gscl_backend gscl_opencl_backend = {
    .list = gscl_opencl_list,
    .open = gscl_opencl_open,
    .close = gscl_opencl_close,
    .memory_create = gscl_opencl_memory_create,
    .memory_release = gscl_opencl_memory_release,
    .write = gscl_opencl_write,
    .read = gscl_opencl_read,
    .read_rows = gscl_opencl_read_rows,
    .copy = gscl_opencl_copy,
    .fill = gscl_opencl_fill,
    .kernel_find = gscl_opencl_kernel_find,
    .launch = gscl_opencl_launch,
    .flush = gscl_opencl_flush,
    .finish = gscl_opencl_finish,
    .collect_times = gscl_opencl_collect_times,
    .prefetch = gscl_opencl_prefetch,
    .prefetch_end = gscl_opencl_prefetch_end,
    .has_double = gscl_opencl_has_double,
};
